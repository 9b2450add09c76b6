//! The markers of OpenCV's ArUco dictionaries, asked of OpenCV, so that no table of codes is kept twice.

use super::opencv_markers::{MarkerSearch, markers};
use crate::tags::{ArucoRefiner, Modules};

/// OpenCV's predefined dictionaries, in the order of its numbers for them (`PREDEFINED_DICTIONARY_NAME`).
const NAMES: [&str; 21] = [
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

/// Why there are no markers.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DictionaryError {
    #[error("dictionary '{name}' is not known; use one of OpenCV's, as DICT_5X5_100 or DICT_4X4_50")]
    Unknown { name: String },
    #[error("OpenCV could not give the dictionary {name}: {reason}")]
    OpenCv { name: &'static str, reason: String },
}

/// All markers of a dictionary, each inside its one-module black border.
#[derive(Debug, Clone)]
pub struct MarkerDictionary {
    name: &'static str,
    markers: Vec<Modules>,
}

impl MarkerDictionary {
    /// A dictionary by OpenCV's name for it.
    ///
    /// # Errors
    /// A name OpenCV does not have.
    pub fn named(name: &str) -> Result<Self, DictionaryError> {
        let (name, number) = known(name)?;
        let markers = markers(number).map_err(|e| failed(name, e))?;
        Ok(Self { name, markers })
    }

    /// OpenCV's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// How many markers there are; ids run from 0 to one below it.
    pub fn count(&self) -> usize {
        self.markers.len()
    }

    /// One marker with its black border.
    pub fn marker(&self, id: usize) -> Option<&Modules> {
        self.markers.get(id)
    }
}

/// A search for the markers of a dictionary, with black borders of so many modules; corners are as the outline gives them, not refined.
///
/// # Errors
/// A name OpenCV does not have.
pub fn marker_search(dictionary: &str, border_modules: u32) -> Result<MarkerSearch, DictionaryError> {
    let (name, number) = known(dictionary)?;
    let border_modules = i32::try_from(border_modules).unwrap_or(i32::MAX);
    MarkerSearch::new(number, border_modules, ArucoRefiner::None).map_err(|e| failed(name, e))
}

/// OpenCV's name and number.
fn known(name: &str) -> Result<(&'static str, i32), DictionaryError> {
    let mut all = NAMES.into_iter().zip(0..);
    let known = all.find(|(known, _)| known.eq_ignore_ascii_case(name));
    known.ok_or_else(|| DictionaryError::Unknown { name: name.to_owned() })
}

fn failed(name: &'static str, e: opencv::Error) -> DictionaryError {
    DictionaryError::OpenCv {
        name,
        reason: e.message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dictionaries_have_the_markers_their_names_say() {
        for name in NAMES {
            let dictionary = MarkerDictionary::named(name).unwrap();
            let side = dictionary.marker(0).unwrap().side();
            if let Some(sizes) = name.strip_prefix("DICT_").filter(|s| s.contains('X')) {
                let (bits, count) = sizes.split_once('_').unwrap();
                assert_eq!(side, bits[..1].parse::<usize>().unwrap() + 2, "{name}");
                assert_eq!(dictionary.count(), count.parse::<usize>().unwrap(), "{name}");
            }
        }
        let error = MarkerDictionary::named("DICT_9X9").unwrap_err().to_string();
        assert!(error.starts_with("dictionary 'DICT_9X9' is not known"), "{error}");
    }
}
