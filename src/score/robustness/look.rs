//! What the detectors find in a photo that is made worse.

use std::sync::Arc;

use image::{RgbImage, imageops};

use super::Condition;
use crate::detect::Detection;
use crate::files::sha256_hex;
use crate::geometry::BoxPx;
use crate::photo::{Photo, shrunk};
use crate::score::corrupt::{Corruption, LONGEST_PX, cut_off};
use crate::score::decoded::DecodedPhoto;
use crate::score::error::ScoreError;
use crate::score::observe::{Observer, PhotoPart};
use crate::score::{PhotoOutcome, ScoredPhoto, Scores};

/// The photo with what is found in it under each condition.
pub(super) fn at(
    observer: &mut Observer,
    scores: &Scores,
    photo: &ScoredPhoto,
    conditions: &[Condition],
) -> Result<Vec<ScoredPhoto>, ScoreError> {
    let path = scores.sessions[photo.session].folder.join(&photo.file);
    let file = Photo::open(&path)?;
    if file.sha256 != photo.sha256 {
        return Err(ScoreError::PhotoChanged {
            file: photo.file.clone(),
        });
    }
    let mut reduced = Reduced {
        decoded: DecodedPhoto::of(&file),
        image: None,
    };
    let seen = conditions.iter().map(|condition| {
        let view = View::of(photo, *condition);
        let mut image = None;
        let mut detections = Vec::new();
        for index in 0..scores.detectors.len() {
            let part = PhotoPart {
                path: &path,
                file: &photo.file,
                sha256: &photo.sha256,
                window: view.window,
                name: &view.name,
            };
            let found = observer.in_part(index, &part, &mut || {
                let made = match image.take() {
                    Some(made) => made,
                    None => Arc::new(view.image(&photo.file, reduced.image()?)?),
                };
                image = Some(Arc::clone(&made));
                Ok(made)
            })?;
            detections.push(found);
        }
        Ok(judged(scores, photo, &view, detections))
    });
    seen.collect()
}

/// A photo at the size at which it is corrupted, once it is asked for.
struct Reduced<'a> {
    decoded: DecodedPhoto<'a>,
    image: Option<RgbImage>,
}

impl Reduced<'_> {
    fn image(&mut self) -> Result<&RgbImage, ScoreError> {
        if self.image.is_none() {
            let (width, height) = (self.decoded.file.width, self.decoded.file.height);
            let share = (f64::from(LONGEST_PX) / f64::from(width.max(height))).min(1.0);
            let size = [width, height].map(|side| (f64::from(side) * share).round().max(1.0) as u32);
            self.image = Some(shrunk(self.decoded.at_least(size)?, size));
        }
        Ok(self.image.get_or_insert_default())
    }
}

/// What a condition makes of a photo.
struct View {
    condition: Condition,
    /// What is left of the photo (x1, y1, x2, y2), px of the photo.
    window: [u32; 4],
    /// What the image depends on besides the photo's content.
    name: String,
    seed: u64,
    size: [u32; 2],
}

impl View {
    fn of(photo: &ScoredPhoto, condition: Condition) -> Self {
        let size = [photo.width, photo.height];
        let name = condition.map_or_else(String::new, |(kind, severity)| format!("{} {severity}", kind.name()));
        let hash = sha256_hex(format!("{} {name}", photo.sha256).as_bytes());
        let seed = u64::from_str_radix(&hash[..16], 16).unwrap_or_default();
        let window = match condition {
            Some((Corruption::Crop, severity)) => cut_off(&photo.truth, size, severity, seed),
            _ => [0, 0, size[0], size[1]],
        };
        Self {
            condition,
            window,
            name: format!("{name} {window:?}"),
            seed,
            size,
        }
    }

    /// Of the reduced photo.
    fn image(&self, file: &str, reduced: &RgbImage) -> Result<RgbImage, ScoreError> {
        let Some((kind, severity)) = self.condition else {
            return Ok(reduced.clone());
        };
        let image = kind
            .apply(reduced, severity, self.seed)
            .ok_or_else(|| ScoreError::NotCorrupted {
                file: file.to_owned(),
                corruption: kind.name(),
            })?;
        Ok(self.cut(image))
    }

    fn cut(&self, image: RgbImage) -> RgbImage {
        let [width, height] = self.size;
        if self.window == [0, 0, width, height] {
            return image;
        }
        let reduced = |px: u32, side: u32, own: u32| (f64::from(px) * f64::from(own) / f64::from(side)).round() as u32;
        let [x1, y1, x2, y2] = self.window;
        let [x1, x2] = [x1, x2].map(|x| reduced(x, width, image.width()));
        let [y1, y2] = [y1, y2].map(|y| reduced(y, height, image.height()));
        imageops::crop_imm(&image, x1, y1, (x2 - x1).max(1), (y2 - y1).max(1)).to_image()
    }
}

fn judged(scores: &Scores, photo: &ScoredPhoto, view: &View, detections: Vec<Vec<Detection>>) -> ScoredPhoto {
    let [x1, y1, x2, y2] = view.window.map(f64::from);
    let truth = BoxPx {
        x1: photo.truth.x1.max(x1),
        y1: photo.truth.y1.max(y1),
        x2: photo.truth.x2.min(x2),
        y2: photo.truth.y2.min(y2),
    };
    let least = scores.criteria.thresholds();
    let judged = scores.detectors.iter().zip(&detections);
    ScoredPhoto {
        outcomes: judged
            .map(|(detector, found)| PhotoOutcome::of(found, &truth, &detector.counted, least))
            .collect(),
        truth,
        detections,
        tag_marks: Vec::new(),
        preview_jpeg: Vec::new(),
        ..photo.clone()
    }
}
