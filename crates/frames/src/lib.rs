//! Frames: images of a model whose truth is known, in one format on disk, and [`surrogate`] renderers that predict them in any paint.
//!
//! A set of frames is a folder with `frames.json` and the PNG files it names (paths below the folder). All images are of `size_px`.
//!
//! | key of the folder | meaning |
//! |---|---|
//! | `format` | `"scaleproof frames 1"` |
//! | `made_by` | the command that made the frames |
//! | `size_px` | width, height |
//! | `camera` | pinhole: `focal_length_px`, `centre_px` [cx, cy]; pixel (0, 0) is the centre of the top-left pixel |
//! | `target_mm` | the point viewpoints look at, model frame |
//! | `linear_max` | the linear light that 65535 stands for in the `linear` images |
//! | `positions` | `low_mm`, `high_mm`: what 0 and 65535 stand for in the `positions` images; `factor`: how many of their pixels a pixel is wide |
//! | `frames` | the list of frames |
//!
//! | key of a frame | meaning |
//! |---|---|
//! | `name` | unique |
//! | `rgb` | 8-bit sRGB, as a detector gets it: linear light through the sRGB curve, clipped at white, no other tone mapping |
//! | `object_mask` | 8-bit grey: the share of each pixel that the model covers (255 is all) |
//! | `paint_mask` | the same of its paint |
//! | `linear` | optional, 16-bit RGB: the same image in linear light before clipping |
//! | `positions` | optional, 16-bit RGB: x, y, z of the paint, model frame, at the centre of each of `factor`² parts of a pixel |
//! | `sides` | with `positions`, 8-bit grey: 0 no paint, else 1 + the index of the [`Side`] that the paint belongs to |
//! | `T_camera_model` | 4×4, row by row, mm, OpenCV's camera frame |
//! | `paint` | `{"flat_rgb": [r, g, b]}`, `{"pattern": {"file": …, "tile_mm": …}}`, `{"texture": {"file": …}}` or `"original"` |
//! | `light`, `place` | what lights the scene, and where it is; frames of one place are not independent |
//! | `box_xyxy_px` | optional: the box of the whole outline, corner to corner, clipped to the image |
//!
//! **A flat colour** is the paint's diffuse reflectance as 8-bit sRGB: `flat_rgb` [188, 188, 188] reflects half of the light (0.5 in linear
//! light). It is not the colour the paint has in the image. The same holds for a texture's texels and a pattern's cells, which lie on the model as
//! [`world_aligned`](scaleproof_surface::pattern::world_aligned) says.
//!
//! Frames with the same `T_camera_model` may share masks, positions and sides. Those made of photos ([`photos`]) have the camera's
//! tone curve instead of sRGB's, and only paint in the mask that every photo sees.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_frames::{FrameSet, views};
//!
//! let set = FrameSet::open(Path::new("../../captures/skyline_frames"))?;
//! assert!(views(&set.list.frames).len() < set.list.frames.len(), "each view in several paints");
//! # Ok::<(), scaleproof_frames::FramesError>(())
//! ```

pub mod surrogate;

pub mod drawn;
mod images;
pub mod import;
pub use scaleproof_surface::pattern::light;
pub mod photos;
pub mod raster;
mod read;
pub mod render;
pub mod shaded;
pub mod six_views;

pub(crate) use images::reduced;
pub use images::{Coverage, encode_grey, encode_linear, encode_positions, encode_rgb};
pub use read::{outline, syntax};

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use scaleproof_core::files::FileError;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::geometry::rigid::{self, Rigid};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::PatternError;
use scaleproof_surface::pattern::world_aligned::Side;

/// The value of `format`.
pub const FORMAT: &str = "scaleproof frames 1";
/// The name of the list in a folder of frames.
pub const LIST: &str = "frames.json";

/// Why frames could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FramesError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Pattern(#[from] PatternError),
    #[error("{first} and {again} are the same frames: name them once", first = first.display(), again = again.display())]
    Twice { first: PathBuf, again: PathBuf },
    #[error("a frame could not be written ({0})")]
    Encode(String),
}

/// Passes where a condition holds, and fails with an error where it does not.
pub(crate) fn require<E>(holds: bool, error: impl FnOnce() -> E) -> Result<(), E> {
    if holds { Ok(()) } else { Err(error()) }
}

/// Frames of one camera, without their pixels.
#[derive(Debug, Clone)]
pub struct FrameSet {
    /// Where `frames.json` lies.
    pub folder: PathBuf,
    /// What `frames.json` says.
    pub list: FrameList,
    /// SHA-256 of `frames.json` as it was when the set was opened.
    pub sha256: String,
}

/// `frames.json`.
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

/// What the values of the `positions` images mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Positions {
    pub low_mm: [f64; 3],
    pub high_mm: [f64; 3],
    /// A pixel of the frame is this many pixels wide and high there.
    pub factor: u32,
}

/// One image and the truth about it.
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

/// What the model is painted with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FramePaint {
    /// One 8-bit sRGB colour everywhere.
    FlatRgb([u8; 3]),
    /// A world-aligned pattern: a PNG file with one pixel per cell, below the folder of the frames, and the width of one repeat on the model.
    Pattern { file: String, tile_mm: f64 },
    /// An image on texture coordinates: a PNG file below the folder of the frames.
    Texture { file: String },
    /// Whatever the maker of the frames had on it.
    Original,
}

/// The paint at one point of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Model frame; without meaning where there is no paint.
    pub place_mm: [f64; 3],
    /// The side the paint belongs to; `None` where there is no paint.
    pub side: Option<Side>,
}

impl FrameList {
    /// A list without frames, linear light and positions.
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

    /// The list as a file of the folder, to be written after the images it names.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn to_file(&self, folder: &Path) -> Result<(PathBuf, Vec<u8>), FramesError> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| FramesError::Encode(e.to_string()))?;
        text.push('\n');
        Ok((folder.join(LIST), text.into_bytes()))
    }

    /// The camera of all frames.
    pub fn camera(&self) -> Camera {
        self.camera.camera(self.size_px)
    }

    pub fn viewpoint(&self, frame: &Frame) -> Viewpoint {
        let centre = frame.pose().inverse().translation.vector;
        Viewpoint::from_camera(Point3::from(centre), Point3::from(self.target_mm))
    }
}

impl Positions {
    /// Room for every point of a mesh.
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
    /// A pinhole camera with its principal point in the middle of images of this size.
    pub fn with_field_of_view([width, height]: [u32; 2], horizontal_deg: f64) -> Self {
        let half = 0.5 * horizontal_deg.to_radians();
        Self {
            focal_length_px: 0.5 * f64::from(width) / half.tan(),
            centre_px: [width, height].map(|side| 0.5 * (f64::from(side) - 1.0)),
        }
    }

    /// The camera of an image in which a pixel is `factor` pixels wide and high.
    pub fn finer(&self, factor: u32) -> Self {
        let factor = f64::from(factor);
        Self {
            focal_length_px: factor * self.focal_length_px,
            centre_px: self.centre_px.map(|c| factor * (c + 0.5) - 0.5),
        }
    }

    /// The pinhole as a camera without distortion, for images of this width and height, px.
    pub fn camera(&self, [width, height]: [u32; 2]) -> Camera {
        let (f, [cx, cy]) = (self.focal_length_px, self.centre_px);
        Camera::pinhole(width, height, f, f, cx, cy)
    }
}

impl Frame {
    /// A frame of this name, whose images of the model's shape begin with `shape`, as in `views/az0`; its light, place and box are not yet known.
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

    /// `T_camera_model`.
    pub fn pose(&self) -> Rigid {
        let m = &self.t_camera_model;
        rigid::from_matrix(Matrix3::from_fn(|r, c| m[r][c]), Vector3::from_fn(|r, _| m[r][3]))
    }

    /// Every file the frame names, with what it is.
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

    pub fn flat_rgb(&self) -> Option<[u8; 3]> {
        match self.paint {
            FramePaint::FlatRgb(rgb) => Some(rgb),
            _ => None,
        }
    }
}

/// The frames of each view (pose and place), in the order of the list.
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
