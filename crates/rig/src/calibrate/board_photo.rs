//! Photos of the board, and the corners found in them.

use nalgebra::Point3;

use super::fit::View;

/// A corner of the board, or of a tag of the scene, in a photo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenCorner {
    /// Index into [`Definition::corners_mm`](scaleproof_pose::board::Definition::corners_mm); of a scene, four times the tag's place in it and the corner.
    pub id: usize,
    /// Place in the photo; pixel (0, 0) is the centre of the top-left pixel.
    pub px: [f64; 2],
}

/// Least number of photos of a calibration.
pub const LEAST_PHOTOS: usize = 4;

/// A photo in which the board (or tags of the scene) was found. Everything is in the sensor's frame, whichever way the camera was held, so that boards of mixed
/// orientation share one camera, and `Camera::for_photo` turns that camera with each photo.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardPhoto {
    pub file: String,
    /// Width and height in the sensor's frame, px.
    pub size: (u32, u32),
    /// Degrees by which EXIF turns it clockwise to make it upright: 0, 90, 180 or 270.
    pub turned_deg: u32,
    pub corners: Vec<SeenCorner>,
    /// Width of the edges at the corners, px; `None` where it could not be measured.
    pub edge_width_px: Option<f64>,
}

impl BoardPhoto {
    /// Returns the corners and their places on the target, mm.
    pub(super) fn view(&self, places: &[Point3<f64>]) -> View {
        View {
            points_mm: self.corners.iter().map(|c| places[c.id]).collect(),
            seen_px: self.corners.iter().map(|c| c.px).collect(),
        }
    }
}

/// A photo that had no part in the camera, and the reason, as a sentence.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct UnusedPhoto {
    pub file: String,
    pub reason: String,
}
