//! Answers of every way on one photo.

use std::collections::BTreeMap;

use super::held_out::{FoundTags, MethodResult, Sample, answer, find};
use super::method::Method;
use scaleproof_core::message::{Message, message};
use scaleproof_pose::camera::{Camera, FittedCamera};
use scaleproof_pose::locate::{Located, LocatedPhoto, Warning, locate_luma};
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::{SeenTag, TagDetector, TagDetectorChoice};

/// The tag detectors of one thread.
pub(super) type TagDetectors = BTreeMap<TagDetectorChoice, Box<dyn TagDetector>>;

pub(super) struct Measured {
    /// Answers by the ways, in their order.
    pub answers: Vec<MethodResult>,
    /// Pose by the usual way; absent where it finds none.
    pub usual: Option<UsualPose>,
    pub fit: Fit,
}

/// Fit of a photo's tags to scene and camera, by the usual way.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Fit {
    /// True if they disagree: the photo is refused therefore, or fits poorly.
    pub disagrees: bool,
    /// Root mean square residual, px: infinite where it is refused therefore, absent where there is no pose for another reason.
    pub rms_px: Option<f64>,
}

impl Fit {
    fn from_photo(found: &LocatedPhoto) -> Fit {
        let (disagrees, rms_px) = match &found.result {
            Ok(located) => (located.warnings.contains(&Warning::PoorFit), Some(located.rms_px)),
            Err(why) => (why.is_disagreement(), why.is_disagreement().then_some(f64::INFINITY)),
        };
        Fit { disagrees, rms_px }
    }
}

/// Result of the usual way on a photo.
pub(super) struct UsualPose {
    /// Camera, fitted to the photo.
    pub fitted: FittedCamera,
    pub located: Located,
    pub seen: FoundTags,
    /// Tags that the pose rests on: they are left out one by one.
    pub reference: Vec<SeenTag>,
}

/// Measures every way on a photo; a way that several questions share is measured once.
pub(super) fn measure(
    sample: &Sample,
    ways: &[Method],
    opened: &mut TagDetectors,
    scene: &Scene,
    camera: &Camera,
) -> Result<Measured, Message> {
    let (width, height) = sample.luma.dimensions();
    let fitted = camera
        .for_photo(width, height, sample.turned_deg)
        .map_err(|fault| message!("{}: {fault}", sample.file))?;
    let usual_tags = opened.get_mut(&TagDetectorChoice::default());
    let found = usual_tags.map(|tags| locate_luma(&sample.luma, sample.turned_deg, None, scene, camera, tags.as_mut()));
    let fit = found.as_ref().map(Fit::from_photo).unwrap_or_default();
    let usual = found.and_then(|found| usual(sample, found, scene, fitted));
    let reference = usual.as_ref().map_or(&[][..], |usual| &usual.reference);
    let mut seen: BTreeMap<_, FoundTags> = BTreeMap::new();
    let mut answers: Vec<MethodResult> = Vec::new();
    for (i, way) in ways.iter().enumerate() {
        if let Some(same) = ways[..i].iter().position(|before| before.is_same(way)) {
            answers.push(answers[same].clone());
            continue;
        }
        let key = (way.detector, way.reduced_by);
        if !seen.contains_key(&key)
            && let Some(tags) = opened.get_mut(&way.detector)
        {
            seen.insert(
                key,
                find(sample, way.detector, way.reduced_by, scene, camera, tags.as_mut()),
            );
        }
        if let Some(seen) = seen.get(&key) {
            answers.push(answer(way, sample, seen, reference, scene, camera));
        }
    }
    Ok(Measured { answers, usual, fit })
}

fn usual(sample: &Sample, found: LocatedPhoto, scene: &Scene, fitted: FittedCamera) -> Option<UsualPose> {
    let located = found.result.ok()?;
    let is_used =
        |tag: &&SeenTag| tag.is_whole && located.tags.contains(&tag.id) && scene.tag(tag.family, tag.id).is_some();
    let reference = found.seen.iter().filter(is_used).cloned().collect();
    let (tags, ms, size) = (found.seen, 0.0, sample.luma.dimensions());
    Some(UsualPose {
        reference,
        seen: FoundTags { tags, ms, size },
        located,
        fitted,
    })
}
