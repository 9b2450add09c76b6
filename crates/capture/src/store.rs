//! The session that a capture fills: photos byte for byte, a sidecar beside each, and `session.json`.
//!
//! A photo is accepted in three steps, each a whole file that appears at once: the photo, its sidecar, `session.json`. Whatever moment
//! the program ends at, the next opening finds one of four states and finishes it (`recover.rs`). Nothing is deleted: what is taken back
//! lies in the folder `taken_back`.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::gates::Measures;
use super::source::CameraSettings;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::Sigma;
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_session as session;
use scaleproof_session::filling::{self, FillingError};
use scaleproof_session::{PhotoEntry, SessionError};

/// Reason why a session cannot be filled.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Filling(#[from] FillingError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// Facts about an accepted photo, stored beside it as `NAME.capture.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub struct Sidecar {
    /// Entry of `session.json`.
    pub photo: PhotoEntry,
    /// SHA-256 of the photo, hex.
    pub sha256: String,
    /// Name that the source gave it.
    pub source: String,
    /// View that was required.
    pub target: Viewpoint,
    /// Viewpoint from which it was taken.
    pub viewpoint: Viewpoint,
    pub sigma: Sigma,
    pub T_camera_model: [[f64; 4]; 4],
    /// Ids of the tags the pose rests on.
    pub tags: Vec<u32>,
    pub rms_px: f64,
    pub gates: Measures,
    /// Taken by hand: light, focus and steadiness need not have held.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_by_hand: bool,
    /// Settings of the camera, where the source knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraSettings>,
}

pub(super) const SIDECAR: &str = ".capture.json";
pub(super) const TAKEN_BACK: &str = "taken_back";
pub(super) const SESSION: &str = "session.json";
const SCENE: &str = "scene.toml";

/// An open session. No other capture can open it meanwhile.
#[derive(Debug)]
pub struct Store {
    pub(super) folder: PathBuf,
    camera: String,
    /// Accepted photos in the order of their numbers.
    pub(super) accepted: Vec<Sidecar>,
    /// Photos in folders of the session, which something else listed, as `session from-video`: they stay.
    pub(super) others: Vec<PhotoEntry>,
    /// SHA-256 of the photos that were taken back.
    pub(super) taken_back: Vec<String>,
    /// Number of the next photo; numbers are never used again.
    pub(super) next: u64,
    _lock: File,
}

impl Store {
    /// Opens a session, or begins one with copies of the scene (and its mesh) and the camera; what an earlier capture left unfinished stays so.
    pub(super) fn begin(folder: &Path, scene: &Path, camera: &Path) -> Result<Store, StoreError> {
        let read = Scene::open(scene)?;
        Camera::open(camera).map_err(SessionError::from)?;
        let below = session::files_below(&read).map_err(|mesh| {
            message!(
                "the scene's mesh {} does not lie below the scene's folder, so that it cannot be copied into the session: put it there",
                mesh.display()
            )
        })?;
        refuse_foreign(folder)?;
        files::make_named_folder(folder)?;
        let lock = filling::locked(folder)?;
        let extension = camera.extension().map_or("yaml".into(), |e| e.to_string_lossy());
        let camera_name = format!("camera.{extension}");
        let is_new = !folder.join(SESSION).exists();
        keep_copy(scene, folder, SCENE, "scene", is_new)?;
        keep_copy(camera, folder, &camera_name, "camera", is_new)?;
        for file in below {
            keep_copy(
                &scene.with_file_name(&file),
                folder,
                &file.to_string_lossy(),
                "mesh",
                is_new,
            )?;
        }
        Ok(Store {
            folder: folder.to_owned(),
            camera: camera_name,
            accepted: Vec::new(),
            others: Vec::new(),
            taken_back: Vec::new(),
            next: 0,
            _lock: lock,
        })
    }

    /// Returns the accepted photos, in the order they were accepted.
    pub fn accepted(&self) -> &[Sidecar] {
        &self.accepted
    }

    /// Returns the name of the accepted photo with this content.
    pub fn named(&self, sha256: &str) -> Option<&str> {
        let known = self.accepted.iter().find(|sidecar| sidecar.sha256 == sha256)?;
        Some(&known.photo.file)
    }

    /// Returns true if the photo with this content was taken back.
    pub fn was_taken_back(&self, sha256: &str) -> bool {
        self.taken_back.iter().any(|known| known == sha256)
    }

    /// Writes a photo, its sidecar and `session.json`, in this order. Returns the photo's name, made of the variant and a number; the
    /// sidecar's own is filled in.
    ///
    /// # Errors
    /// A file that cannot be written, a session folder that is gone. Opened again, the session has the photo whole or not at all.
    pub fn accept(&mut self, original: &[u8], extension: &str, mut sidecar: Sidecar) -> Result<String, StoreError> {
        // Writing would create a missing folder again.
        if !self.folder.join(SCENE).exists() {
            let folder = self.folder.display();
            bail!("the session's folder {folder} is gone or was emptied: bring it back and run this again");
        }
        let name = format!("{}_{:03}.{extension}", slug(&sidecar.photo.variant), self.next);
        sidecar.photo.file = name.clone();
        let text = serde_json::to_string_pretty(&sidecar).map_err(|e| FileError::content(SIDECAR.as_ref(), e))?;
        files::replace_atomically(&self.folder, &self.folder.join(&name), original)?;
        // From here on the number is used, even when what follows fails.
        self.next += 1;
        let beside = self.folder.join(sidecar_of(&name));
        files::replace_atomically(&self.folder, &beside, (text + "\n").as_bytes())?;
        self.accepted.push(sidecar);
        self.write_list()?;
        Ok(name)
    }

    /// Moves a photo and its sidecar to `taken_back`; the session no longer lists it.
    ///
    /// # Errors
    /// A file that cannot be moved or written. Opening the session again finishes what was begun.
    pub fn take_back(&mut self, photo: &str) -> Result<(), StoreError> {
        let Some(at) = self.accepted.iter().position(|sidecar| sidecar.photo.file == photo) else {
            return Ok(());
        };
        // The sidecar goes first: without it the photo is no longer accepted.
        self.put_away(&sidecar_of(photo))?;
        let sidecar = self.accepted.remove(at);
        self.taken_back.push(sidecar.sha256);
        self.write_list()?;
        self.put_away(photo)
    }

    /// Moves a file of the session to `taken_back`.
    pub(super) fn put_away(&self, name: &str) -> Result<(), StoreError> {
        let (from, away) = (self.folder.join(name), self.folder.join(TAKEN_BACK));
        Ok(files::chosen::rename(&self.folder, &from, &away.join(name))?)
    }

    /// Writes `session.json`; there is none while it would list no photo.
    pub(super) fn write_list(&self) -> Result<(), StoreError> {
        let path = self.folder.join(SESSION);
        let accepted = self.accepted.iter().map(|sidecar| &sidecar.photo);
        let photos: Vec<PhotoEntry> = self.others.iter().chain(accepted).cloned().collect();
        if photos.is_empty() {
            return Ok(files::chosen::remove(&self.folder, &path)?);
        }
        let text = session::text(&path, SCENE, Some(&self.camera), photos, false)?;
        Ok(files::replace_atomically(&self.folder, &path, text.as_bytes())?)
    }
}

/// Returns the name of a photo's sidecar.
pub fn sidecar_of(photo: &str) -> String {
    let stem = photo.rsplit_once('.').map_or(photo, |(stem, _)| stem);
    format!("{stem}{SIDECAR}")
}

/// Returns a variant as the beginning of a file name: ASCII letters and digits, and dashes for all else, but none at the ends: programs take a name
/// that begins with one for an option.
pub fn slug(variant: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let dashed: String = variant.chars().map(plain).take(40).collect();
    match dashed.trim_matches('-') {
        "" => "photo".into(),
        name => name.into(),
    }
}

/// Refuses a folder with files that no capture has begun: nothing in it may be taken for a photo of ours.
fn refuse_foreign(folder: &Path) -> Result<(), StoreError> {
    let there = names(folder)?;
    if there.iter().any(|name| name == SESSION || name == filling::MARK)
        || there.iter().all(|name| name.starts_with('.'))
    {
        return Ok(());
    }
    let why = "it has files and is no session: capture into a new folder";
    Err(FileError::content(folder, why).into())
}

/// Returns true if a file has a name that this store gives to photos of one of these textures.
pub(super) fn is_ours<'a>(name: &str, variants: impl IntoIterator<Item = &'a str>) -> bool {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let number = number(name).filter(|_| !name.ends_with(SIDECAR));
    number.is_some_and(|number| {
        let mut variants = variants.into_iter();
        variants.any(|variant| stem == format!("{}_{number:03}", slug(variant)))
    })
}

/// Returns the number at the end of a name that this store gave.
pub(super) fn number(name: &str) -> Option<u64> {
    let endings = [SIDECAR, ".jpg", ".png"];
    let stem = endings.iter().find_map(|ending| name.strip_suffix(ending))?;
    let (_, digits) = stem.rsplit_once('_')?;
    (digits.len() >= 3 && digits.bytes().all(|b| b.is_ascii_digit())).then(|| digits.parse().ok())?
}

/// Copies a file into a new session; that of an old one must be the same.
fn keep_copy(from: &Path, folder: &Path, name: &str, what: &'static str, is_new: bool) -> Result<(), StoreError> {
    let content = files::read(from)?;
    let path = folder.join(name);
    if path.exists() && files::read(&path)? == content {
        return Ok(());
    }
    if is_new && !path.exists() {
        return Ok(files::replace_atomically(folder, &path, &content)?);
    }
    let folder = folder.display();
    bail!("{folder} was captured with another {what}: give that one, or capture into a new folder")
}

/// Reads the sidecars of a folder, by the name of their photo.
pub(super) fn sidecars(folder: &Path) -> Result<BTreeMap<String, Sidecar>, StoreError> {
    let mut found = BTreeMap::new();
    for name in names(folder)?.into_iter().filter(|name| name.ends_with(SIDECAR)) {
        let path = folder.join(&name);
        let sidecar: Sidecar = serde_json::from_str(&files::read_text(&path)?).map_err(|e| {
            let message = format!("it is no sidecar of a capture ({e}): bring the original back");
            FileError::content(&path, message)
        })?;
        if sidecar_of(&sidecar.photo.file) != name {
            let message = format!("it is the sidecar of {}: give it its name back", sidecar.photo.file);
            return Err(FileError::content(&path, message).into());
        }
        found.insert(sidecar.photo.file.clone(), sidecar);
    }
    Ok(found)
}

/// Returns the names in a folder, sorted; none when it is missing.
pub(super) fn names(folder: &Path) -> Result<Vec<String>, StoreError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let unreadable = |e: std::io::Error| FileError::read(folder, &e);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        names.push(entry.map_err(unreadable)?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
