//! The crate's own tests; what the program makes of photos is tested by the program's.

use scaleproof_testing as common;

#[path = "photo/budget.rs"]
mod budget;
#[path = "photo/decode.rs"]
mod decode;
#[path = "photo/defence.rs"]
mod defence;
#[path = "photo/draw.rs"]
mod draw;
#[path = "photo/exif_types.rs"]
mod exif_types;
#[path = "photo/jpeg.rs"]
mod jpeg;
#[path = "photo/luma.rs"]
mod luma;
#[path = "photo/perceptual.rs"]
mod perceptual;
#[path = "photo/resample.rs"]
mod resample;
#[path = "photo/sizes.rs"]
mod sizes;
