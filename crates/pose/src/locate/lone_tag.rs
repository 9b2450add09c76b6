//! Alternative poses and bins of a lone tag.

use serde::Serialize;

use crate::scene::{Bin, Viewpoint};
use scaleproof_core::geometry::Rigid;

/// Alternative pose of a lone tag, and the bins in which the camera may be.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoneTag {
    /// Best different pose, if there is one.
    pub rival: Option<Rival>,
    /// Possible bins, the most probable first.
    pub bins: Vec<BinProbability>,
}

/// Another pose that a lone tag allows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Rival {
    /// `T_camera_model`, mm.
    #[serde(skip)]
    pub pose: Rigid,
    /// The viewpoint of the other pose, with the next two.
    pub azimuth_deg: f64,
    pub pitch_deg: f64,
    pub distance_mm: f64,
    /// Likelihood relative to the better pose, by the residuals of both: 0 to 1.
    pub likelihood: f64,
}

impl Rival {
    pub(super) fn new(pose: Rigid, from: &Viewpoint, likelihood: f64) -> Rival {
        Rival {
            pose,
            azimuth_deg: from.azimuth_deg,
            pitch_deg: from.pitch_deg,
            distance_mm: from.distance_mm,
            likelihood,
        }
    }
}

/// A bin and how probable it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BinProbability {
    pub bin: Bin,
    /// From 0 to 1.
    pub probability: f64,
}
