//! Placement of annotated copies of photos, such that no photo and no foreign file is replaced.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};

use crate::PhotoError;

/// Mark in a JPEG's comment: a file with it may be replaced by the next run.
const MARK: &[u8] = b"drawn by scaleproof";

/// JPEG quality, 1 to 100.
const QUALITY: u8 = 90;

/// Reason why there are no copies.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CopiesError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// Returns the path of each photo's copy in `folder`; `setting` is the name of the folder's setting, for hints. `named` makes a file name from the
/// photo's own without its ending, and a number from 1 for those of the same name.
pub fn places(
    folder: &Path,
    photos: &[PathBuf],
    setting: &str,
    named: impl Fn(&str, u32) -> String,
) -> Result<Vec<PathBuf>, CopiesError> {
    let whole = folder.canonicalize();
    let holds = |photo: &&PathBuf| {
        let parent = photo.canonicalize().ok().and_then(|p| p.parent().map(Path::to_owned));
        whole.as_ref().is_ok_and(|whole| parent.as_ref() == Some(whole))
    };
    if let Some(photo) = photos.iter().find(holds) {
        let (folder, photo) = (folder.display(), photo.display());
        bail!("{folder} holds the photo {photo}"; hint: "name another folder by ‹{setting}›");
    }
    let mut taken = BTreeSet::new();
    let mut free_name = |photo: &PathBuf| {
        let stem = photo.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        // A free name is found among the first ones: each photo takes one.
        let name = (1..)
            .map(|number| named(&stem, number))
            .find(|name| !taken.contains(name));
        taken.extend(name.clone());
        folder.join(name.unwrap_or_default())
    };
    let places: Vec<PathBuf> = photos.iter().map(&mut free_name).collect();
    match places
        .iter()
        .find(|place| place.symlink_metadata().is_ok() && !is_drawn(place))
    {
        Some(path) => {
            let path = path.display();
            bail!("{path} is in the way: no earlier run has drawn it"; hint: "name another folder by ‹{setting}›")
        }
        None => Ok(files::check_writable(folder).map(|()| places)?),
    }
}

/// Writes the copy at one of [`places`].
pub fn write(place: &Path, image: &RgbImage) -> Result<(), CopiesError> {
    let mut jpeg = Vec::new();
    let encoded = JpegEncoder::new_with_quality(&mut jpeg, QUALITY).encode_image(image);
    encoded.map_err(|_| message!("{} cannot be encoded as JPEG", place.display()))?;
    Ok(files::replace_all_atomically(
        files::folder_of(place),
        &[(place, marked(&jpeg))],
    )?)
}

/// Returns true if a file begins with the mark of [`marked`].
fn is_drawn(path: &Path) -> bool {
    let mut start = Vec::new();
    let is_file = path.symlink_metadata().is_ok_and(|about| about.is_file());
    let read = is_file.then(|| std::fs::File::open(path).and_then(|file| file.take(64).read_to_end(&mut start)));
    matches!(read, Some(Ok(_))) && start.starts_with(&marked(&[0xFF, 0xD8]))
}

/// Inserts the mark into a JPEG as its first segment, a comment (ITU-T T.81, B.2.4.5).
fn marked(jpeg: &[u8]) -> Vec<u8> {
    let length = (MARK.len() as u16 + 2).to_be_bytes();
    let rest = jpeg.get(2..).unwrap_or_default();
    [&[0xFF, 0xD8, 0xFF, 0xFE][..], &length[..], MARK, rest].concat()
}
