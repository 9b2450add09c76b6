//! JPEGs (ITU-T T.81): their data is read once into coefficients, of which pixels are made at the size and place that somebody needs.
//!
//! Sequential and progressive images of 8 bits with Huffman codes, as cameras write them. Why not a library: none keeps the coefficients
//! small, and those that are fast fill what damaged data leaves open; see `docs/lessons/photos.md`.

mod bits;
mod coefficients;
mod colour;
mod frame;
mod huffman;
mod inverse_dct;
mod pixels;
mod read;
mod scan;
mod segments;
mod standard;
mod upsample;

pub(super) use frame::{Colours, Frame};
pub(super) use read::Coefficients;
pub use standard::standard_huffman_tables;

/// Why there is no picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum JpegError {
    Truncated,
    /// Why, as a clause.
    Damaged(&'static str),
    /// Its coefficients do not fit the memory allowed.
    TooManyValues,
}
