//! Finishes what an earlier capture was stopped in.
//!
//! | found | what it was | what becomes of it |
//! |---|---|---|
//! | a file or folder under a temporary name | being written | removed |
//! | a photo without sidecar that is not listed | being accepted, sidecar not yet written; or being taken back, all but the photo moved | moved to `taken_back` |
//! | a photo and its sidecar, not listed | accepted, list not yet written | listed |
//! | a listed photo whose sidecar is in `taken_back` | being taken back | taken back |

use std::path::Path;

use super::store::{SESSION, Store, StoreError, TAKEN_BACK, is_ours, names, number, sidecar_of, sidecars};
use scaleproof_core::files::{self, FileError};
use scaleproof_session::{PhotoEntry, Session};

impl Store {
    /// Opens a session, or begins one with copies of the scene (and its mesh) and the camera, to fill it with photos of a texture. What an
    /// earlier capture left unfinished is finished; files that no capture made stay as they are.
    ///
    /// # Errors
    /// Files that cannot be read or written; another scene or camera than the session's; a session that no capture made.
    pub fn open(folder: &Path, scene: &Path, camera: &Path, variant: &str) -> Result<Store, StoreError> {
        let mut store = Store::begin(folder, scene, camera)?;
        store.recover(variant)?;
        Ok(store)
    }

    fn recover(&mut self, variant: &str) -> Result<(), StoreError> {
        let folder = self.folder.clone();
        let mut there = names(&folder)?;
        for partial in there.extract_if(.., |name| files::is_temporary(name)) {
            let partial = folder.join(partial);
            if partial.is_dir() && !partial.is_symlink() {
                files::chosen::remove_folder(&folder, &partial)?;
            } else {
                files::chosen::remove(&folder, &partial)?;
            }
        }
        let mut listed = Vec::new();
        if folder.join(SESSION).exists() {
            let is_below = |photo: &PhotoEntry| photo.file.contains('/');
            let (below, photos) = Session::open(&folder)?.photos.into_iter().partition(is_below);
            self.others = below;
            listed = Vec::from_iter(photos.into_iter().map(|photo: PhotoEntry| photo.file));
        }
        let mut valid = sidecars(&folder)?;
        let away = sidecars(&folder.join(TAKEN_BACK))?;
        let put_away = names(&folder.join(TAKEN_BACK))?;
        let is_known = |photo: &&String| valid.contains_key(*photo) || away.contains_key(*photo);
        if let Some(photo) = listed.iter().find(|photo| !is_known(photo)) {
            let sidecar = sidecar_of(photo);
            let message =
                format!("{photo} has no {sidecar}: no capture made this session, so capture into a new folder");
            return Err(FileError::content(&folder.join(SESSION), message).into());
        }
        // A sidecar without photo: somebody removed the photo. One that is listed is missed.
        let is_missed = |photo: &&String| !there.contains(photo) && listed.contains(photo);
        if let Some(photo) = valid.keys().find(is_missed) {
            let why = "this accepted photo is gone: bring it back, or remove its line from session.json";
            return Err(FileError::content(&folder.join(photo), why).into());
        }
        valid.retain(|photo, _| there.contains(photo));
        for (photo, sidecar) in &valid {
            let path = folder.join(photo);
            if files::sha256_hex(&files::read(&path)?) != sidecar.sha256 {
                let why = "this is not the photo that was accepted: bring the original back";
                return Err(FileError::content(&path, why).into());
            }
        }
        let numbers = there.iter().chain(&put_away).filter_map(|name| number(name));
        self.next = numbers.max().map_or(0, |n| n + 1);
        self.accepted = valid.into_values().collect();
        self.accepted.sort_by_key(|sidecar| number(&sidecar.photo.file));
        self.taken_back = away.into_values().map(|sidecar| sidecar.sha256).collect();
        let now: Vec<&String> = self.accepted.iter().map(|sidecar| &sidecar.photo.file).collect();
        if now != listed.iter().collect::<Vec<_>>() {
            self.write_list()?;
        }
        let known = self.accepted.iter().map(|sidecar| sidecar.photo.variant.as_str());
        let variants: Vec<&str> = known.chain([variant]).collect();
        for photo in there.iter().filter(|name| is_ours(name, variants.iter().copied())) {
            if self.accepted.iter().all(|sidecar| sidecar.photo.file != *photo) {
                self.put_away(photo)?;
            }
        }
        Ok(())
    }
}
