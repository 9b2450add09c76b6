//! Located photos of the model, and those that make no frames.

use std::fmt::Display;
use std::path::PathBuf;

use nalgebra::{Point3, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bin, TagFamily};

/// White paper of a tag in a photo.
#[derive(Debug, Clone, PartialEq)]
pub struct TagPaper {
    pub family: TagFamily,
    pub id: u32,
    /// 8-bit level of each channel.
    pub level: [f64; 3],
}

/// Located photo of the model in a flat colour.
#[derive(Debug, Clone)]
pub struct FlatPhoto {
    pub file: PathBuf,
    /// 8-bit sRGB of the paint's reflectance.
    pub flat_rgb: [u8; 3],
    pub place: String,
    pub bin: Bin,
    pub camera: Camera,
    /// `T_camera_model`.
    pub pose: Rigid,
    pub papers: Vec<TagPaper>,
}

/// Photo or view that makes no frames, with the reason.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "LeftOut")]
pub struct LeftOutPhoto {
    pub what: String,
    pub reason: String,
}

impl LeftOutPhoto {
    pub fn new(what: String, reason: impl Display) -> Self {
        let reason = reason.to_string();
        Self { what, reason }
    }
}

impl FlatPhoto {
    pub fn name(&self) -> String {
        self.file.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    pub(super) fn centre_mm(&self) -> Point3<f64> {
        self.pose.inverse_transform_point(&Point3::origin())
    }

    /// Returns the vector from a point to the camera, mm, model frame.
    pub(super) fn from(&self, target_mm: Point3<f64>) -> Vector3<f64> {
        self.centre_mm() - target_mm
    }

    /// Returns the name of the view that it belongs to, for people.
    pub(super) fn view_name(&self) -> String {
        let b = &self.bin;
        format!(
            "the view at {}, {}°/{}°/{} mm",
            self.place, b.azimuth_deg, b.pitch_deg, b.distance_mm
        )
    }
}
