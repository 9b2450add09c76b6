//! The detector of crate `locus-core`.

use image::GrayImage;
use locus_core::config::{CornerRefinementMode, ThresholdMode};
use locus_core::{Detector, DetectorBuilder, DetectorConfig, ImageView};

use crate::scene::TagFamily;
use crate::tags::search::{Found, Search};
use crate::tags::{StartError, TagDetectorChoice};

/// locus-core at full size. Its detections do not say which family they belong to, so each family gets a detector.
pub(super) struct Locus(Vec<(TagFamily, Detector)>);

impl Locus {
    /// Version of locus-core, for a result's provenance.
    pub(super) const VERSION: &str = "0.10";

    /// Creates a detector for some families, with standard settings.
    pub(super) fn new(families: &[TagFamily]) -> Result<Locus, StartError> {
        Self::with(families, DetectorConfig::default())
    }

    /// Creates a detector without its own corner refinement, for corners that are fitted anyway: a third less time.
    pub(super) fn unrefined(families: &[TagFamily]) -> Result<Locus, StartError> {
        let config = DetectorConfig {
            refinement_mode: CornerRefinementMode::None,
            decoder_corner_subpix: false,
            ..DetectorConfig::default()
        };
        Self::with(families, config)
    }

    /// Creates a detector with thresholds by the mean of a neighbourhood, which noise and blur affect less than the mean of its extremes, and with
    /// one more wrong bit.
    pub(super) fn for_noise(families: &[TagFamily]) -> Result<Locus, StartError> {
        let config = DetectorConfig {
            threshold_mode: ThresholdMode::LocalMean,
            decoder_min_contrast: 10.0,
            max_hamming_error: Some(3),
            ..DetectorConfig::default()
        };
        Self::with(families, config)
    }

    fn with(families: &[TagFamily], config: DetectorConfig) -> Result<Locus, StartError> {
        let start = |family| {
            // `reads` allows only 16h5 and 36h11.
            let family = match family {
                TagFamily::Tag16h5 => locus_core::TagFamily::AprilTag16h5,
                _ => locus_core::TagFamily::AprilTag36h11,
            };
            // Photos are distributed over threads instead.
            let builder = DetectorBuilder::new().with_config(config).with_threads(1);
            builder.with_family(family).validated_build()
        };
        let choice = TagDetectorChoice::Locus;
        Ok(Locus(choice.for_each_family(families, start)?))
    }
}

impl Search for Locus {
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found> {
        let (width, height) = (grey.width() as usize, grey.height() as usize);
        let Ok(view) = ImageView::new(grey.as_raw(), width, height, width) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for (family, detector) in &mut self.0 {
            let Ok(batch) = detector.detect(&view, None, None, false) else {
                continue;
            };
            found.extend(batch.reassemble_owned().iter().map(|d| {
                // locus-core counts pixels from the corner of the first pixel, and its tags are OpenCV's: turned by 180°.
                let [c0, c1, c2, c3] = d.corners.map(|[x, y]| [x - 0.5, y - 0.5]);
                Found {
                    family: *family,
                    id: d.id,
                    corners_px: [c2, c3, c0, c1],
                }
            }));
        }
        found
    }
}
