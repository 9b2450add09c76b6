//! Photos, decoded upright and only as far as needed, or refused with a reason; lines and labels drawn into copies of them.
//!
//! Every image is measured by its header before it is decoded ([`Budget`]), and photos are turned as EXIF says. A file is never written back.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_photo::Photo;
//!
//! let photo = Photo::open(Path::new("../../captures/skyline/normal_000.jpg"))?;
//! let luma = photo.luma()?;
//! assert_eq!((luma.width(), luma.height()), (photo.width, photo.height));
//! # Ok::<(), scaleproof_photo::PhotoError>(())
//! ```

mod budget; // what decoding an image may cost
pub mod copies; // where copies of photos with something drawn in go
mod cubic; // cubic interpolation as OpenCV's
mod decode; // bytes of a JPEG or PNG to pixels
pub mod defence; // what papers do to an image before a network sees it
pub mod draw; // lines and labels in images
mod encode; // pictures to JPEG and PNG
mod error; // reasons why a photo cannot be used
mod exif_tags; // EXIF: lens, time, exposure, orientation
mod heif; // HEIC files, by the system's decoder
mod jpeg; // JPEG data to coefficients and pixels
mod luma; // luma where it is needed
mod orientation; // turns between the sensor's image and the upright one
mod perceptual; // a hash by which near-copies are found
mod photo; // a photo: its file, its header, its pixels
mod resample; // resizing as Pillow does
mod resize; // resizing as OpenCV does, and for display

pub use budget::{Budget, DecodeCost};
pub use cubic::{CubicTap, cubic_taps, opencv_cubic};
pub use decode::open_png;
pub use encode::{as_jpeg, preview_jpeg, sensor_jpeg, sensor_png};
pub use error::{DecodeProblem, IPHONE_TO_JPEG, PhotoError, heif_remedy};
pub use exif_tags::{Lens, Shot};
pub use heif::reads_heif;
pub use jpeg::{REDUCTIONS, standard_huffman_tables};
pub use luma::{Luma, mean_squares};
pub use orientation::turned_to_sensor;
pub use perceptual::{PerceptualHash, bits_apart, perceptual_hash};
pub use photo::Photo;
pub use resample::{Filter, resampled};
pub use resize::{boxed, doubled, fitting, grey_resized, opencv_linear, shrunk};
