//! OpenCV's ArUco detector, with each of its corner refiners.

use image::GrayImage;
use opencv::core::Mat;

use super::opencv_markers::{MarkerSearch, SeenMarker};
use super::search::{Found, Search};
use super::{ArucoRefiner, CornersBy, SeenTag, StartError, TagDetector, TagDetectorChoice};
use crate::scene::TagFamily;
use scaleproof_photo::photo::Luma;

/// OpenCV's ArUco detector at full size.
pub struct ArucoOpenCv {
    searches: Vec<(TagFamily, MarkerSearch)>,
    /// Where the refiner has the centre of the first pixel, px.
    pixel_centre: f64,
}

impl ArucoOpenCv {
    /// A detector for some families.
    pub fn new(families: &[TagFamily], refiner: ArucoRefiner) -> Result<ArucoOpenCv, StartError> {
        let choice = TagDetectorChoice::Aruco(refiner, CornersBy::Fit);
        choice.check_families(families)?;
        let known = families
            .iter()
            .filter_map(|family| Some((*family, dictionary(*family)?)));
        let searches = known.map(|(family, number)| Ok((family, MarkerSearch::new(number, 1, refiner)?)));
        Ok(ArucoOpenCv {
            searches: searches
                .collect::<opencv::Result<_>>()
                .map_err(|e| choice.failed(e.message))?,
            // Measured on rendered tags: OpenCV's copy of AprilTag keeps that library's convention.
            pixel_centre: if refiner == ArucoRefiner::AprilTag { 0.5 } else { 0.0 },
        })
    }
}

/// With OpenCV's own corners.
impl TagDetector for ArucoOpenCv {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        let grey = luma.whole();
        self.search(grey).iter().map(|found| found.seen(grey)).collect()
    }
}

impl Search for ArucoOpenCv {
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found> {
        let mut found = Vec::new();
        for (family, search) in &self.searches {
            // An exception of OpenCV is an image it finds nothing in.
            let seen = find(grey, search).unwrap_or_default();
            found.extend(seen.into_iter().filter_map(|marker| {
                Some(Found {
                    family: *family,
                    id: u32::try_from(marker.id).ok()?,
                    corners_px: upright(marker.corners_px).map(|corner| corner.map(|v| v - self.pixel_centre)),
                })
            }));
        }
        found
    }
}

/// OpenCV's number of a family's dictionary.
fn dictionary(family: TagFamily) -> Option<i32> {
    match family {
        TagFamily::Tag16h5 => Some(17),
        TagFamily::Tag25h9 => Some(18),
        TagFamily::Tag36h11 => Some(20),
        TagFamily::TagStandard41h12 | TagFamily::TagStandard52h13 => None,
    }
}

fn find(grey: &GrayImage, search: &MarkerSearch) -> opencv::Result<Vec<SeenMarker>> {
    let (Ok(rows), Ok(columns)) = (i32::try_from(grey.height()), i32::try_from(grey.width())) else {
        return Ok(Vec::new());
    };
    search.find(&Mat::new_rows_cols_with_data(rows, columns, grey.as_raw().as_slice())?)
}

/// OpenCV's image of an AprilTag is the tag turned by 180°, so its first corner is our third.
fn upright([a, b, c, d]: [[f64; 2]; 4]) -> [[f64; 2]; 4] {
    [c, d, a, b]
}
