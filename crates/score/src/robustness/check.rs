//! Check that the photos of a run can be changed.

use crate::error::ScoreError;
use crate::evaluated::{DetectionSource, EvaluatedDetector, not_changeable};
use scaleproof_core::message::bail;
use scaleproof_session::Session;

/// Checks before a run that its drops can be followed on photos that are changed: made worse, or defended.
pub fn check_changeable(
    sessions: &[Session],
    detectors: &[EvaluatedDetector],
    changed: &'static str,
) -> Result<(), ScoreError> {
    let photos = sessions.iter().flat_map(|s| &s.photos);
    let mut variants = photos.map(|photo| &photo.variant);
    if let Some(first) = variants.next()
        && variants.all(|variant| variant == first)
    {
        bail!("all photos have the variant `{first}`: there is no drop to follow on photos that are {changed}");
    }
    let takes_pixels = |detector: &&EvaluatedDetector| match &detector.source {
        DetectionSource::Live(_) | DetectionSource::Called(_) => true,
        DetectionSource::Program(program) => program.takes_pixels(),
        DetectionSource::Recorded(_) | DetectionSource::Outside(_) | DetectionSource::Elsewhere(_) => false,
    };
    let other = detectors.iter().find(|detector| !takes_pixels(detector));
    match other {
        Some(other) => Err(not_changeable(&other.manifest.name, changed).into()),
        None => Ok(()),
    }
}
