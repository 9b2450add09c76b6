//! SHA-256 of contents.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::error::FileError;
use super::inputs;
use super::path::name_of;
use super::read::{not_a_file, read};

/// Returns the SHA-256 of some bytes, in lower-case hex.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Returns the SHA-256 of a file of any length, in lower-case hex; the file is read in parts.
pub fn sha256_of_file(path: &Path) -> Result<String, FileError> {
    let failed = |e| FileError::read(path, &e);
    inputs::note(path);
    if !path.metadata().map_err(failed)?.is_file() {
        return Err(FileError::cannot_read(path, not_a_file(path)));
    }
    let (mut file, mut hash) = (File::open(path).map_err(failed)?, Sha256::new());
    let mut part = vec![0; 1 << 20];
    loop {
        match file.read(&mut part).map_err(failed)? {
            0 => break,
            count => hash.update(&part[..count]),
        }
    }
    Ok(hex(&hash.finalize()))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// Returns a file's name with its SHA-256.
pub fn hashed(path: &Path) -> Result<(String, String), FileError> {
    Ok((name_of(path), sha256_hex(&read(path)?)))
}
