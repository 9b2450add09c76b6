//! Places of viewpoints on the dial: the model from above, one ring for each elevation and required distance.

use serde::Serialize;

use scaleproof_pose::scene::{Bin, Viewpoint};

/// Share of the dial's radius that is left to the model.
const INNER: f64 = 0.42;

/// A ring of sectors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DialRing {
    pub pitch_deg: f64,
    pub distance_mm: f64,
    /// Inner radius as a share of the dial's.
    pub inner_share: f64,
    pub outer_share: f64,
}

/// Rings from the inside outwards, in the order of their distance over ground.
#[derive(Debug, Clone)]
pub struct DialRings(pub Vec<DialRing>);

impl DialRings {
    pub fn of_bins(bins: &[Bin]) -> DialRings {
        let mut kinds: Vec<[f64; 2]> = Vec::new();
        for bin in bins {
            let kind = [bin.pitch_deg, bin.distance_mm];
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        kinds.sort_by(|a, b| a[0].total_cmp(&b[0]));
        kinds.sort_by(|a, b| over_ground_mm(a).total_cmp(&over_ground_mm(b)));
        let width = (1.0 - INNER) / kinds.len().max(1) as f64;
        let ring = |(i, [pitch_deg, distance_mm]): (usize, [f64; 2])| DialRing {
            pitch_deg,
            distance_mm,
            inner_share: INNER + width * i as f64,
            outer_share: INNER + width * (i + 1) as f64,
        };
        DialRings(kinds.into_iter().enumerate().map(ring).collect())
    }

    pub fn ring_of(&self, bin: &Bin) -> usize {
        let same = |ring: &DialRing| [ring.pitch_deg, ring.distance_mm] == [bin.pitch_deg, bin.distance_mm];
        self.0.iter().position(same).unwrap_or_default()
    }

    /// Returns a viewpoint's distance from the dial's centre, as a share of its radius: in the middle of a ring at that ring's distance over ground, in
    /// proportion between and beside the rings, and at most a little outside.
    pub fn radius_share(&self, v: &Viewpoint) -> f64 {
        let ground = |ring: &DialRing| over_ground_mm(&[ring.pitch_deg, ring.distance_mm]);
        let middle = |ring: &DialRing| (ring.inner_share + ring.outer_share) / 2.0;
        let at = over_ground_mm(&[v.pitch_deg, v.distance_mm]);
        let share = match self.0.iter().position(|ring| at <= ground(ring)) {
            _ if self.0.is_empty() => 1.0,
            Some(0) => middle(&self.0[0]) * at / ground(&self.0[0]),
            Some(i) => {
                let (a, b) = (&self.0[i - 1], &self.0[i]);
                middle(a) + (middle(b) - middle(a)) * (at - ground(a)) / (ground(b) - ground(a))
            }
            None => self.0.last().map_or(1.0, |last| middle(last) * at / ground(last)),
        };
        if share.is_finite() {
            share.clamp(0.15, 1.08)
        } else {
            1.0
        }
    }
}

fn over_ground_mm([pitch_deg, distance_mm]: &[f64; 2]) -> f64 {
    distance_mm * pitch_deg.to_radians().cos()
}
