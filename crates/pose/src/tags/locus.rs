//! The detector of crate `locus-core`.

use image::GrayImage;
use locus_core::config::{CornerRefinementMode, ThresholdMode};
use locus_core::{DetectorBuilder, DetectorConfig, ImageView, TagFamily as LocusFamily};

use super::search::{Found, Search};
use super::{CornersBy, SeenTag, StartError, TagDetector, TagDetectorChoice};
use crate::scene::TagFamily;
use scaleproof_photo::photo::Luma;

/// locus-core with its standard settings, at full size.
pub struct Locus {
    /// Its detections do not say which family they belong to, so each family gets a detector.
    detectors: Vec<(TagFamily, locus_core::Detector)>,
}

impl Locus {
    /// For a result's provenance.
    pub const VERSION: &str = "0.10";

    /// A detector for some families.
    pub fn new(families: &[TagFamily]) -> Result<Locus, StartError> {
        Self::with(families, DetectorConfig::default())
    }

    /// Without its own refined corners, where others are fitted anyway: a third less time.
    pub fn unrefined(families: &[TagFamily]) -> Result<Locus, StartError> {
        let config = DetectorConfig {
            refinement_mode: CornerRefinementMode::None,
            decoder_corner_subpix: false,
            ..DetectorConfig::default()
        };
        Self::with(families, config)
    }

    /// Thresholds by the mean of a neighbourhood, which noise and blur spoil less than the mean of its extremes, and one more wrong bit.
    pub fn for_noise(families: &[TagFamily]) -> Result<Locus, StartError> {
        let config = DetectorConfig {
            threshold_mode: ThresholdMode::LocalMean,
            decoder_min_contrast: 10.0,
            max_hamming_error: Some(3),
            ..DetectorConfig::default()
        };
        Self::with(families, config)
    }

    fn with(families: &[TagFamily], config: DetectorConfig) -> Result<Locus, StartError> {
        TagDetectorChoice::Locus(CornersBy::Fit).check_families(families)?;
        let start = |family: LocusFamily| {
            // Photos are spread over threads instead.
            let builder = DetectorBuilder::new().with_config(config).with_threads(1);
            let detector = builder.with_family(family).validated_build();
            detector.map_err(|e| TagDetectorChoice::Locus(CornersBy::Fit).failed(e))
        };
        let known = families
            .iter()
            .filter_map(|family| Some((*family, locus_family(*family)?)));
        let detectors = known.map(|(family, of_locus)| Ok((family, start(of_locus)?)));
        Ok(Locus {
            detectors: detectors.collect::<Result<_, _>>()?,
        })
    }
}

/// With the library's own corners.
impl TagDetector for Locus {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        let grey = luma.whole();
        self.search(grey).iter().map(|found| found.seen(grey)).collect()
    }
}

impl Search for Locus {
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found> {
        let (width, height) = (grey.width() as usize, grey.height() as usize);
        let Ok(view) = ImageView::new(grey.as_raw(), width, height, width) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for (family, detector) in &mut self.detectors {
            let Ok(batch) = detector.detect(&view, None, None, false) else {
                continue;
            };
            let tags = batch.reassemble_owned();
            found.extend(tags.iter().map(|d| Found {
                family: *family,
                id: d.id,
                corners_px: corners(d),
            }));
        }
        found
    }
}

fn locus_family(family: TagFamily) -> Option<LocusFamily> {
    match family {
        TagFamily::Tag16h5 => Some(LocusFamily::AprilTag16h5),
        TagFamily::Tag36h11 => Some(LocusFamily::AprilTag36h11),
        TagFamily::Tag25h9 | TagFamily::TagStandard41h12 | TagFamily::TagStandard52h13 => None,
    }
}

/// locus-core counts pixels from the corner of the first pixel, and its tags are OpenCV's: turned by 180°.
fn corners(d: &locus_core::Detection) -> [[f64; 2]; 4] {
    let [c0, c1, c2, c3] = d.corners.map(|[x, y]| [x - 0.5, y - 0.5]);
    [c2, c3, c0, c1]
}
