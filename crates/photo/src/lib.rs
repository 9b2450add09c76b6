//! Photos: limits on the cost of decoding, upright pixels at any size, EXIF; lines and labels drawn into images.
//!
//! Every image is measured by its header before it is decoded ([`photo::Budget`]), and photos are turned as EXIF says.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_photo::photo::Photo;
//!
//! let photo = Photo::open(Path::new("../../captures/skyline/normal_000.jpg"))?;
//! let luma = photo.luma()?;
//! assert_eq!((luma.width(), luma.height()), (photo.width, photo.height));
//! # Ok::<(), scaleproof_photo::photo::PhotoError>(())
//! ```

pub mod copies;
pub mod defence;
pub mod draw;
pub mod photo;
