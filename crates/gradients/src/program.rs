//! A program as a differentiable detector: it answers with its loss and the derivative by each pixel.

use std::cell::Cell;

use image::RgbImage;

use super::derivative::{LEAST_LOSS, fault};
use super::error::no_image;
use super::strongest::MEETS_IOU;
use super::{Boxes, ImageLoss, Prediction, WhiteBox, WhiteBoxError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::bail;
use scaleproof_detect::{Gradients, Manifest, ProgramDetector, ProgramImage, ProgramPhoto};

pub struct ProgramWhiteBox {
    program: ProgramDetector,
    manifest: Manifest,
    labels: Vec<usize>,
    /// True once its gradient was compared with differences of its loss.
    is_checked: Cell<bool>,
}

impl ProgramWhiteBox {
    /// `labels`: the indices into its labels that count as the model; `differentiates`: it is asked for gradients.
    pub fn open(
        program: ProgramDetector,
        manifest: Manifest,
        labels: Vec<usize>,
        differentiates: bool,
    ) -> Result<ProgramWhiteBox, WhiteBoxError> {
        let name = &manifest.name;
        if differentiates && program.gradients() == Gradients::Nothing {
            bail!("{name} gives no gradients, and this differentiates it: let its hello have \"gradients\": true");
        }
        if !program.takes_pixels() {
            bail!(
                "{name} takes photos as files, and here are images that lie in none: let the input of its hello be \"rgb\""
            );
        }
        Ok(ProgramWhiteBox {
            program,
            manifest,
            labels,
            is_checked: Cell::new(false),
        })
    }

    fn asked(&self, image: &[[f64; 3]], size: [u32; 2], outline: &BoxPx) -> Result<Option<ImageLoss>, WhiteBoxError> {
        let answer = self.program.loss_and_gradient(&ProgramImage {
            pixels: image,
            size,
            model: *outline,
            least_iou: MEETS_IOU,
            labels: &self.labels,
        })?;
        Ok(answer.map(|found| ImageLoss {
            loss: found.loss,
            confidence: -(-found.loss).exp_m1(),
            gradient: found.gradient,
        }))
    }
}

impl WhiteBox for ProgramWhiteBox {
    fn name(&self) -> &str {
        &self.manifest.name
    }

    /// The overlap is 1: its boxes are suppressed already.
    fn nms_iou(&self) -> f64 {
        1.0
    }

    /// It sees images of 8 bits here, as it does where it is scored.
    fn predictions(&self, image: &[[f64; 3]], size_px: [u32; 2]) -> Result<Vec<Prediction>, WhiteBoxError> {
        let [width, height] = size_px;
        let values = image.iter().map(|pixel| pixel.map(|v| (255.0 * v).round() as u8));
        let pixels = RgbImage::from_raw(width, height, values.flatten().collect());
        let pixels = pixels.ok_or_else(|| no_image(image.len(), size_px))?;
        let found = self.program.detect(&ProgramPhoto {
            path: "an image".as_ref(),
            file: "an image",
            size: size_px,
            pixels: Some(&pixels),
        })?;
        let counted = found.into_iter().filter(|d| self.labels.contains(&d.label));
        let predictions = counted.map(|d| Prediction {
            is_reported: true,
            box_px: d.box_px,
            confidence: d.score,
            loss: -(-d.score.min(1.0 - f64::EPSILON)).ln_1p(),
        });
        Ok(predictions.collect())
    }

    /// The first image with a loss is where its gradient is checked.
    fn loss_and_gradient(
        &self,
        image: &[[f64; 3]],
        size_px: [u32; 2],
        outline: &BoxPx,
        boxes: Boxes,
    ) -> Result<Option<ImageLoss>, WhiteBoxError> {
        if boxes != Boxes::Strongest {
            bail!(
                "{} gives the loss of its strongest box alone, and all boxes were asked for", self.manifest.name;
                hint: "leave ‹loss› out"
            );
        }
        let found = self.asked(image, size_px, outline)?;
        let is_first = |found: &&ImageLoss| found.loss >= LEAST_LOSS && !self.is_checked.get();
        if let Some(first) = found.as_ref().filter(is_first) {
            let look = |image: &[[f64; 3]]| self.asked(image, size_px, outline);
            let is_partial = self.program.gradients() == Gradients::Partial;
            if let Some(fault) = fault(image, first, is_partial, look)? {
                bail!("{fault}");
            }
            self.is_checked.set(true);
        }
        Ok(found)
    }
}
