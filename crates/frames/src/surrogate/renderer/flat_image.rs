//! The image of a view in a flat colour.

use image::RgbImage;

use crate::{Frame, FrameSet, FramesError};

/// Image of a view in a flat colour.
#[derive(Debug, Clone)]
pub struct FlatImage {
    /// 8-bit sRGB of the paint's reflectance.
    pub flat_rgb: [u8; 3],
    pub image: RgbImage,
}

impl FlatImage {
    /// Reads the image of a frame; `None` where its paint is not of one colour.
    pub fn read(set: &FrameSet, frame: &Frame) -> Result<Option<Self>, FramesError> {
        let read = |flat_rgb| set.rgb(frame).map(|image| Self { flat_rgb, image });
        frame.flat_rgb().map(read).transpose()
    }
}
