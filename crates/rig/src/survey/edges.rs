//! Error of the detector that all tags share: their edges found a little too far in or out.
//!
//! Light from the white ring spills over the black border (blur, gamma), so that every tag looks a little smaller, or larger. As a
//! share of the tag it is an error of scale: on the skyline photos 1 % of every distance when only one tag is fixed, far beyond the
//! σ of independent corner errors. It is one number in px, estimated from fixed tags' distances and from near against far tags.

use nalgebra::Vector6;

use super::adjust::{Free, Loss, adjust};
use super::network::{Poses, TagNetwork};
use scaleproof_core::geometry::{Rigid, rigid};

/// Expected shift of a detector's edges before anything is measured: σ in px.
const EXPECTED_PX: f64 = 0.3;

/// Remaining error after one shift for all tags, since it differs with light, blur and tilt: σ in px. Measured on the skyline photos:
/// 0.27 px when eight fixed tags tell it, 0.18 px when near against far tags must.
pub(super) const LEFT_PX: f64 = 0.1;

/// Step of the numerical derivatives, px.
const STEP_PX: f64 = 0.05;

/// Shared shift and its uncertainty, once it is taken out.
pub(super) struct SharedShift {
    /// Distance by which the edges were moved out, px.
    pub moved_px: f64,
    /// Its variance for corners of σ = 1 px.
    pub variance: f64,
    /// Derivative of each tag's pose by the shift, per px: translation (mm) and rotation (rad) in the tag's own frame.
    pub by_tag: Vec<Option<Vector6<f64>>>,
}

/// Moves all edges to where the adjustment has the least cost (a parabola through three adjustments, three times), corrects the sightings, and
/// adjusts the poses. `moved_px`: what was already taken out; `noise_px`: σ of a corner coordinate.
pub(super) fn fit(net: &mut TagNetwork, poses: &mut Poses, loss: Loss, moved_px: f64, noise_px: f64) -> SharedShift {
    let mut moved_px = moved_px;
    // Weight of the expectation, in the unit of the cost.
    let stiffness = 2.0 * (noise_px / EXPECTED_PX).powi(2);
    let (mut curvature, mut by_tag) = (0.0, Vec::new());
    for _ in 0..3 {
        let at = |px: f64| {
            let mut near = poses.clone();
            let left = adjust(&shifted(net, px), &mut near, Free::All, loss, 30);
            (left, near)
        };
        let ((less, inner), (here, _), (more, outer)) = (at(-STEP_PX), at(0.0), at(STEP_PX));
        curvature = ((less - 2.0 * here + more) / STEP_PX.powi(2)).max(0.0);
        let slope = (more - less) / (2.0 * STEP_PX) + stiffness * moved_px;
        let pull = curvature + stiffness;
        let step = if pull > 0.0 {
            (-slope / pull).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        *net = shifted(net, step);
        moved_px += step;
        adjust(net, poses, Free::All, loss, 50);
        let pairs = inner.tags.iter().zip(&outer.tags);
        by_tag = pairs.map(|(a, b)| Some(rate(a.as_ref()?, b.as_ref()?))).collect();
    }
    let pull = curvature + stiffness;
    SharedShift {
        moved_px,
        variance: if pull > 0.0 { 2.0 / pull } else { 0.0 },
        by_tag,
    }
}

fn rate(inner: &Rigid, outer: &Rigid) -> Vector6<f64> {
    let (turn, place) = rigid::to_rotation_vector(&(inner.inverse() * outer));
    Vector6::new(place[0], place[1], place[2], turn[0], turn[1], turn[2]) / (2.0 * STEP_PX)
}

fn shifted(net: &TagNetwork, px: f64) -> TagNetwork {
    let mut moved = net.clone();
    for s in &mut moved.sightings {
        s.corners_px = outwards(&s.corners_px, px);
    }
    moved
}

/// Returns a quadrilateral whose sides are all moved out by `px` pixels.
pub fn outwards(c: &[[f64; 2]; 4], px: f64) -> [[f64; 2]; 4] {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let side = |i: usize| {
        let (a, b) = (c[i % 4], c[(i + 1) % 4]);
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = along[0].hypot(along[1]);
        [along[0] / length, along[1] / length]
    };
    // In the image's y-down frame the corners run clockwise to the eye, so that "out" is to the left of each side.
    let turn = (0..4).map(|i| cross(c[i], c[(i + 1) % 4])).sum::<f64>().signum();
    std::array::from_fn(|i| {
        let (before, after) = (side(i + 3), side(i));
        // The two moved lines meet out along each side by `px / sin` of the angle between them.
        let reach = turn * px / cross(before, after);
        let moved = |k: usize| c[i][k] + reach * (before[k] - after[k]);
        [moved(0), moved(1)]
    })
}
