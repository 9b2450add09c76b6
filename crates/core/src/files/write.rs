//! Files written whole or not at all, and those of one command together.

use std::fs::File;
use std::path::Path;

use super::error::FileError;
use super::path::folder_of;
use super::place::OutputPlace;
use super::staged::{Staged, new_beside};
use super::{chosen, inputs, journal, place};
use crate::workers::interruption;

/// Writes an output that a user named: [`write_all_atomically`] of one file.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), FileError> {
    write_all_atomically(&[(path, content)])
}

/// Writes outputs that a user named, together: each is whole under a temporary name before the first takes its place, and a run that is
/// killed between two of them leaves a note by which the next one that writes into the folder finishes (`journal.rs`). Missing parent
/// folders are made.
///
/// A symbolic link stays, and its target is written. Standard output (`-`), pipes and character devices are written to. What is neither is
/// refused before anything is written, and so is the place of an input ([`inputs`]).
pub fn write_all_atomically(files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    write_some_named(files, |_| true)
}

/// Writes outputs as [`write_all_atomically`] does, of which a user named these alone: the names of the others this program made of them, so that a
/// link in the place of one is replaced and never followed ([`chosen`]).
pub fn write_beside(named: &[&Path], files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    write_some_named(files, |path| named.contains(&path))
}

fn write_some_named(
    files: &[(impl AsRef<Path>, impl AsRef<[u8]>)],
    is_named: impl Fn(&Path) -> bool,
) -> Result<(), FileError> {
    let (mut regular, mut streams) = (Vec::new(), Vec::new());
    for (path, content) in files {
        let path = path.as_ref();
        if !is_named(path) {
            chosen::check(path.parent().unwrap_or(Path::new("")), path)?;
            regular.push((path.to_owned(), content));
            continue;
        }
        match OutputPlace::at(path)? {
            OutputPlace::File(path) => regular.push((path, content)),
            OutputPlace::Stream(stream) => streams.push((stream, content)),
        }
    }
    inputs::refuse_twice(regular.iter().map(|(path, _)| path.as_path()))?;
    replace_all(&regular)?;
    let mut streams = streams.into_iter();
    streams.try_for_each(|(stream, content)| place::write_to(&stream, content.as_ref()))
}

/// Writes files whose names this program chose below a folder that a user named, together, as [`write_all_atomically`] does. A link in the place
/// of one is replaced, and one in the place of a folder between is refused ([`chosen`]): the folder may come from somebody else.
pub fn replace_all_atomically(home: &Path, files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    files
        .iter()
        .try_for_each(|(path, _)| chosen::check(home, path.as_ref()))?;
    replace_all(files)
}

fn replace_all(files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    interruption::check();
    files.iter().try_for_each(|(path, _)| inputs::refuse(path.as_ref()))?;
    let mut staged = Vec::new();
    for (path, content) in files {
        journal::tidy(folder_of(path.as_ref()));
        staged.push(Staged::write(path.as_ref(), content.as_ref())?);
    }
    interruption::check();
    journal::persist_all(staged)
}

/// Writes one file as [`replace_all_atomically`] does, without a look at what killed runs left in the folder.
pub fn replace_atomically(home: &Path, path: &Path, content: &[u8]) -> Result<(), FileError> {
    chosen::check(home, path)?;
    inputs::refuse(path)?;
    Staged::write(path, content)?.persist().map(drop)
}

/// Finds out, before long work, that a folder is or can be made there and takes files. Makes nothing.
pub fn check_writable(folder: &Path) -> Result<(), FileError> {
    let there = folder
        .ancestors()
        .map(|f| if f.as_os_str().is_empty() { Path::new(".") } else { f })
        .find(|f| f.exists());
    match there {
        Some(there) if there.is_dir() => takes_files(there),
        Some(file) => Err(FileError::cannot_write(folder, format!("{} is a file", file.display()))),
        None => Err(FileError::cannot_write(folder, "no part of the path exists")),
    }
}

/// Tries a file that is removed at once; what killed runs left in the folder is removed, too.
fn takes_files(folder: &Path) -> Result<(), FileError> {
    journal::tidy(folder);
    let probe = folder.join(".scaleproof");
    let made = new_beside(&probe, |at| File::create_new(at).and_then(|_| std::fs::remove_file(at)));
    made.map(drop).map_err(|e| FileError::write(&probe, &e))
}

/// Finds out, before long work, that a file that a user named can be written: its folder takes files, or it is a stream. Makes nothing.
pub fn check_file_writable(path: &Path) -> Result<(), FileError> {
    match OutputPlace::at(path)? {
        OutputPlace::File(path) => {
            inputs::refuse(&path)?;
            check_writable(folder_of(&path))
        }
        OutputPlace::Stream(_) => Ok(()),
    }
}
