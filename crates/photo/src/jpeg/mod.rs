//! JPEG decoder (ITU-T T.81): the data is read once into coefficients, from which pixels are computed at the size and place needed.
//!
//! Supports sequential and progressive images of 8 bits with Huffman codes, as cameras write them. No library is used, since none keeps the
//! coefficients compact, and the fast ones fill gaps of damaged data; see `docs/lessons/photos.md`.

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

/// Reason why there is no picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum JpegError {
    Truncated,
    /// Damage, as a clause.
    Damaged(&'static str),
    /// The coefficients do not fit the memory allowed.
    TooManyValues,
}
