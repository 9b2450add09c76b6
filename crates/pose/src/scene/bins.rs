//! Viewpoint bins: the cells in which photos are counted.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use super::Viewpoint;
use scaleproof_core::geometry::angle::{turn, wrap_360};

/// Division of viewpoints into bins: azimuth in equal steps, the first centred on the model's front; elevation and distance by centres, each photo
/// going to the nearest.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bins {
    /// Step in degrees; divides 360.
    pub azimuth_deg: f64,
    /// Centres in degrees, ascending.
    pub pitch_deg: Vec<f64>,
    /// Centres in mm, ascending.
    pub distance_mm: Vec<f64>,
}

/// One bin, named by its centre. Bins are sorted by azimuth, pitch and distance.
#[derive(Debug, Clone, Copy, Serialize, schemars::JsonSchema)]
pub struct Bin {
    /// Azimuth of the bin's centre, as of a viewpoint: 0° looks at the front, 90° at the model's left side.
    pub azimuth_deg: f64,
    /// Elevation of the bin's centre above the ground plane.
    pub pitch_deg: f64,
    /// Distance of the bin's centre from the model's target point, at model scale.
    pub distance_mm: f64,
}

impl Bin {
    /// Returns azimuth, elevation and distance in whole thousandths, which can be compared.
    fn key(&self) -> [i64; 3] {
        [self.azimuth_deg, self.pitch_deg, self.distance_mm].map(|v| (v * 1000.0).round() as i64)
    }
}

impl PartialEq for Bin {
    fn eq(&self, other: &Bin) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Bin {}

impl PartialOrd for Bin {
    fn partial_cmp(&self, other: &Bin) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Bin {
    fn cmp(&self, other: &Bin) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl Bins {
    /// Returns the bin that contains a viewpoint.
    pub fn bin_of(&self, v: &Viewpoint) -> Bin {
        let steps = (v.azimuth_deg / self.azimuth_deg).round();
        Bin {
            azimuth_deg: wrap_360(steps * self.azimuth_deg),
            pitch_deg: nearest(&self.pitch_deg, v.pitch_deg),
            distance_mm: nearest(&self.distance_mm, v.distance_mm),
        }
    }

    /// Returns the azimuth centres in degrees, from the front counter-clockwise.
    pub fn azimuth_centres(&self) -> Vec<f64> {
        let count = (360.0 / self.azimuth_deg).round() as usize;
        (0..count).map(|i| i as f64 * self.azimuth_deg).collect()
    }

    /// Returns the number of bins.
    pub fn count(&self) -> usize {
        self.azimuth_centres().len() * self.pitch_deg.len() * self.distance_mm.len()
    }

    /// Returns the distance of an azimuth from the edge of its bin, in degrees.
    pub fn azimuth_to_edge_deg(&self, azimuth_deg: f64) -> f64 {
        let centre = (azimuth_deg / self.azimuth_deg).round() * self.azimuth_deg;
        self.azimuth_deg / 2.0 - turn(centre, azimuth_deg).abs()
    }
}

/// Returns the centre nearest to a value; the lower one on a tie. Centres are never empty (checked when the scene is read).
fn nearest(centres: &[f64], value: f64) -> f64 {
    let off = |centre: &f64| (centre - value).abs();
    let nearest = centres.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.unwrap_or(value)
}
