//! In-memory session of folders of photos, one texture each: nothing is written, and the photos stay unchanged.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use crate::error::SessionError;
use crate::list::PhotoEntry;
use crate::opened::Session;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};
use scaleproof_photo as photo;

/// Lower-case endings of files read as photos.
const READABLE: [&str; 3] = ["jpg", "jpeg", "png"];
/// Lower-case endings of files read as photos if the system has a decoder for them.
const HEIF: [&str; 3] = ["heic", "heif", "avif"];
/// Endings of images that are reported when skipped.
const OTHER_IMAGES: [&str; 15] = [
    "heic", "heif", "avif", "webp", "tif", "tiff", "bmp", "gif", "dng", "cr2", "cr3", "nef", "arw", "raf", "rw2",
];

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhotoFolder {
    pub variant: String,
    /// Place of the photos, if it differs from that of the other folders.
    pub place: Option<String>,
    pub folder: PathBuf,
}

/// Contents of a folder of photos, each sorted by name. Hidden files are skipped.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Listing {
    /// Names of JPEG and PNG files, by their ending.
    pub photos: Vec<String>,
    /// Names of images in formats that are not read.
    pub other_images: Vec<String>,
    pub folders: Vec<String>,
}

#[derive(Debug, Clone)]
pub struct Listed {
    pub given: PhotoFolder,
    pub real: PathBuf,
    pub listing: Listing,
}

/// Session that exists only in memory, and the folders it is made of.
#[derive(Debug, Clone)]
pub struct Gathered {
    /// Session whose folder is the closest one that contains all photos.
    pub session: Session,
    /// Folders in the order they were given.
    pub folders: Vec<Listed>,
}

/// Makes a session of folders: their photos in the order of the folders and by name, with `place` for folders without a place of their own.
pub fn gather(folders: &[PhotoFolder], scene: &Path, camera: &Path, place: &str) -> Result<Gathered, SessionError> {
    let mut listed: Vec<Listed> = Vec::new();
    for folder in folders {
        let found = list(folder)?;
        if listed.iter().any(|other| other.real == found.real) {
            bail!(
                "the folder {} is given twice: each photo counts once",
                folder.folder.display()
            );
        }
        listed.push(found);
    }
    let common = common_folder(&listed);
    let mut photos = Vec::new();
    for found in &listed {
        let below = text_path(found.real.strip_prefix(&common).unwrap_or(&found.real))?;
        photos.extend(found.listing.photos.iter().map(|name| PhotoEntry {
            file: joined(&below, name),
            variant: found.given.variant.clone(),
            place: Some(found.given.place.as_deref().unwrap_or(place).to_owned()),
            ..PhotoEntry::default()
        }));
    }
    let mut session = Session::assembled(&common, &common, scene, Some(camera), photos, Vec::new())?;
    if session.name.is_empty() {
        "photos".clone_into(&mut session.name);
    }
    let folders = listed;
    Ok(Gathered { session, folders })
}

/// Returns `folder/name`, or just the name for no folder.
pub(crate) fn joined(folder: &str, name: &str) -> String {
    match folder {
        "" => name.to_owned(),
        folder => format!("{folder}/{name}"),
    }
}

pub(crate) fn text_path(path: &Path) -> Result<String, SessionError> {
    let part = |part: Component| part.as_os_str().to_str().map(str::to_owned);
    let parts: Option<Vec<String>> = path.components().map(part).collect();
    Ok(parts.ok_or_else(|| not_text(path))?.join("/"))
}

fn not_text(path: &Path) -> Message {
    message!("the name {} is not UTF-8 text: rename it", path.display())
}

fn list(given: &PhotoFolder) -> Result<Listed, SessionError> {
    let folder = &given.folder;
    let named = format!("{}={}", given.variant, folder.display());
    match std::fs::metadata(folder) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => bail!("{named}: there is no such folder"),
        Ok(about) if !about.is_dir() => bail!("{named}: this is a file; name the folder with the photos"),
        _ => {}
    }
    let listing = Listing::of(folder)?;
    if listing.photos.is_empty() {
        bail!(
            "{named}: the folder has no JPEG or PNG files{}",
            listing.instead(folder)
        );
    }
    Ok(Listed {
        real: files::whole_path(folder)?,
        given: given.clone(),
        listing,
    })
}

impl Listing {
    /// Lists a folder.
    pub fn of(folder: &Path) -> Result<Listing, SessionError> {
        let mut listing = Listing::default();
        for entry in std::fs::read_dir(folder).map_err(|e| FileError::read(folder, &e))? {
            let path = entry.map_err(|e| FileError::read(folder, &e))?.path();
            // A broken link is neither a file nor a folder. With a photo's name it counts as an unreadable photo, or nobody would notice.
            let about = std::fs::metadata(&path).ok();
            let is_dir = about.as_ref().is_some_and(std::fs::Metadata::is_dir);
            let is_file = about.as_ref().is_some_and(std::fs::Metadata::is_file);
            let name = path.file_name().unwrap_or_default();
            let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            let kind = match (is_dir, is_file) {
                (true, _) => &mut listing.folders,
                _ if is_readable(&ending) => &mut listing.photos,
                (_, true) if OTHER_IMAGES.contains(&ending.as_str()) => &mut listing.other_images,
                _ => continue,
            };
            match name.to_str() {
                Some(name) if name.starts_with('.') => {}
                Some(name) => kind.push(name.to_owned()),
                None if is_dir => {}
                None => return Err(not_text(&path).into()),
            }
        }
        listing.drop_twins();
        listing.photos.sort();
        listing.other_images.sort();
        listing.folders.sort();
        Ok(listing)
    }

    /// Returns the other content of a folder without photos, in brackets; empty if there is none.
    pub fn instead(&self, folder: &Path) -> String {
        match (self.other_images.first(), self.folders.first()) {
            (Some(other), _) => format!(" (it has {other}{})", not_read(&folder.join(other))),
            (None, Some(inner)) => format!(" (those in folders inside it, as {inner}, are not read: name these)"),
            (None, None) => String::new(),
        }
    }

    /// Removes HEIC files beside a JPEG or PNG of the same name: both are one photo, counted once.
    fn drop_twins(&mut self) {
        let parts = |name: &str| {
            let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
            (stem.to_lowercase(), ending.to_lowercase())
        };
        let all = self.photos.iter().map(|name| parts(name));
        let plain = all.filter(|(_, ending)| READABLE.contains(&ending.as_str()));
        let plain: BTreeSet<String> = plain.map(|(stem, _)| stem).collect();
        let is_twin = |name: &mut String| {
            let (stem, ending) = parts(name);
            HEIF.contains(&ending.as_str()) && plain.contains(&stem)
        };
        let twins: Vec<String> = self.photos.extract_if(.., is_twin).collect();
        self.other_images.extend(twins);
    }

    pub fn is_photo(path: &Path) -> bool {
        is_readable(&path.extension().unwrap_or_default().to_string_lossy().to_lowercase())
    }
}

/// Returns advice for an image that is not read, to follow its name; empty for one that would be read.
pub fn not_read(path: &Path) -> String {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ending.as_str() {
        _ if is_readable(&ending) => String::new(),
        "heic" | "heif" => format!(": {}", photo::heif_remedy(path, "HEIC")),
        "avif" => format!(": {}", photo::heif_remedy(path, "AVIF")),
        _ => ": convert it to JPEG".to_owned(),
    }
}

fn is_readable(ending: &str) -> bool {
    READABLE.contains(&ending) || (HEIF.contains(&ending) && photo::reads_heif())
}

/// Returns the closest folder that contains all of these or is one of them.
fn common_folder(folders: &[Listed]) -> PathBuf {
    let mut paths = folders.iter().map(|found| found.real.as_path());
    let first = paths.next().unwrap_or(Path::new("")).to_owned();
    paths.fold(first, |common, path| {
        let same = common.components().zip(path.components()).take_while(|(a, b)| a == b);
        same.map(|(part, _)| part).collect()
    })
}
