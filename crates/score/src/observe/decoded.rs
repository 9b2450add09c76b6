//! Colours of a photo, decoded at the sizes that detectors need.

use std::sync::Arc;

use image::RgbImage;

use scaleproof_core::workers::stopwatch::{Stage, timed};
use scaleproof_photo::{Photo, PhotoError};

/// The colours of a photo at the sizes that were requested.
pub(crate) struct DecodedPhoto<'a> {
    pub file: &'a Photo,
    /// Images, each with the factor by which it is reduced.
    images: Vec<(u32, Arc<RgbImage>)>,
}

impl DecodedPhoto<'_> {
    pub(crate) fn new(file: &Photo) -> DecodedPhoto<'_> {
        DecodedPhoto {
            file,
            images: Vec::new(),
        }
    }

    /// Returns the photo at a size as OpenCV's linear resizing has it, where that takes less than the whole photo's colours.
    pub(crate) fn opencv_linear(&self, size: [u32; 2]) -> Result<Option<RgbImage>, PhotoError> {
        timed(Stage::Colour, || self.file.rgb_opencv_linear(size))
    }

    /// Returns the photo, reduced as far as `least` (width, height) allows. Nothing else decides, so that every detector sees the same image
    /// whichever others take part.
    pub(crate) fn at_least(&mut self, least: [u32; 2]) -> Result<&Arc<RgbImage>, PhotoError> {
        let reduction = self.file.reduction(least);
        let at = match self.images.iter().position(|(r, _)| *r == reduction) {
            Some(at) => at,
            None => {
                let image = timed(Stage::Colour, || self.file.rgb(reduction))?;
                self.images.push((reduction, Arc::new(image)));
                self.images.len() - 1
            }
        };
        Ok(&self.images[at].1)
    }
}
