//! AprilTags: families, and the poses of the printed tags.

use nalgebra::{Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use scaleproof_core::geometry::{Rigid, rigid};

/// The AprilTag families a scene may use, by their usual names.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum TagFamily {
    /// 30 tags of 4 × 4 bits.
    Tag16h5,
    /// 35 tags of 5 × 5 bits.
    Tag25h9,
    /// 587 tags of 6 × 6 bits.
    #[default]
    Tag36h11,
    /// 2115 tags with bits around their border, too.
    TagStandard41h12,
    /// 48714 tags with bits around their border, too.
    TagStandard52h13,
    /// 38 tags within a circle, with bits around their border, too.
    TagCircle21h7,
    /// 65535 tags within a circle, with bits around their border, too.
    TagCircle49h12,
    /// 42211 tags with room for a tag of their own inside, and bits around their border, too.
    TagCustom48h12,
}

impl TagFamily {
    /// Every family, with the name `scene.toml` uses.
    pub const ALL: [(TagFamily, &str); 8] = [
        (TagFamily::Tag16h5, "tag16h5"),
        (TagFamily::Tag25h9, "tag25h9"),
        (TagFamily::Tag36h11, "tag36h11"),
        (TagFamily::TagStandard41h12, "tagstandard41h12"),
        (TagFamily::TagStandard52h13, "tagstandard52h13"),
        (TagFamily::TagCircle21h7, "tagcircle21h7"),
        (TagFamily::TagCircle49h12, "tagcircle49h12"),
        (TagFamily::TagCustom48h12, "tagcustom48h12"),
    ];

    /// Returns the name that `scene.toml` uses.
    pub fn name(self) -> &'static str {
        TagFamily::ALL[self as usize].1
    }

    /// Returns the number of different tags of the family; ids run from 0 to one below it.
    pub fn count(self) -> u32 {
        self.measures().0
    }

    /// Returns the width of the outline that the corners lie on, in bit cells (`width_at_border` of the C library).
    pub fn cells_across(self) -> f64 {
        self.measures().1
    }

    /// Returns the width of a tag with the white ring it needs, for a `size_mm` of 1.
    pub fn width_with_white(self) -> f64 {
        self.measures().2 / self.cells_across()
    }

    /// Returns the number of tags, and the widths of a tag's outline and of its white ring, in bit cells.
    fn measures(self) -> (u32, f64, f64) {
        match self {
            TagFamily::Tag16h5 => (30, 6.0, 8.0),
            TagFamily::Tag25h9 => (35, 7.0, 9.0),
            TagFamily::Tag36h11 => (587, 8.0, 10.0),
            TagFamily::TagStandard41h12 => (2115, 5.0, 11.0),
            TagFamily::TagStandard52h13 => (48714, 6.0, 12.0),
            TagFamily::TagCircle21h7 => (38, 5.0, 11.0),
            TagFamily::TagCircle49h12 => (65535, 5.0, 13.0),
            TagFamily::TagCustom48h12 => (42211, 6.0, 12.0),
        }
    }
}

/// Printed tag. Tag frame, the tag seen upright: x right, y up, z out of the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Tag {
    /// Number of the tag in its family.
    pub id: u32,
    /// Family of the tag.
    pub family: TagFamily,
    /// Outer edge of the black border, mm.
    pub size_mm: f64,
    /// Centre of the tag, model frame, mm.
    pub centre_mm: Point3<f64>,
    /// Unit vector to the tag's right, model frame.
    pub right: Vector3<f64>,
    /// Unit vector to the tag's top, model frame.
    pub up: Vector3<f64>,
    /// Uncertainty of the pose, if it was surveyed.
    pub sigma: Option<TagSigma>,
}

/// Uncertainty of a surveyed tag's pose, each in its worst direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TagSigma {
    /// Standard deviation of the centre, mm.
    pub mm: f64,
    /// Standard deviation of the directions, degrees.
    pub deg: f64,
}

impl Tag {
    /// Returns `T_model_tag`: maps tag coordinates to model coordinates, mm.
    pub fn pose(&self) -> Rigid {
        let axes = Matrix3::from_columns(&[self.right, self.up, self.normal()]);
        rigid::from_matrix(axes, self.centre_mm.coords)
    }

    /// Returns the unit vector out of the paper, model frame.
    pub fn normal(&self) -> Vector3<f64> {
        self.right.cross(&self.up)
    }

    /// Returns the corners in the model frame, mm, in the order of [`corners_in_tag_mm`].
    pub fn corners_mm(&self) -> [Point3<f64>; 4] {
        corners_in_tag_mm(self.size_mm).map(|p| self.centre_mm + self.right * p.x + self.up * p.y)
    }

    /// Returns the corners' pixels in a camera at the pose `T_camera_model`; `None` if one has no pixel.
    pub fn corners_px(&self, pose: &Rigid, camera: &Camera) -> Option<[[f64; 2]; 4]> {
        let [a, b, c, d] = self.corners_mm().map(|corner| camera.project(&(pose * corner)));
        Some([a?, b?, c?, d?])
    }
}

/// Returns the corners of a tag in its own frame, mm: top-left, top-right, bottom-right, bottom-left of the upright tag.
pub fn corners_in_tag_mm(size_mm: f64) -> [Point3<f64>; 4] {
    let h = size_mm / 2.0;
    [[-h, h], [h, h], [h, -h], [-h, -h]].map(|[x, y]| Point3::new(x, y, 0.0))
}
