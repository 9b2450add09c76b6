//! Uncertainty of a lone tag by refitting its pose under resampled noise (parametric bootstrap: Efron & Tibshirani 1993, section 6.5).
//!
//! Eight numbers determine six unknowns: the two branches of a planar target swap, and near frontal views the tilt enters by its square. First
//! derivatives at one pose describe neither.

use nalgebra::Matrix6;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use super::lone_tag::BinProbability;
use super::matches::{Corners, Match};
use super::planar::planar_branches;
use super::refine;
use super::uncertainty::Sigma;
use crate::camera::Camera;
use crate::scene::{Bin, Bins, Scene, Viewpoint, corners_in_tag_mm};
use crate::tags::middle_px;
use scaleproof_core::geometry::{Rigid, angle::turn, rigid};
use scaleproof_core::statistics::normal;

/// Number of sampled poses, enough to tell a share of 1 in 100 from none.
const DRAWS: usize = 200;

/// Sampled poses of a lone tag, each with its viewpoint.
pub(super) struct Resampled(Vec<(Rigid, Viewpoint)>);

impl Resampled {
    /// Samples poses under normal noise of `noise_px` per axis on the seen corners, and under the tag's size error ([`Match::off_alike`]).
    /// Deterministic.
    pub(super) fn new(only: &Match, noise_px: f64, scene: &Scene, camera: &Camera) -> Resampled {
        let mut rng = Pcg64Mcg::seed_from_u64(0);
        // Fitting undistorted corners takes half the time; it weights corners otherwise, but hardly so within one tag.
        let straight = camera.straight();
        let (middle, off_alike) = (middle_px(&only.corners_px), only.off_alike());
        let pose = |_| {
            let larger = if off_alike > 0.0 {
                off_alike * normal::draw(&mut rng)
            } else {
                0.0
            };
            let mut moved = |at: f64, middle: f64| at + larger * (at - middle) + noise_px * normal::draw(&mut rng);
            let mut corners_px = only.corners_px.map(|[x, y]| [moved(x, middle[0]), moved(y, middle[1])]);
            for pixel in &mut corners_px {
                *pixel = straight.pixel_of(camera.point_at(*pixel)?);
            }
            let seen = Match {
                corners_px,
                ..only.clone()
            };
            let pose = best_branch(&seen, &straight)?;
            Some((pose, Viewpoint::of_pose(&pose, scene.model.target_mm())))
        };
        Resampled((0..DRAWS).filter_map(pose).collect())
    }

    /// Returns the covariance of the step from a pose to the true one; `None` without samples.
    pub(super) fn covariance(&self, from: &Rigid) -> Option<Matrix6<f64>> {
        let squares = self.0.iter().map(|(pose, _)| {
            let step = rigid::step_between(from, pose);
            step * step.transpose()
        });
        (!self.0.is_empty()).then(|| squares.sum::<Matrix6<f64>>() / self.0.len() as f64)
    }

    /// Returns the root mean square differences from a viewpoint; infinite without samples.
    pub(super) fn sigma(&self, from: &Viewpoint) -> Sigma {
        let rms = |off: &dyn Fn(&Viewpoint) -> f64| match self.0.len() {
            0 => f64::INFINITY,
            count => (self.0.iter().map(|(_, v)| off(v).powi(2)).sum::<f64>() / count as f64).sqrt(),
        };
        Sigma {
            azimuth_deg: rms(&|v| turn(from.azimuth_deg, v.azimuth_deg)),
            pitch_deg: rms(&|v| v.pitch_deg - from.pitch_deg),
            distance_mm: rms(&|v| v.distance_mm - from.distance_mm),
        }
    }

    /// Returns the smoothed share of samples in a bin: half a sample is added to both sides, so it is never 0 or 1.
    pub(super) fn share_in(&self, bin: &Bin, bins: &Bins) -> f64 {
        self.share(|v| bins.bin_of(v) == *bin)
    }

    pub(super) fn share_beyond(&self, bin: &Bin, bins: &Bins, margin_deg: f64) -> f64 {
        let edge_deg = bins.azimuth_deg / 2.0 + margin_deg;
        self.share(|v| turn(bin.azimuth_deg, v.azimuth_deg).abs() > edge_deg)
    }

    /// Returns the bins of the samples with their probabilities, the most probable first.
    pub(super) fn bins(&self, bins: &Bins) -> Vec<BinProbability> {
        let mut all: Vec<Bin> = self.0.iter().map(|(_, v)| bins.bin_of(v)).collect();
        all.sort_unstable();
        let probability = |same: &[Bin]| BinProbability {
            bin: same[0],
            probability: same.len() as f64 / self.0.len() as f64,
        };
        let mut found: Vec<_> = all.chunk_by(Bin::eq).map(probability).collect();
        found.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        found
    }

    fn share(&self, has: impl Fn(&Viewpoint) -> bool) -> f64 {
        let with = self.0.iter().filter(|(_, v)| has(v)).count();
        (with as f64 + 0.5) / (self.0.len() as f64 + 1.0)
    }
}

/// Returns the better of the two refined poses of a lone tag.
fn best_branch(only: &Match, camera: &Camera) -> Option<Rigid> {
    let corners = Corners::new(std::slice::from_ref(only));
    let to_model = only.tag.pose().inverse();
    let branches = planar_branches(&corners_in_tag_mm(only.tag.size_mm), &only.corners_px, camera);
    let refine = |branch| refine::refine_roughly(&(branch * to_model), &corners, camera);
    let refined = branches.into_iter().filter_map(refine);
    refined.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(pose, _)| pose)
}
