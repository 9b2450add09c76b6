//! Detections in a photo that is corrupted, or defended.

use std::sync::Arc;

use image::RgbImage;

use crate::error::ScoreError;
use crate::figures::{PhotoOutcome, ScoredPhoto, Scores};
use crate::observe::{DecodedPhoto, NotScoredReason, ObserveError, Observer, PhotoPart};
use crate::robustness::corrupt::{LONGEST_PX, cut_off};
use crate::robustness::joined::joined;
use crate::robustness::{Condition, Corruption, Defending};
use scaleproof_core::files::sha256_hex;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{bail, message};
use scaleproof_detect::Detection;
use scaleproof_photo::defence::Frame;
use scaleproof_photo::{Photo, fitting, shrunk};

/// Returns the photo with its detections under each condition, or the reason why there are none.
pub(crate) fn detect_under(
    observer: &mut Observer,
    scores: &Scores,
    photo: &ScoredPhoto,
    conditions: &[Condition],
) -> Result<PhotoUnderConditions, ScoreError> {
    let path = scores.sessions[photo.session].folder.join(&photo.file);
    let file = Photo::open(&path)?;
    if file.sha256 != photo.sha256 {
        bail!(
            "{} is another photo than it was at the beginning of this run: run it again",
            photo.file
        );
    }
    let mut decoded = DecodedPhoto::new(&file);
    let size = fitting([file.width, file.height], LONGEST_PX);
    let mut reduced: Option<RgbImage> = None;
    let mut under = |condition: &Condition| -> Result<_, ScoreError> {
        let views = View::all(photo, condition);
        let mut found: Vec<Vec<Vec<Detection>>> = vec![Vec::new(); scores.detectors.len()];
        for view in &views {
            let mut image = None;
            for (index, found) in found.iter_mut().enumerate() {
                let part = PhotoPart {
                    path: &path,
                    file: &photo.file,
                    sha256: &photo.sha256,
                    window: view.in_photo,
                    name: view.name.as_deref(),
                };
                let seen = observer.in_part(index, &part, &mut || {
                    if image.is_none() {
                        if reduced.is_none() {
                            reduced = Some(shrunk(decoded.at_least(size)?, size));
                        }
                        let reduced = reduced
                            .as_ref()
                            .map(|reduced| view.image(&photo.file, reduced, condition));
                        image = reduced.transpose()?.map(Arc::new);
                    }
                    Ok(image.clone().unwrap_or_default())
                })?;
                match seen {
                    Ok(seen) => found.push(seen),
                    Err(reason) => return Ok(Err(reason)),
                }
            }
        }
        let windows: Vec<BoxPx> = views.iter().map(|view| view.in_photo).collect();
        let detections = found.into_iter().map(|own| joined(own, &windows)).collect();
        let truth = match condition {
            Condition::Worse(..) => windows.iter().fold(photo.truth, |truth, window| common(&truth, window)),
            _ => photo.truth,
        };
        Ok(Ok(judged(scores, photo, truth, detections)))
    };
    conditions.iter().map(&mut under).collect()
}

/// An image that the detectors are run on.
struct View {
    frame: Frame,
    /// Place of the image in the photo at full size, px.
    in_photo: BoxPx,
    /// Name of all that the image depends on besides the photo's content; `None` where it may be another one each time.
    name: Option<String>,
    seed: u64,
}

impl View {
    /// Returns the images of a photo under a condition, most often one.
    fn all(photo: &ScoredPhoto, condition: &Condition) -> Vec<Self> {
        let size = [photo.width, photo.height];
        let reduced = fitting(size, LONGEST_PX);
        let seed = seed(photo, condition);
        let frames = match condition {
            Condition::Worse(Corruption::Crop, severity) => {
                let truth = scaled(&photo.truth, size, reduced);
                let [x1, y1, x2, y2] = cut_off(&truth, reduced, *severity, seed);
                vec![Frame::crop([x1, y1], [x2 - x1, y2 - y1])]
            }
            Condition::Defended(Defending::Published(defence)) => defence.frames(reduced, seed),
            _ => vec![Frame::whole(reduced)],
        };
        let (is_kept, program) = match condition {
            Condition::Defended(Defending::Program(program)) => (program.is_deterministic(), program.card().sha256()),
            _ => (true, String::new()),
        };
        let view = |frame: Frame| Self {
            frame,
            in_photo: scaled(&frame.window(), reduced, size),
            name: is_kept.then(|| format!("{} {frame:?} {seed} {program}", condition.name())),
            seed,
        };
        frames.into_iter().map(view).collect()
    }

    fn image(&self, file: &str, reduced: &RgbImage, condition: &Condition) -> Result<RgbImage, ObserveError> {
        let made = match condition {
            Condition::Reduced => Some(reduced.clone()),
            Condition::Worse(kind, severity) => kind.apply(&self.frame.cut(reduced), *severity, self.seed),
            Condition::Defended(Defending::Published(defence)) => defence.image(reduced, &self.frame),
            Condition::Defended(Defending::Program(program)) => {
                return Ok(program.defended(file, reduced, self.seed as u32)?);
            }
        };
        let not_changed = || message!("{file} cannot be changed by {}: it cannot be encoded", condition.name());
        Ok(made.ok_or_else(not_changed)?)
    }
}

/// Returns the seed of a condition. A corruption's is the same at every severity, and for photos of one place and bin, which are paired. A defence's
/// depends on the photo alone, as a defence does not know what a photo is paired with.
fn seed(photo: &ScoredPhoto, condition: &Condition) -> u64 {
    let alike = match (condition, photo.bin) {
        (Condition::Defended(defence), _) => format!("{} {}", photo.sha256, defence.name()),
        (Condition::Worse(kind, _), Some(bin)) => format!("{bin:?} {:?} {}", photo.place, kind.name()),
        (Condition::Worse(kind, _), None) => format!("{} {}", photo.sha256, kind.name()),
        (Condition::Reduced, _) => String::new(),
    };
    u64::from_str_radix(&sha256_hex(alike.as_bytes())[..16], 16).unwrap_or_default()
}

/// Scales a box from an image of one size, width and height, to the image at another.
fn scaled(b: &BoxPx, from: [u32; 2], to: [u32; 2]) -> BoxPx {
    let [across, down] = [0, 1].map(|i| f64::from(to[i]) / f64::from(from[i]));
    BoxPx::new(across * b.x1, down * b.y1, across * b.x2, down * b.y2)
}

/// Returns the intersection of two boxes.
fn common(a: &BoxPx, b: &BoxPx) -> BoxPx {
    BoxPx::new(a.x1.max(b.x1), a.y1.max(b.y1), a.x2.min(b.x2), a.y2.min(b.y2))
}

/// Judges the detections. Those that count as the model are kept: the others matter for the outcome alone.
fn judged(scores: &Scores, photo: &ScoredPhoto, truth: BoxPx, mut detections: Vec<Vec<Detection>>) -> ScoredPhoto {
    // Padding lies outside the photo.
    let [width, height] = [photo.width, photo.height].map(f64::from);
    detections
        .iter_mut()
        .flatten()
        .for_each(|d| d.box_px = d.box_px.clipped(width, height));
    let least = scores.criteria.thresholds();
    let outcomes = PhotoOutcome::of_each(&scores.detectors, &detections, &truth, least);
    for (found, detector) in detections.iter_mut().zip(&scores.detectors) {
        found.retain(|detection| detector.counts(detection) && detection.box_px.is_solid());
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

/// A photo under each condition, or the reason why it has no detections there.
pub(crate) type PhotoUnderConditions = Vec<Result<ScoredPhoto, NotScoredReason>>;
