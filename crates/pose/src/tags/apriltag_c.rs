//! The C AprilTag library (crate `apriltag`).

use apriltag::{Detection, Detector, DetectorBuilder, Family, Image};
use image::GrayImage;

use super::search::{Found, Search};
use super::{CornersBy, StartError, TagDetectorChoice};
use crate::scene::TagFamily;

/// Maximum number of corrected bits; with more, noise is decoded as tags.
const MAX_HAMMING: usize = 1;

/// Mean contrast between the bits and their threshold, 0–255; ghost tags in plain texture stay below it.
const MIN_DECISION_MARGIN: f32 = 20.0;

/// C AprilTag at full resolution. Holds C memory, so each thread makes its own.
pub struct AprilTagC {
    /// One detector for each family, since the library does not say which family a tag belongs to.
    detectors: Vec<(TagFamily, Detector)>,
}

impl AprilTagC {
    /// Name and version, for a result's provenance; the build script knows which C library is linked.
    pub const PROVENANCE: &str = concat!(
        "apriltag C ",
        env!("APRILTAG_VERSION"),
        " (",
        env!("APRILTAG_ORIGIN"),
        ", decimate 1)"
    );

    pub fn new(families: &[TagFamily]) -> Result<AprilTagC, StartError> {
        let start = |family| {
            let builder = DetectorBuilder::new().add_family_bits(c_family(family), MAX_HAMMING);
            let mut detector = builder.build()?;
            detector.set_thread_number(1); // photos are spread over threads instead
            detector.set_decimation(1.0);
            detector.set_refine_edges(true);
            Ok::<_, apriltag::Error>(detector)
        };
        let choice = TagDetectorChoice::AprilTagC(CornersBy::Fit);
        let detectors = choice.for_each_family(families, start)?;
        Ok(AprilTagC { detectors })
    }
}

impl Search for AprilTagC {
    /// Finds tags; leaves false detections out.
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found> {
        let Some(image) = c_image(grey) else { return Vec::new() };
        let mut found = Vec::new();
        for (family, detector) in &mut self.detectors {
            let detections = detector.detect(&image);
            let sure = detections
                .iter()
                .filter(|d| d.hamming() <= MAX_HAMMING && d.decision_margin() >= MIN_DECISION_MARGIN);
            found.extend(sure.filter_map(|d| converted(d, *family)));
        }
        found
    }
}

fn c_family(family: TagFamily) -> Family {
    match family {
        TagFamily::Tag16h5 => Family::tag_16h5(),
        TagFamily::Tag25h9 => Family::tag_25h9(),
        TagFamily::Tag36h11 => Family::tag_36h11(),
        TagFamily::TagStandard41h12 => Family::tag_standard_41h12(),
        TagFamily::TagStandard52h13 => Family::tag_standard_52h13(),
        TagFamily::TagCircle21h7 => Family::tag_circle_21h7(),
        TagFamily::TagCircle49h12 => Family::tag_circle_49h12(),
        TagFamily::TagCustom48h12 => Family::tag_custom_48h12(),
    }
}

/// Copies an image to the C library's own type; `None` if it has no memory for it.
fn c_image(grey: &GrayImage) -> Option<Image> {
    let (width, height) = (grey.width() as usize, grey.height() as usize);
    let mut image = Image::zeros_with_alignment(width, height, 96).ok()?;
    let stride = image.stride();
    for (row, line) in grey.rows().enumerate() {
        let to = &mut image.as_slice_mut()[row * stride..][..width];
        to.iter_mut().zip(line).for_each(|(to, from)| *to = from.0[0]);
    }
    Some(image)
}

/// Converts a detection: C AprilTag counts pixels from the *corner* of the first pixel and lists bottom-left, bottom-right, top-right, top-left
/// (measured on the skyline session: leaving either unconverted costs 0.7° and 27 mm).
fn converted(d: &Detection, family: TagFamily) -> Option<Found> {
    let [bottom_left, bottom_right, top_right, top_left] = d.corners().map(|[x, y]| [x - 0.5, y - 0.5]);
    Some(Found {
        family,
        id: u32::try_from(d.id()).ok()?,
        corners_px: [top_left, top_right, bottom_right, bottom_left],
    })
}
