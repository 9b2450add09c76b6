//! Files read whole, with limits.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::FileError;
use super::inputs;

/// Maximum size of a file, bytes: a frame set's list, a COCO file and a network's weights have some hundred megabytes.
const MOST_BYTES: u64 = 4 << 30;

/// Reads a whole file of up to 4 GiB.
pub fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    read_at_most(path, MOST_BYTES)
}

/// Reads a whole file, and refuses one of more than `most_bytes` before it takes memory.
pub fn read_at_most(path: &Path, most_bytes: u64) -> Result<Vec<u8>, FileError> {
    let failed = |e| FileError::read(path, &e);
    let about = std::fs::metadata(path).map_err(failed)?;
    inputs::note(path);
    // Reading a named pipe would wait for ever.
    if !about.is_file() {
        return Err(FileError::cannot_read(path, not_a_file(path)));
    }
    let mut bytes = Vec::new();
    if about.len() <= most_bytes {
        // Room for the whole file, so that the buffer is not copied as it fills. The file may grow meanwhile.
        let no_room = |_| FileError::cannot_read(path, "the memory does not suffice for it");
        bytes.try_reserve_exact(about.len() as usize + 1).map_err(no_room)?;
        let file = File::open(path).map_err(failed)?;
        file.take(most_bytes + 1).read_to_end(&mut bytes).map_err(failed)?;
    }
    if about.len().max(bytes.len() as u64) > most_bytes {
        let reason = format!("it has more than the {} MB that are read", most_bytes >> 20);
        return Err(FileError::cannot_read(path, reason));
    }
    Ok(bytes)
}

/// Maximum size of a text, bytes: the annotations of a large set have some hundred megabytes.
const MOST_TEXT: u64 = 1 << 30;

/// Reads a whole UTF-8 text file of up to 1 GiB.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    read_text_at_most(path, MOST_TEXT)
}

/// Reads a UTF-8 text as [`read_at_most`] does.
pub fn read_text_at_most(path: &Path, most_bytes: u64) -> Result<String, FileError> {
    String::from_utf8(read_at_most(path, most_bytes)?).map_err(|_| FileError::cannot_read(path, "it is not UTF-8 text"))
}

/// Describes a folder in a file's place, with those of the usual files that it holds.
pub(super) fn not_a_file(path: &Path) -> String {
    let usual = ["pattern.png", "scene.toml", "camera.yaml", "session.json"];
    let inside: Vec<String> = usual
        .iter()
        .map(|name| path.join(name))
        .filter(|inside| inside.is_file())
        .map(|inside| inside.display().to_string())
        .collect();
    if inside.is_empty() {
        "it is not a file".to_owned()
    } else {
        format!("it is not a file; it holds {}", inside.join(", "))
    }
}
