//! Detectors that are functions of the process that uses this library, such as a function of Python.

use std::fmt::Debug;
use std::sync::Arc;

use image::RgbImage;

use super::program::protocol::checked;
use super::program::untrusted;
use super::{Detection, ForeignCard, ProgramError};
use scaleproof_core::message::message;

pub use super::program::protocol::{FoundBox, FoundLabel};

/// A function that finds objects in images. It is called from several threads at a time, one for each photo that is looked at.
pub trait Callee: Debug + Send + Sync {
    /// The boxes in an upright image, in its pixels; `file` is what messages call it.
    ///
    /// # Errors
    /// Why there is no answer, as the end of a sentence that begins with the detector's name.
    fn find(&self, file: &str, image: &Arc<RgbImage>) -> Result<Vec<FoundBox>, String>;
}

/// A detector that is a function.
#[derive(Debug)]
pub struct CalledDetector {
    card: ForeignCard,
    callee: Box<dyn Callee>,
}

impl CalledDetector {
    /// A detector of this card, whose labels are those that the function gives.
    pub fn new(card: ForeignCard, callee: Box<dyn Callee>) -> CalledDetector {
        CalledDetector { card, callee }
    }

    pub fn card(&self) -> &ForeignCard {
        &self.card
    }

    /// Returns its detections in an upright image, best first; `file` is what messages call it.
    ///
    /// # Errors
    /// The function failed, or its boxes cannot be trusted: no photo is looked at any more.
    pub fn detect(&self, file: &str, image: &Arc<RgbImage>) -> Result<Vec<Detection>, ProgramError> {
        let detector = &self.card.name;
        let found = self
            .callee
            .find(file, image)
            .map_err(|how| message!("{detector} {how}"))?;
        let found = checked(found, image.dimensions().into(), self.card.labels);
        Ok(found.map_err(|fault| untrusted(detector, file, fault))?)
    }
}
