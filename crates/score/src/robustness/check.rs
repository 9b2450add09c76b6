//! Check that the photos of a run can be changed.

use crate::error::ScoreError;
use crate::evaluated::{DetectionSource, EvaluatedDetector};
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
        let variant = first.clone();
        return Err(ScoreError::OneVariant { variant, changed });
    }
    let takes_pixels = |detector: &&EvaluatedDetector| match &detector.source {
        DetectionSource::Live(_) | DetectionSource::Called(_) => true,
        DetectionSource::Program(program) => program.takes_pixels(),
        DetectionSource::Recorded(_) | DetectionSource::Outside(_) | DetectionSource::Elsewhere(_) => false,
    };
    let other = detectors.iter().find(|detector| !takes_pixels(detector));
    let refused = |other: &EvaluatedDetector| {
        let detector = other.manifest.name.clone();
        Err(ScoreError::NotCorruptible { detector, changed })
    };
    other.map_or(Ok(()), refused)
}
