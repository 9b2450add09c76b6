//! The scene of rendered photos.

use scaleproof_pose::scene::{Bins, Classes, Envelope, ScaleModel, Scene, Viewpoint};
use scaleproof_surface::mesh::Mesh;

/// A model without tags, and bins whose centres are the viewpoints. The model is called (name, class, scale).
pub(super) fn scene(mesh: &Mesh, viewpoints: &[Viewpoint], (name, class, scale): (&str, &Classes, f64)) -> Scene {
    let each = |of: fn(&Viewpoint) -> f64| {
        let mut values: Vec<f64> = viewpoints.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    Scene {
        model: ScaleModel {
            name: name.to_owned(),
            scale,
            class: class.clone(),
            size_mm: mesh.size_mm(),
            // Every photo says its box.
            envelope: Envelope::Box,
        },
        bins: Bins {
            azimuth_deg: azimuth_step(&each(|v| v.azimuth_deg)),
            pitch_deg: each(|v| v.pitch_deg),
            distance_mm: each(|v| v.distance_mm),
        },
        tags: Vec::new(),
    }
}

/// The width of azimuth bins, which divides 360° and comes next to the smallest step between two azimuths (ascending).
pub fn azimuth_step(azimuths: &[f64]) -> f64 {
    let gaps = azimuths.windows(2).map(|pair| pair[1] - pair[0]);
    let smallest = gaps.fold(360.0, f64::min);
    360.0 / (360.0 / smallest).round().clamp(1.0, 360.0)
}
