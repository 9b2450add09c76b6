//! `frames.json`: the camera, the frames and their files.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::FramesError;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::geometry::rigid::{self, Rigid};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_surface::mesh::Mesh;

/// The value of `format`.
pub const FORMAT: &str = "scaleproof frames 1";
/// The name of the list in a folder of frames.
pub const LIST: &str = "frames.json";

/// The content of `frames.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameList {
    pub format: String,
    pub made_by: String,
    /// Width, height.
    pub size_px: [u32; 2],
    pub camera: Pinhole,
    pub target_mm: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub linear_max: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<Positions>,
    pub frames: Vec<Frame>,
}

/// A camera without distortion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pinhole {
    pub focal_length_px: f64,
    pub centre_px: [f64; 2],
}

/// Meaning of the values of `positions` images.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Positions {
    pub low_mm: [f64; 3],
    pub high_mm: [f64; 3],
    /// A pixel of the frame is this many pixels wide and high there.
    pub factor: u32,
}

/// An image and the truth about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    pub name: String,
    pub rgb: String,
    pub object_mask: String,
    pub paint_mask: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub linear: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sides: Option<String>,
    #[serde(rename = "T_camera_model")]
    pub t_camera_model: [[f64; 4]; 4],
    pub paint: FramePaint,
    pub light: String,
    pub place: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box_xyxy_px: Option<BoxPx>,
}

/// Paint on the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FramePaint {
    /// One 8-bit sRGB colour everywhere.
    FlatRgb([u8; 3]),
    /// A world-aligned pattern: a PNG file with one pixel per cell, below the folder of the frames, and the width of one repeat on the model.
    Pattern { file: String, tile_mm: f64 },
    /// An image on texture coordinates: a PNG file below the folder of the frames.
    Texture { file: String },
    /// The paint that the maker of the frames had on it, which is not known here.
    Original,
}

impl FrameList {
    /// Creates a list without frames, linear light and positions.
    pub fn new(made_by: &str, size_px: [u32; 2], camera: Pinhole, target_mm: [f64; 3]) -> Self {
        Self {
            format: FORMAT.to_owned(),
            made_by: made_by.to_owned(),
            size_px,
            camera,
            target_mm,
            linear_max: None,
            positions: None,
            frames: Vec::new(),
        }
    }

    /// Encodes the list as a file of the folder, to be written after the images it names.
    pub fn to_file(&self, folder: &Path) -> Result<(PathBuf, Vec<u8>), FramesError> {
        let mut text = serde_json::to_string_pretty(self).map_err(FramesError::encode)?;
        text.push('\n');
        Ok((folder.join(LIST), text.into_bytes()))
    }

    /// Returns the camera of all frames.
    pub fn camera(&self) -> Camera {
        self.camera.camera(self.size_px)
    }

    /// Returns where the camera of a frame stands, as the target sees it.
    pub fn viewpoint(&self, frame: &Frame) -> Viewpoint {
        let centre = frame.pose().inverse().translation.vector;
        Viewpoint::from_camera(Point3::from(centre), Point3::from(self.target_mm))
    }
}

impl Positions {
    /// Creates a range with room for every point of a mesh.
    pub fn around(mesh: &Mesh, factor: u32) -> Self {
        let (low, high) = mesh.bounds_mm();
        // Rounding must not leave it.
        let wider = Vector3::repeat(1.0);
        Self {
            low_mm: (low - wider).coords.into(),
            high_mm: (high + wider).coords.into(),
            factor,
        }
    }
}

impl Pinhole {
    /// Creates a camera with its principal point in the middle of images of this size (width, height; px).
    pub fn with_field_of_view([width, height]: [u32; 2], horizontal_deg: f64) -> Self {
        let half = 0.5 * horizontal_deg.to_radians();
        Self {
            focal_length_px: 0.5 * f64::from(width) / half.tan(),
            centre_px: [width, height].map(|side| 0.5 * (f64::from(side) - 1.0)),
        }
    }

    /// Returns the camera of the same view with each pixel divided into `factor` × `factor`.
    pub fn finer(&self, factor: u32) -> Self {
        let factor = f64::from(factor);
        Self {
            focal_length_px: factor * self.focal_length_px,
            centre_px: self.centre_px.map(|c| factor * (c + 0.5) - 0.5),
        }
    }

    /// Converts to a camera without distortion, for images of this width and height, px.
    pub fn camera(&self, [width, height]: [u32; 2]) -> Camera {
        let (f, [cx, cy]) = (self.focal_length_px, self.centre_px);
        Camera::pinhole(width, height, f, f, cx, cy)
    }
}

impl Frame {
    /// Creates a frame of this name, whose images of the model's shape begin with `shape`, as in `views/az0`; light, place and box are still empty.
    pub fn new(name: &str, shape: &str, pose: &Rigid, paint: FramePaint) -> Self {
        let of_shape = |kind: &str| format!("{shape}_{kind}.png");
        Self {
            name: name.to_owned(),
            rgb: format!("rgb/{name}.png"),
            object_mask: of_shape("object"),
            paint_mask: of_shape("paint"),
            linear: None,
            positions: Some(of_shape("positions")),
            sides: Some(of_shape("sides")),
            t_camera_model: rigid::rows(pose),
            paint,
            light: String::new(),
            place: String::new(),
            box_xyxy_px: None,
        }
    }

    /// Returns `T_camera_model`.
    pub fn pose(&self) -> Rigid {
        let m = &self.t_camera_model;
        rigid::from_matrix(Matrix3::from_fn(|r, c| m[r][c]), Vector3::from_fn(|r, _| m[r][3]))
    }

    /// Lists the files that the frame names, each with its key.
    pub fn files(&self) -> Vec<(&'static str, &str)> {
        let mut all = vec![
            ("rgb", self.rgb.as_str()),
            ("object_mask", &self.object_mask),
            ("paint_mask", &self.paint_mask),
        ];
        let optional = [
            ("linear", &self.linear),
            ("positions", &self.positions),
            ("sides", &self.sides),
        ];
        let optional = optional.into_iter();
        all.extend(optional.filter_map(|(key, file)| Some((key, file.as_deref()?))));
        match &self.paint {
            FramePaint::Pattern { file, .. } => all.push(("pattern", file)),
            FramePaint::Texture { file } => all.push(("texture", file)),
            FramePaint::FlatRgb(_) | FramePaint::Original => {}
        }
        all
    }

    /// Returns the paint's colour where it is flat, 8-bit sRGB.
    pub fn flat_rgb(&self) -> Option<[u8; 3]> {
        match self.paint {
            FramePaint::FlatRgb(rgb) => Some(rgb),
            _ => None,
        }
    }
}

/// Groups frames by their view (pose and place), in the order of the list.
pub fn views(frames: &[Frame]) -> Vec<Vec<&Frame>> {
    let mut views: Vec<Vec<&Frame>> = Vec::new();
    for frame in frames {
        let same = |view: &&mut Vec<&Frame>| {
            let first = view[0];
            first.place == frame.place && first.t_camera_model == frame.t_camera_model
        };
        match views.iter_mut().find(same) {
            Some(view) => view.push(frame),
            None => views.push(vec![frame]),
        }
    }
    views
}
