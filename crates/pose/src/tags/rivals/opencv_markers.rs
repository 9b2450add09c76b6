//! OpenCV's ArUco: its dictionaries, and its search for their markers. The one file that depends on where OpenCV keeps them.
//!
//! Up to 4.6 that is the contrib module `aruco`; from 4.7 on it is `objdetect`, whose detector is an object. `build.rs` asks the installed
//! version. OpenCV 5 turns its images of AprilTags, and so their corner order, which nothing here allows for: `build.rs` refuses it.

#[cfg(not(opencv_aruco_in_objdetect))]
use opencv::aruco::{DetectorParameters, Dictionary, detect_markers, get_predefined_dictionary_i32};
use opencv::core::{Point2f, ToInputArray, Vector};
#[cfg(not(opencv_aruco_in_objdetect))]
use opencv::core::{Ptr, no_array};
#[cfg(opencv_aruco_in_objdetect)]
use opencv::objdetect::{
    ArucoDetector, DetectorParameters, Dictionary, RefineParameters, get_predefined_dictionary_i32,
};
use opencv::prelude::*;

use crate::tags::{ArucoRefiner, Modules};

/// One square marker: OpenCV's id, and its corners in px, clockwise from OpenCV's first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenMarker {
    pub id: i32,
    pub corners_px: [[f64; 2]; 4],
}

/// A search for the markers of one dictionary.
pub struct MarkerSearch {
    #[cfg(not(opencv_aruco_in_objdetect))]
    dictionary: Ptr<Dictionary>,
    #[cfg(not(opencv_aruco_in_objdetect))]
    parameters: Ptr<DetectorParameters>,
    #[cfg(opencv_aruco_in_objdetect)]
    detector: ArucoDetector,
}

impl MarkerSearch {
    /// For OpenCV's dictionary of this number, whose markers have black borders of so many modules.
    ///
    /// # Errors
    /// An exception of OpenCV, as for a number that it does not have.
    pub fn new(dictionary: i32, border_modules: i32, refiner: ArucoRefiner) -> opencv::Result<Self> {
        let dictionary = get_predefined_dictionary_i32(dictionary)?;
        let mut parameters = DetectorParameters::default()?;
        parameters.set_marker_border_bits(border_modules);
        parameters.set_corner_refinement_method(match refiner {
            // The numbers of OpenCV's `CornerRefineMethod`, the same in both modules.
            ArucoRefiner::None => 0,
            ArucoRefiner::Subpix => 1,
            ArucoRefiner::Contour => 2,
            ArucoRefiner::AprilTag => 3,
        });
        #[cfg(not(opencv_aruco_in_objdetect))]
        return Ok(Self {
            dictionary,
            parameters: Ptr::new(parameters),
        });
        #[cfg(opencv_aruco_in_objdetect)]
        return Ok(Self {
            detector: ArucoDetector::new(&dictionary, &parameters, RefineParameters::new_def()?)?,
        });
    }

    /// Every marker in a grey image.
    ///
    /// # Errors
    /// An exception of OpenCV.
    pub fn find(&self, image: &impl ToInputArray) -> opencv::Result<Vec<SeenMarker>> {
        let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
        #[cfg(not(opencv_aruco_in_objdetect))]
        detect_markers(
            image,
            &self.dictionary,
            &mut corners,
            &mut ids,
            &self.parameters,
            &mut no_array(),
        )?;
        #[cfg(opencv_aruco_in_objdetect)]
        self.detector.detect_markers_def(image, &mut corners, &mut ids)?;
        let seen = ids.iter().zip(corners.iter()).filter_map(|(id, corners)| {
            let points: Vec<[f64; 2]> = corners.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect();
            Some(SeenMarker {
                id,
                corners_px: points.try_into().ok()?,
            })
        });
        Ok(seen.collect())
    }
}

/// All markers of OpenCV's dictionary of a number, each inside its one-module black border.
///
/// # Errors
/// An exception of OpenCV, as for a number that it does not have.
pub(super) fn markers(number: i32) -> opencv::Result<Vec<Modules>> {
    let dictionary = get_predefined_dictionary_i32(number)?;
    let (list, size) = (dictionary.bytes_list(), dictionary.marker_size());
    (0..list.rows())
        .map(|id| {
            let bits = Dictionary::get_bits_from_byte_list(&list.row(id)?, size)?;
            let rows: Vec<Vec<u8>> = (0..size)
                .map(|row| Ok(bits.at_row::<u8>(row)?.to_vec()))
                .collect::<opencv::Result<_>>()?;
            Ok(Modules::new(rows.len(), |row, column| rows[row][column] == 0).framed(1, true))
        })
        .collect()
}
