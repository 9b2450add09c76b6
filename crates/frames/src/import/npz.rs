//! Arrays of NumPy in an archive, as `np.savez` writes it, bounded before anything is unpacked.

use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

use npyz::{Deserialize, NpyFile, Order};
use zip::ZipArchive;

use crate::FramesError;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, ensure, message};

/// Most bytes of a file, and of an array in it: more than twice the largest image that is read.
const MOST_BYTES: u64 = 32 << 20;
/// Most bytes before an array's numbers. NumPy writes 128; nested brackets would take a parser's stack.
const MOST_HEADER_BYTES: usize = 512;

/// An opened `.npz` file.
pub(super) struct Archive {
    path: PathBuf,
    zip: ZipArchive<Cursor<Vec<u8>>>,
}

/// An array whose shape is known, and whose numbers are not yet read.
pub(super) struct Array {
    path: PathBuf,
    name: String,
    file: NpyFile<Cursor<Vec<u8>>>,
}

impl Archive {
    pub(super) fn open(path: &Path) -> Result<Self, FramesError> {
        let bytes = files::read_at_most(path, MOST_BYTES)?;
        let broken = |e| FileError::content(path, format!("it is no whole archive of NumPy ({e}): save it again"));
        Ok(Self {
            path: path.to_owned(),
            zip: ZipArchive::new(Cursor::new(bytes)).map_err(broken)?,
        })
    }

    pub(super) fn array(&mut self, name: &str) -> Result<Array, FramesError> {
        let files = self.zip.file_names();
        let mut names: Vec<&str> = files.filter_map(|file| file.strip_suffix(".npy")).collect();
        if !names.contains(&name) {
            names.sort_unstable();
            names.truncate(LISTED);
            let message = format!("it has no array {name}; it has {}", names.join(", "));
            return Err(FileError::content(&self.path, message).into());
        }
        let wrong = |reason: &str| FileError::content(&self.path, format!("the array {name} {reason}"));
        let mut bytes = Vec::new();
        let entry = self.zip.by_name(&format!("{name}.npy"));
        let entry = entry.map_err(|e| wrong(&format!("cannot be read ({e})")))?;
        let read = entry.take(MOST_BYTES + 1).read_to_end(&mut bytes);
        read.map_err(|e| wrong(&damaged(&e)))?;
        Ok(Array {
            file: array_of(bytes).map_err(|reason| wrong(&reason.to_string()))?,
            path: self.path.clone(),
            name: name.to_owned(),
        })
    }
}

fn damaged(e: &std::io::Error) -> String {
    format!("is damaged ({e}): save it again")
}

/// Reads the header of an array; errors are the end of a sentence about it.
fn array_of(bytes: Vec<u8>) -> Result<NpyFile<Cursor<Vec<u8>>>, Message> {
    ensure!(
        bytes.len() as u64 <= MOST_BYTES,
        "has more than {} MB",
        MOST_BYTES >> 20
    );
    let is_short = header_bytes(&bytes) <= MOST_HEADER_BYTES;
    ensure!(is_short, "has a header that NumPy does not write");
    let file = NpyFile::new(Cursor::new(bytes)).map_err(|e| message!("{}", damaged(&e)))?;
    ensure!(!file.uses_pickled_array(), "holds Python objects: save numbers");
    let is_rows = file.order() != Order::Fortran;
    ensure!(is_rows, "is in Fortran's order: save np.ascontiguousarray of it");
    Ok(file)
}

/// The most names that a message lists.
const LISTED: usize = 8;

/// Returns the length of the header as the beginning of an array states it (NumPy's format 1, 2 and 3).
fn header_bytes(bytes: &[u8]) -> usize {
    match bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => usize::from(u16::from_le_bytes([*a, *b])),
        [_, _, _, _, _, _, _, _, a, b, c, d, ..] => u32::from_le_bytes([*a, *b, *c, *d]) as usize,
        _ => 0,
    }
}

impl Array {
    pub(super) fn shape(&self) -> &[u64] {
        self.file.shape()
    }

    pub(super) fn wrong(&self, reason: &str) -> FramesError {
        FileError::content(&self.path, format!("the array {} {reason}", self.name)).into()
    }

    pub(super) fn wrong_shape(&self, wanted: &str) -> FramesError {
        let shape: Vec<String> = self.shape().iter().map(u64::to_string).collect();
        self.wrong(&format!("is {} and must be {wanted}", shape.join("×")))
    }

    /// Reads the numbers, of the type `T`, which errors call `wanted`; check the shape first.
    pub(super) fn numbers<T: Deserialize>(self, wanted: &str) -> Result<Vec<T>, FramesError> {
        let kind = self.file.dtype().descr();
        let Self { path, name, file } = self;
        let wrong = |reason: String| FileError::content(&path, format!("the array {name} {reason}"));
        let numbers = file
            .data()
            .map_err(|_| wrong(format!("holds {kind} and must hold {wanted}")))?;
        let all: std::io::Result<Vec<T>> = numbers.collect();
        Ok(all.map_err(|e| wrong(damaged(&e)))?)
    }

    /// Reads floating-point numbers of 32 or 64 bits.
    pub(super) fn reals(self) -> Result<Vec<f64>, FramesError> {
        if f32::reader(&self.file.dtype()).is_ok() {
            let numbers = self.numbers::<f32>("")?;
            return Ok(numbers.into_iter().map(f64::from).collect());
        }
        self.numbers("32- or 64-bit floating point")
    }
}
