//! Rows of an annotation file, before they are checked against the photos.

use crate::list::PhotoEntry;
use scaleproof_pose::scene::Viewpoint;

/// Photos of an annotation file, in its order, and the names of those without a box of the class.
pub type ImportedRows = (Vec<ImportedPhoto>, Vec<String>);

#[derive(Debug, Clone, PartialEq)]
pub struct ImportedPhoto {
    /// Place in the file: `line 3`, or `image 17`.
    pub place: String,
    /// Entry of the photo; its variant is empty if the file names none.
    pub entry: PhotoEntry,
    /// Width and height in px, if the file states them.
    pub size: Option<[u32; 2]>,
}

/// Fault, with its place in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportFault {
    /// Place in the file; `None` if the fault concerns the whole file.
    pub place: Option<String>,
    pub message: String,
}

impl ImportFault {
    pub(super) fn of_file(message: impl Into<String>) -> Self {
        Self {
            place: None,
            message: message.into(),
        }
    }

    pub(super) fn at(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            place: Some(place.into()),
            message: message.into(),
        }
    }
}

/// Converts the three numbers of a viewpoint: all or none.
pub(super) fn viewpoint(numbers: [Option<f64>; 3]) -> Result<Option<Viewpoint>, String> {
    match numbers {
        [None, None, None] => Ok(None),
        [Some(azimuth_deg), Some(pitch_deg), Some(distance_mm)] => Ok(Some(Viewpoint {
            // Some programs count from −180° to 180°.
            azimuth_deg: if (-180.0..0.0).contains(&azimuth_deg) || azimuth_deg == 360.0 {
                azimuth_deg.rem_euclid(360.0)
            } else {
                azimuth_deg
            },
            pitch_deg,
            distance_mm,
        })),
        _ => Err("azimuth_deg, pitch_deg and distance_mm go together: give all or none".into()),
    }
}
