//! OpenCV's marker detector: the one file here that depends on where OpenCV keeps ArUco.
//!
//! Up to 4.6 it is the contrib module `aruco`; the detector object of `objdetect` (4.7 and later) takes the same parameters.

use opencv::aruco::{CornerRefineMethod, DetectorParameters, PREDEFINED_DICTIONARY_NAME};
use opencv::core::{Mat, Point2f, Vector};
use opencv::prelude::*;

/// One square marker: OpenCV's id, and its corners in px, clockwise from OpenCV's first.
pub struct SeenMarker {
    pub id: i32,
    pub corners_px: [[f64; 2]; 4],
}

/// OpenCV's number of a dictionary by its name; the names are those of its own enumeration.
pub fn dictionary_number(name: &str) -> Option<i32> {
    (0..32).find(|n| PREDEFINED_DICTIONARY_NAME::try_from(*n).is_ok_and(|known| format!("{known:?}") == name))
}

/// Every marker of a dictionary, whose black border is `border_modules` wide. Corners are as the outline gives them, not refined.
pub fn find(picture: &Mat, dictionary: i32, border_modules: i32) -> opencv::Result<Vec<SeenMarker>> {
    let dictionary = opencv::aruco::get_predefined_dictionary_i32(dictionary)?;
    let mut parameters = DetectorParameters::create()?;
    parameters.set_marker_border_bits(border_modules);
    parameters.set_corner_refinement_method(CornerRefineMethod::CORNER_REFINE_NONE as i32);
    let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
    let mut rejected = Vector::<Vector<Point2f>>::new();
    opencv::aruco::detect_markers(picture, &dictionary, &mut corners, &mut ids, &parameters, &mut rejected)?;
    Ok(ids
        .iter()
        .zip(corners.iter())
        .filter_map(|(id, corners)| {
            let points: Vec<[f64; 2]> = corners.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect();
            let corners_px = points.try_into().ok()?;
            Some(SeenMarker { id, corners_px })
        })
        .collect())
}
