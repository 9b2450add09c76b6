//! Photos on their way from a camera: a folder of this program's own, in which gphoto2 lays them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::error::TetherError;
use crate::capture::source::Original;
use scaleproof_core::files;
use scaleproof_photo::photo::Budget;

/// gphoto2 writes into a file of this name and renames it when it is whole.
const UNFINISHED: &str = "tmpfile";

/// A folder that is gone with this; only its user may enter it.
pub(super) struct Arrivals {
    folder: TempDir,
}

impl Arrivals {
    pub(super) fn new() -> Result<Arrivals, TetherError> {
        let folder = tempfile::Builder::new().prefix("scaleproof-").tempdir();
        let folder = folder.map_err(|e| TetherError::NoRoom(files::plain(&e)))?;
        Ok(Arrivals { folder })
    }

    pub(super) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// A JPEG that has arrived, under the camera's name for it; it is taken out of the folder. What else came with it stays until
    /// [`Arrivals::others`] is asked.
    pub(super) fn take_jpeg(&self) -> Option<(String, Original)> {
        let path = self.whole().into_iter().find(|path| is_jpeg(path))?;
        let read = files::read_at_most(&path, Budget::FILE.bytes);
        let _ = std::fs::remove_file(&path);
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Some((name, Original::from_file(read)))
    }

    /// The names of files that are no JPEG, which are removed.
    pub(super) fn others(&self) -> BTreeSet<String> {
        let others = self.whole().into_iter().filter(|path| !is_jpeg(path));
        let names = others.map(|path| {
            let _ = std::fs::remove_file(&path);
            path.file_name().unwrap_or_default().to_string_lossy().into_owned()
        });
        names.collect()
    }

    fn whole(&self) -> BTreeSet<PathBuf> {
        let there = std::fs::read_dir(self.folder()).into_iter().flatten().flatten();
        let is_whole = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            !name.starts_with(UNFINISHED)
        };
        there.map(|entry| entry.path()).filter(is_whole).collect()
    }
}

fn is_jpeg(path: &Path) -> bool {
    let mut start = [0; 3];
    let read = std::fs::File::open(path).and_then(|mut file| std::io::Read::read_exact(&mut file, &mut start));
    read.is_ok() && start == [0xFF, 0xD8, 0xFF]
}
