//! The one door for files and folders whose names this program chooses, below a folder that a user named.
//!
//! That folder, the home, may come from somebody else, and what lies in it may lead out of it. So each folder between the home and a file is a real
//! one or is made, nothing is written or removed through a link, nothing is written into a file that has another name elsewhere, and nothing waits
//! for a pipe. What is written gets its name when it is whole, and what is an input stays ([`inputs`]).
//!
//! Folders are looked at, not held: this is no guard against somebody who puts links into the home while it is written to.

use std::fs::{File, Metadata, OpenOptions};
use std::io::Read;
use std::path::{Component, Path};

use super::error::FileError;
use super::inputs;

/// Looks at what lies at a place itself, and not at what a link there leads to.
fn metadata_of(path: &Path) -> Option<Metadata> {
    std::fs::symlink_metadata(path).ok()
}

/// Refuses a path that does not lead from its home through real folders, or folders that are not there yet, to a name.
pub(super) fn check(home: &Path, path: &Path) -> Result<(), FileError> {
    let outside = || FileError::cannot_write(path, format!("it does not lie below {}", home.display()));
    let below = match path.strip_prefix(home) {
        Ok(below) => below,
        // A mere name lies in this folder.
        Err(_) if home == Path::new(".") && path.is_relative() => path,
        Err(_) => return Err(outside()),
    };
    if below.as_os_str().is_empty() || !below.components().all(|part| matches!(part, Component::Normal(_))) {
        return Err(outside());
    }
    let mut folder = home.to_owned();
    for part in below.parent().into_iter().flat_map(Path::components) {
        folder.push(part);
        is_folder_or_absent(&folder)?;
    }
    Ok(())
}

fn is_folder_or_absent(folder: &Path) -> Result<bool, FileError> {
    match metadata_of(folder) {
        None => Ok(false),
        Some(about) if about.is_dir() => Ok(true),
        Some(_) => Err(FileError::cannot_write(
            folder,
            "a link or a file is in the place of a folder that this program makes: remove it, or name another output",
        )),
    }
}

/// Refuses a folder of this program's that is not a real one; it need not be there yet. A folder that is given on as the home of files was checked so.
pub fn check_folder(home: &Path, folder: &Path) -> Result<(), FileError> {
    check(home, folder)?;
    is_folder_or_absent(folder).map(drop)
}

/// Makes a folder, or takes the one that is there.
pub fn folder(home: &Path, folder: &Path) -> Result<(), FileError> {
    check_folder(home, folder)?;
    std::fs::create_dir_all(folder).map_err(|e| FileError::write(folder, &e))?;
    check_folder(home, folder)
}

/// Removes a file, or a link, if it is there and is no input.
pub fn remove(home: &Path, path: &Path) -> Result<(), FileError> {
    check(home, path)?;
    inputs::refuse(path)?;
    gone(path, std::fs::remove_file(path))
}

/// Removes a folder of this program's with all that lies in it, if it is there and no input lies in it.
pub fn remove_folder(home: &Path, folder: &Path) -> Result<(), FileError> {
    check_folder(home, folder)?;
    inputs::refuse_below(folder)?;
    gone(folder, std::fs::remove_dir_all(folder))
}

/// Accepts a removal that found nothing to remove.
fn gone(path: &Path, removed: std::io::Result<()>) -> Result<(), FileError> {
    match removed {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(FileError::write(path, &e)),
        _ => Ok(()),
    }
}

/// Moves a file of this program's to another place of the same home; folders on its way are made.
pub fn rename(home: &Path, from: &Path, to: &Path) -> Result<(), FileError> {
    check(home, from)?;
    check(home, to)?;
    inputs::refuse(to)?;
    if let Some(parent) = to.parent().filter(|parent| *parent != home) {
        folder(home, parent)?;
    }
    std::fs::rename(from, to).map_err(|e| FileError::write(to, &e))
}

/// Creates a file that is written bit by bit, such as a log; what had its name is removed.
pub fn new_file(home: &Path, path: &Path) -> Result<File, FileError> {
    remove(home, path)?;
    File::create_new(path).map_err(|e| FileError::write(path, &e))
}

/// Returns the length of a file that an earlier run began and this one goes on with; 0 where it is not there.
///
/// # Errors
/// It is no file, or has a second name: what is appended would be in that one, too.
pub fn begun(home: &Path, path: &Path) -> Result<u64, FileError> {
    check(home, path)?;
    match metadata_of(path) {
        None => Ok(0),
        Some(about) if about.is_file() && names(&about) == 1 => Ok(about.len()),
        Some(_) => Err(FileError::content(
            path,
            "it is no file that this program began: remove it",
        )),
    }
}

/// Opens a file that an earlier run began, to append to it.
pub fn appended(home: &Path, path: &Path) -> Result<File, FileError> {
    begun(home, path)?;
    inputs::refuse(path)?;
    let failed = |e| FileError::write(path, &e);
    ours(OpenOptions::new().append(true)).open(path).map_err(failed)
}

/// Opens a file that only says, by its lock, that a run is at work; made where it is missing, and never written to.
pub fn mark(home: &Path, path: &Path) -> Result<File, FileError> {
    begun(home, path)?;
    let failed = |e| FileError::write(path, &e);
    let mut options = OpenOptions::new();
    ours(options.write(true).create(true).truncate(false))
        .open(path)
        .map_err(failed)
}

/// Reads what an earlier run kept at a place; `None` if it is no regular file, cannot be read or has more than `most_bytes`. It is no input: it may be
/// written again.
pub fn kept(home: &Path, path: &Path, most_bytes: u64) -> Option<Vec<u8>> {
    check(home, path).ok()?;
    let file = ours(OpenOptions::new().read(true)).open(path).ok()?;
    let about = file.metadata().ok()?;
    let is_kept = about.is_file() && about.len() <= most_bytes;
    let mut bytes = Vec::new();
    is_kept.then(|| file.take(most_bytes).read_to_end(&mut bytes).ok())??;
    Some(bytes)
}

/// Opens no link that came in between, and waits for no pipe.
#[cfg(unix)]
fn ours(options: &mut OpenOptions) -> &mut OpenOptions {
    use rustix::fs::OFlags;
    use std::os::unix::fs::OpenOptionsExt;
    let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
    options.custom_flags(flags.bits() as i32)
}

#[cfg(not(unix))]
fn ours(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// Returns the number of a file's names.
#[cfg(unix)]
fn names(about: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::nlink(about)
}

#[cfg(not(unix))]
fn names(_: &Metadata) -> u64 {
    1
}
