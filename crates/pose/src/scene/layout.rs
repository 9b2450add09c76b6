//! Layout of the table: the model, the tags around it and the bins of viewpoints.

use nalgebra::Point3;

use super::bins::Bins;
use super::model::ScaleModel;
use super::tag::{Tag, TagFamily};
use crate::camera::Camera;
use scaleproof_core::geometry::Rigid;

/// A scene in the model frame: origin on the ground under the model's centre, x to its front, y to its left, z up; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The printed model.
    pub model: ScaleModel,
    /// Division of viewpoints into bins.
    pub bins: Bins,
    /// The tags around the model.
    pub tags: Vec<Tag>,
}

impl Scene {
    /// Returns the tag of a family and id, if the scene has it.
    pub fn tag(&self, family: TagFamily, id: u32) -> Option<&Tag> {
        self.tags.iter().find(|t| t.family == family && t.id == id)
    }

    /// Returns the tag families a detector has to look for, each once.
    pub fn families(&self) -> Vec<TagFamily> {
        let mut families: Vec<_> = self.tags.iter().map(|t| t.family).collect();
        families.sort();
        families.dedup();
        families
    }

    /// Returns the corners of a tag, px, in the image of a camera at the pose `T_camera_model`, or outside the image. `None` unless the cosine of the
    /// angle between the tag's normal and the line of sight exceeds `facing`, and the model, grown by `margin_mm` on each side, hides no corner.
    pub fn visible_px(
        &self,
        tag: &Tag,
        (facing, margin_mm): (f64, f64),
        pose: &Rigid,
        camera: &Camera,
    ) -> Option<[[f64; 2]; 4]> {
        let centre = pose.inverse() * Point3::origin();
        let is_facing = tag.normal().dot(&(centre - tag.centre_mm).normalize()) > facing;
        let is_clear = |corner: &Point3<f64>| !self.model.hides(*corner, centre, margin_mm);
        let is_visible = is_facing && tag.corners_mm().iter().all(is_clear);
        is_visible.then(|| tag.corners_px(pose, camera))?
    }
}
