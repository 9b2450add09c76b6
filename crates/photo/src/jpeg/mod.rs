//! JPEG decoder (ITU-T T.81): the data is read once into coefficients, from which pixels are computed at the size and place needed.
//!
//! Supports sequential and progressive images of 8 bits with Huffman codes, as cameras write them. No library is used, since none keeps the
//! coefficients compact, and the fast ones fill gaps of damaged data; see `docs/lessons/photos.md`.

mod bits; // bits of entropy-coded data
mod coefficients; // DCT coefficients, sparse or dense
mod colour; // samples to RGB
mod error; // reasons why there is no picture
mod frame; // headers
mod huffman; // Huffman codes
mod inverse_dct; // coefficients to samples
mod pixels; // coefficients to pixels of any size and place
mod read; // the file to coefficients
mod scan; // a scan's data to coefficients
mod segments; // segments of the file
mod standard; // the standard's Huffman tables
mod upsample; // coarse samples to full size

pub(super) use error::JpegError;
pub(super) use frame::{Colours, Frame};
pub use pixels::REDUCTIONS;
pub(super) use read::Coefficients;
pub use standard::standard_huffman_tables;
