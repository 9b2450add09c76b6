//! Generator of simulated views.

use nalgebra::{Matrix3, Point3, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::ops::Range;

use crate::camera::Camera;
use crate::scene::{Scene, Tag, Viewpoint};
use crate::tags::SeenTag;
use scaleproof_core::geometry::{Rigid, rigid};

/// Cosine of the angle between a tag's normal and the line of sight below which no detector reads it.
const GRAZING: f64 = 0.2;
/// Amount by which the model's box is shrunk on each side, so that it does not hide tags on its surface, mm.
const SKIN_MM: f64 = 1.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of most corners, px per axis.
    pub sigma_px: f64,
    /// Share of corners with four times this standard deviation: the heavy tails of real detectors.
    pub tail_share: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedView {
    /// True viewpoint of the camera; `pose` is the true `T_camera_model`.
    pub viewpoint: Viewpoint,
    pub pose: Rigid,
    pub seen: Vec<SeenTag>,
    /// Scene assumed by the photographer, as `camera` is the assumed camera; both differ from the truth only by the fault.
    pub scene: Scene,
    pub camera: Camera,
    /// Id of the tag to which a fault of one tag applies.
    pub struck: Option<u32>,
}

/// Generator of views, deterministic for a seed.
pub struct Simulator<'a> {
    pub(super) scene: &'a Scene,
    pub(super) camera: &'a Camera,
    noise: Noise,
    pub(super) rng: Pcg64Mcg,
}

impl<'a> Simulator<'a> {
    /// Creates a generator for the true scene and camera.
    pub fn new(scene: &'a Scene, camera: &'a Camera, noise: Noise, seed: u64) -> Simulator<'a> {
        Simulator {
            scene,
            camera,
            noise,
            rng: Pcg64Mcg::seed_from_u64(seed),
        }
    }

    /// Returns a random viewpoint of any azimuth, with elevation (degrees) and distance (mm) from these ranges.
    pub fn viewpoint(&mut self, pitch_deg: Range<f64>, distance_mm: Range<f64>) -> Viewpoint {
        Viewpoint {
            azimuth_deg: self.rng.random_range(0.0..360.0),
            pitch_deg: self.rng.random_range(pitch_deg),
            distance_mm: self.rng.random_range(distance_mm),
        }
    }

    /// Returns the detections of the scene's tags under a pose `T_camera_model`.
    pub fn seen(&mut self, pose: &Rigid) -> Vec<SeenTag> {
        let tags = &self.scene.tags;
        let seen = |tag: &Tag| {
            Some(SeenTag {
                id: tag.id,
                family: tag.family,
                corners_px: self.seen_px(tag, pose)?,
                is_whole: true,
                is_fitted: true,
                side_blurs_px: None,
            })
        };
        tags.iter().filter_map(seen).collect()
    }

    /// Returns the pixels of a tag's corners with the detector's noise; `None` if the tag does not face the camera, is outside the image or behind
    /// the model.
    pub(super) fn seen_px(&mut self, tag: &Tag, pose: &Rigid) -> Option<[[f64; 2]; 4]> {
        let pixels = self.scene.visible_px(tag, (GRAZING, -SKIN_MM), pose, self.camera)?;
        let [width, height] = [self.camera.width, self.camera.height].map(f64::from);
        let is_inside = |[x, y]: &[f64; 2]| (0.0..width).contains(x) && (0.0..height).contains(y);
        pixels.iter().all(is_inside).then(|| self.noisy(pixels))
    }

    pub(super) fn noisy(&mut self, pixels: [[f64; 2]; 4]) -> [[f64; 2]; 4] {
        pixels.map(|pixel| {
            let is_tail = self.rng.random::<f64>() < self.noise.tail_share;
            let sigma_px = self.noise.sigma_px * if is_tail { 4.0 } else { 1.0 };
            pixel.map(|v| v + sigma_px * normal(&mut self.rng))
        })
    }
}

/// Returns `T_camera_model` of an upright camera at a viewpoint, looking at the target (model frame, mm).
pub fn looking_at(viewpoint: &Viewpoint, target_mm: Point3<f64>) -> Rigid {
    let centre = viewpoint.camera_centre_mm(target_mm);
    let z = (target_mm - centre).normalize();
    let x = z.cross(&Vector3::z()).normalize();
    let rotation = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
    rigid::from_matrix(rotation, -(rotation * centre.coords))
}

/// Draws a normal random number with σ = 1 (Box & Muller 1958).
pub fn normal(rng: &mut impl Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random::<f64>().max(1e-12), rng.random());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}
