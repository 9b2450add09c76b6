//! Pose of a photo with all that is known of it.

use serde::Serialize;

use super::lone_tag::LoneTag;
use super::matches::IgnoredTag;
use super::uncertainty::{Sigma, Uncertainty};
use crate::scene::{Bin, Viewpoint};
use scaleproof_core::geometry::Rigid;

/// Pose of a photo, with its viewpoint, bin and uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// `T_camera_model`: model frame to camera frame, mm.
    pub pose: Rigid,
    /// Covariance and corner noise of the pose.
    pub uncertainty: Uncertainty,
    /// Viewpoint of the camera relative to the model.
    pub viewpoint: Viewpoint,
    /// Standard deviations of the viewpoint.
    pub sigma: Sigma,
    /// Bin of the scene that contains the viewpoint.
    pub bin: Bin,
    /// Probability that the bin is the right one.
    pub bin_probability: f64,
    /// Alternative poses and bins, if the pose rests on one tag.
    pub lone: Option<LoneTag>,
    /// Reasons for reduced confidence in the pose.
    pub warnings: Vec<Warning>,
    /// Ids of the tags the pose rests on, ascending.
    pub tags: Vec<u32>,
    /// Tags that were seen but not used, by id.
    pub ignored_tags: Vec<IgnoredTag>,
    /// Root mean square distance between seen and projected corners, px.
    pub rms_px: f64,
}

/// Reason for reduced confidence in a pose (explained in codes.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Warning {
    /// The camera stood so near to the edge of its bin that the bin is right with less than 95 % probability.
    NearBinEdge,
    /// The tags agree with each other worse than tags do in a good photo by a right camera: a crop, another camera, a bent card.
    PoorFit,
    /// A lone tag leaves its pose open, and only the bin is sure: the other pose (`rival`) is in the same one.
    OpenPose,
}
