//! OpenCV's ArUco detector.

use image::GrayImage;
use opencv::core::Mat;

use super::markers::{MarkerSearch, SeenMarker};
use crate::scene::TagFamily;
use crate::tags::search::{Found, Search};
use crate::tags::{CornersBy, StartError, TagDetectorChoice};

pub(super) struct ArucoOpenCv(Vec<(TagFamily, MarkerSearch)>);

impl ArucoOpenCv {
    pub(super) fn new(families: &[TagFamily], by: CornersBy) -> Result<ArucoOpenCv, StartError> {
        let choice = TagDetectorChoice::Aruco(by);
        let start = |family| MarkerSearch::new(dictionary(family), 1, by).map_err(|e| e.message);
        Ok(ArucoOpenCv(choice.for_each_family(families, start)?))
    }
}

impl Search for ArucoOpenCv {
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found> {
        let mut found = Vec::new();
        for (family, search) in &self.0 {
            // If OpenCV throws an exception, nothing is found.
            let seen = find(grey, search).unwrap_or_default();
            found.extend(seen.into_iter().filter_map(|marker| {
                // OpenCV's image of an AprilTag is the tag turned by 180°, so its first corner is our third.
                let [a, b, c, d] = marker.corners_px;
                Some(Found {
                    family: *family,
                    id: u32::try_from(marker.id).ok()?,
                    corners_px: [c, d, a, b],
                })
            }));
        }
        found
    }
}

/// Returns OpenCV's number of a family's dictionary; it has none of the Standard families, which [`TagDetectorChoice::reads`] excludes.
fn dictionary(family: TagFamily) -> i32 {
    match family {
        TagFamily::Tag16h5 => 17,
        TagFamily::Tag25h9 => 18,
        _ => 20,
    }
}

fn find(grey: &GrayImage, search: &MarkerSearch) -> opencv::Result<Vec<SeenMarker>> {
    let (Ok(rows), Ok(columns)) = (i32::try_from(grey.height()), i32::try_from(grey.width())) else {
        return Ok(Vec::new());
    };
    search.find(&Mat::new_rows_cols_with_data(rows, columns, grey.as_raw().as_slice())?)
}
