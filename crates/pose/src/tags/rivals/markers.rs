//! OpenCV's ArUco: its dictionaries, queried so that no table of codes is kept twice, and its marker detector. The only file that depends on OpenCV's
//! module layout.
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

use crate::tags::{CornersBy, Modules};

/// Square marker: OpenCV's id, and its corners in px, clockwise from OpenCV's first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenMarker {
    pub id: i32,
    pub corners_px: [[f64; 2]; 4],
}

pub struct MarkerSearch {
    #[cfg(not(opencv_aruco_in_objdetect))]
    detector: (Ptr<Dictionary>, Ptr<DetectorParameters>),
    #[cfg(opencv_aruco_in_objdetect)]
    detector: ArucoDetector,
}

impl MarkerSearch {
    /// Creates a search for OpenCV's dictionary of this number, whose markers have black borders of `border_modules` modules. Corners are those of
    /// the outline; as the library's own they are refined by `cornerSubPix`.
    ///
    /// # Errors
    /// An exception of OpenCV, as for a number that it does not have.
    pub fn new(dictionary: i32, border_modules: i32, by: CornersBy) -> opencv::Result<Self> {
        let dictionary = get_predefined_dictionary_i32(dictionary)?;
        let mut parameters = DetectorParameters::default()?;
        parameters.set_marker_border_bits(border_modules);
        // The numbers of OpenCV's `CornerRefineMethod`, the same in both modules.
        parameters.set_corner_refinement_method(match by {
            CornersBy::Fit => 0,
            CornersBy::Library => 1,
        });
        #[cfg(not(opencv_aruco_in_objdetect))]
        let detector = (dictionary, Ptr::new(parameters));
        #[cfg(opencv_aruco_in_objdetect)]
        let detector = ArucoDetector::new(&dictionary, &parameters, RefineParameters::new_def()?)?;
        Ok(Self { detector })
    }

    /// Returns every marker in a grey image.
    ///
    /// # Errors
    /// An exception of OpenCV.
    pub fn find(&self, image: &impl ToInputArray) -> opencv::Result<Vec<SeenMarker>> {
        let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
        #[cfg(not(opencv_aruco_in_objdetect))]
        let (dictionary, parameters) = &self.detector;
        #[cfg(not(opencv_aruco_in_objdetect))]
        detect_markers(image, dictionary, &mut corners, &mut ids, parameters, &mut no_array())?;
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

/// Reason why there are no markers.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DictionaryError {
    #[error("dictionary '{name}' is not known; use one of OpenCV's, as DICT_5X5_100 or DICT_4X4_50")]
    Unknown { name: String },
    #[error("OpenCV could not give the dictionary {name}: {reason}")]
    OpenCv { name: &'static str, reason: String },
}

/// Markers of a dictionary, each inside its one-module black border.
#[derive(Debug, Clone)]
pub struct MarkerDictionary {
    name: &'static str,
    markers: Vec<Modules>,
}

impl MarkerDictionary {
    /// OpenCV's predefined dictionaries, in the order of its numbers for them (`PREDEFINED_DICTIONARY_NAME`).
    pub const NAMES: [&str; 21] = [
        "DICT_4X4_50",
        "DICT_4X4_100",
        "DICT_4X4_250",
        "DICT_4X4_1000",
        "DICT_5X5_50",
        "DICT_5X5_100",
        "DICT_5X5_250",
        "DICT_5X5_1000",
        "DICT_6X6_50",
        "DICT_6X6_100",
        "DICT_6X6_250",
        "DICT_6X6_1000",
        "DICT_7X7_50",
        "DICT_7X7_100",
        "DICT_7X7_250",
        "DICT_7X7_1000",
        "DICT_ARUCO_ORIGINAL",
        "DICT_APRILTAG_16h5",
        "DICT_APRILTAG_25h9",
        "DICT_APRILTAG_36h10",
        "DICT_APRILTAG_36h11",
    ];

    /// Loads a dictionary by OpenCV's name for it.
    pub fn named(name: &str) -> Result<Self, DictionaryError> {
        let (name, number) = known(name)?;
        let markers = || {
            let dictionary = get_predefined_dictionary_i32(number)?;
            let (list, size) = (dictionary.bytes_list(), dictionary.marker_size());
            let marker = |id| {
                let bits = Dictionary::get_bits_from_byte_list(&list.row(id)?, size)?;
                let rows = (0..size).map(|row| Ok(bits.at_row::<u8>(row)?.to_vec()));
                let rows: Vec<Vec<u8>> = rows.collect::<opencv::Result<_>>()?;
                Ok(Modules::new(rows.len(), |row, column| rows[row][column] == 0).framed(1, true))
            };
            (0..list.rows()).map(marker).collect::<opencv::Result<_>>()
        };
        let markers = markers().map_err(|e| failed(name, e))?;
        Ok(Self { name, markers })
    }

    /// Returns OpenCV's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Returns the number of markers; ids run from 0 to one below it.
    pub fn count(&self) -> usize {
        self.markers.len()
    }

    /// Returns one marker with its black border.
    pub fn marker(&self, id: usize) -> Option<&Modules> {
        self.markers.get(id)
    }
}

/// Creates a search for the markers of a dictionary, with black borders of `border_modules` modules; corners are those of the outline, not refined.
pub fn marker_search(dictionary: &str, border_modules: u32) -> Result<MarkerSearch, DictionaryError> {
    let (name, number) = known(dictionary)?;
    let border_modules = i32::try_from(border_modules).unwrap_or(i32::MAX);
    MarkerSearch::new(number, border_modules, CornersBy::Fit).map_err(|e| failed(name, e))
}

fn known(name: &str) -> Result<(&'static str, i32), DictionaryError> {
    let mut all = MarkerDictionary::NAMES.into_iter().zip(0..);
    let known = all.find(|(known, _)| known.eq_ignore_ascii_case(name));
    known.ok_or_else(|| DictionaryError::Unknown { name: name.to_owned() })
}

fn failed(name: &'static str, e: opencv::Error) -> DictionaryError {
    DictionaryError::OpenCv {
        name,
        reason: e.message,
    }
}
