//! Programs that change an image before the detectors look at it: pixels in, as many pixels out.

use std::time::Duration;

use image::RgbImage;

use super::answer;
use super::detector::ProgramDetector;
use super::error::ProgramError;
use super::hello::Hello;
use super::spec::ProgramSpec;
use crate::ForeignCard;

/// A program that changes images, and as many of it as may run side by side.
#[derive(Debug)]
pub struct ProgramDefence(ProgramDetector);

impl ProgramDefence {
    /// Starts a program and hears what it is. It gets `limit` for each thing that it says.
    pub fn open(spec: ProgramSpec, limit: Duration) -> Result<Self, ProgramError> {
        ProgramDetector::open_as(Hello::parse_of_defence, spec, limit).map(Self)
    }

    pub fn card(&self) -> &ForeignCard {
        self.0.card()
    }

    pub fn is_deterministic(&self) -> bool {
        self.0.is_deterministic()
    }

    /// Returns the image as the program changes it, of the same size. `file` is what messages call it; whatever is random is to follow from `seed`.
    pub fn defended(&self, file: &str, image: &RgbImage, seed: u32) -> Result<RgbImage, ProgramError> {
        let (id, (width, height)) = (self.0.next_id(), image.dimensions());
        let count = image.as_raw().len();
        let line = serde_json::json!({
            "id": id, "task": "defend", "width": width, "height": height, "bytes": count, "seed": seed,
        });
        let message = [line.to_string().as_bytes(), b"\n", image.as_raw()].concat();
        self.0.ask(file, message, |line, child| {
            if let Err(why) = answer::image(line, id, [width, height]) {
                return Ok(Err(why));
            }
            let pixels = child.read(Some(count), self.0.limit)?;
            Ok(RgbImage::from_raw(width, height, pixels).ok_or_else(|| "its image has too few bytes".into()))
        })
    }
}
