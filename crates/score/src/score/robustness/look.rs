//! What the detectors find in a photo that is made worse.

use std::sync::Arc;

use image::{RgbImage, imageops};

use super::Condition;
use crate::score::corrupt::{Corruption, LONGEST_PX, cut_off};
use crate::score::decoded::DecodedPhoto;
use crate::score::error::ScoreError;
use crate::score::observe::{Observer, PhotoPart};
use crate::score::{NotScoredReason, PhotoOutcome, ScoredPhoto, Scores};
use scaleproof_core::files::sha256_hex;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;
use scaleproof_photo::photo::{Photo, fitting, shrunk};

/// The photo with what is found in it under each condition, or why a detector says nothing of it.
pub(super) fn at(
    observer: &mut Observer,
    scores: &Scores,
    photo: &ScoredPhoto,
    conditions: &[Condition],
) -> Result<Vec<Result<ScoredPhoto, NotScoredReason>>, ScoreError> {
    let path = scores.sessions[photo.session].folder.join(&photo.file);
    let file = Photo::open(&path)?;
    if file.sha256 != photo.sha256 {
        let file = photo.file.clone();
        return Err(ScoreError::PhotoChanged { file });
    }
    let mut decoded = DecodedPhoto::new(&file);
    let size = fitting([file.width, file.height], LONGEST_PX);
    let mut reduced: Option<RgbImage> = None;
    let seen = conditions.iter().map(|condition| {
        let view = View::new(photo, *condition);
        let mut image = None;
        let mut detections = Vec::new();
        for index in 0..scores.detectors.len() {
            let part = PhotoPart {
                path: &path,
                file: &photo.file,
                sha256: &photo.sha256,
                window: view.in_photo,
                name: &view.name,
            };
            let found = observer.in_part(index, &part, &mut || {
                if image.is_none() {
                    if reduced.is_none() {
                        reduced = Some(shrunk(decoded.at_least(size)?, size));
                    }
                    let reduced = reduced.as_ref().map(|reduced| view.image(&photo.file, reduced));
                    image = reduced.transpose()?.map(Arc::new);
                }
                Ok(image.clone().unwrap_or_default())
            })?;
            match found {
                Ok(found) => detections.push(found),
                Err(reason) => return Ok(Err(reason)),
            }
        }
        Ok(Ok(judged(scores, photo, &view, detections)))
    });
    seen.collect()
}

struct View {
    condition: Condition,
    /// What is left of the reduced photo: x1, y1, x2, y2, px.
    window: [u32; 4],
    /// The window in the photo at full size, px.
    in_photo: BoxPx,
    /// What the image depends on besides the photo's content.
    name: String,
    seed: u64,
}

impl View {
    /// What is random is the same at every severity, and for photos of one place and bin, which are paired.
    fn new(photo: &ScoredPhoto, condition: Condition) -> Self {
        let kind = condition.map_or("", |(kind, _)| kind.name());
        let alike = match photo.bin {
            Some(bin) => format!("{bin:?} {:?} {kind}", photo.place),
            None => format!("{} {kind}", photo.sha256),
        };
        let seed = u64::from_str_radix(&sha256_hex(alike.as_bytes())[..16], 16).unwrap_or_default();
        let size = [photo.width, photo.height];
        let reduced = fitting(size, LONGEST_PX);
        let [across, down] = [0, 1].map(|i| f64::from(reduced[i]) / f64::from(size[i]));
        let truth = BoxPx::new(
            across * photo.truth.x1,
            down * photo.truth.y1,
            across * photo.truth.x2,
            down * photo.truth.y2,
        );
        let window = match condition {
            Some((Corruption::Crop, severity)) => cut_off(&truth, reduced, severity, seed),
            _ => [0, 0, reduced[0], reduced[1]],
        };
        let [x1, y1, x2, y2] = window.map(f64::from);
        let severity = condition.map_or(0, |(_, severity)| severity);
        Self {
            condition,
            window,
            in_photo: BoxPx::new(x1 / across, y1 / down, x2 / across, y2 / down),
            name: format!("{kind} {severity} {window:?} {seed}"),
            seed,
        }
    }

    fn image(&self, file: &str, reduced: &RgbImage) -> Result<RgbImage, ScoreError> {
        let Some((kind, severity)) = self.condition else {
            return Ok(reduced.clone());
        };
        let [x1, y1, x2, y2] = self.window;
        let part = imageops::crop_imm(reduced, x1, y1, x2 - x1, y2 - y1).to_image();
        let made = kind.apply(&part, severity, self.seed);
        made.ok_or_else(|| ScoreError::NotCorrupted {
            file: file.to_owned(),
            corruption: kind.name(),
        })
    }
}

/// Of the detections those that count as the model are kept: the others matter for the outcome alone.
fn judged(scores: &Scores, photo: &ScoredPhoto, view: &View, mut detections: Vec<Vec<Detection>>) -> ScoredPhoto {
    let window = &view.in_photo;
    let truth = BoxPx::new(
        photo.truth.x1.max(window.x1),
        photo.truth.y1.max(window.y1),
        photo.truth.x2.min(window.x2),
        photo.truth.y2.min(window.y2),
    );
    let least = scores.criteria.thresholds();
    let outcomes = PhotoOutcome::of_each(&scores.detectors, &detections, &truth, least);
    for (found, detector) in detections.iter_mut().zip(&scores.detectors) {
        found.retain(|detection| detector.counts(detection));
    }
    ScoredPhoto {
        outcomes,
        truth,
        detections,
        tag_marks: Vec::new(),
        preview_jpeg: Vec::new(),
        ..photo.clone()
    }
}
