//! Photos as users name them: files, or folders, which stand for the photos that lie in them.

use std::path::{Path, PathBuf};

use super::Result;
use scaleproof_core::spelling;
use scaleproof_session::folders::{Listing, not_read};

/// The photos of what is named, those of a folder by name; images that are passed over are noted.
pub(super) fn of(named: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut photos = Vec::new();
    for path in named {
        if !path.is_dir() {
            photos.push(path.clone());
            continue;
        }
        let (folder, listing) = (path.display().to_string(), Listing::of(path)?);
        if listing.photos.is_empty() {
            return Err(format!("the folder {folder} has no photos{}", listing.instead(path)).into());
        }
        note_passed_over(&listing, path);
        photos.extend(listing.photos.iter().map(|name| path.join(name)));
    }
    Ok(photos)
}

/// Says which images of a folder are left out.
pub(super) fn note_passed_over(listing: &Listing, folder: &Path) {
    if let Some(first) = listing.other_images.first() {
        let count = listing.other_images.len();
        say!(
            "note: {} in {} {} left out, being neither JPEG nor PNG or there in JPEG too (the first: {first}{})",
            spelling::count(count, "image"),
            folder.display(),
            spelling::choose(count, "is", "are"),
            not_read(&folder.join(first))
        );
    }
}
