//! Share of the camera's motion in σ of a frame's viewpoint, by the frames before and after it.
//!
//! The rows of a frame are read one after the other (rolling shutter), and no header says how long that takes: tags are seen up to half of it before or after the middle row.

use crate::tracking::{FrameResult, View};
use scaleproof_core::geometry::angle::turn;
use scaleproof_pose::locate::Sigma;
use scaleproof_pose::scene::Viewpoint;

/// Sensors of phones and cameras take 5 to 30 ms to read a frame of a video, s.
const READ_OUT_S: f64 = 0.03;
/// Frames further away than this, s, say nothing of a frame's motion.
const REACH_S: f64 = 0.25;

/// Sets the motion of the last frame but one of those with a pose, when the last of all frames has one; it stays `None` if the frames before or after
/// are too far away.
pub fn set_motion(looks: &mut [FrameResult]) {
    if looks.last().is_none_or(|last| last.shows.is_err()) {
        return;
    }
    let placed = looks
        .iter_mut()
        .rev()
        .filter_map(|look| Some((look.time_s, look.shows.as_mut().ok()?)));
    let mut last: Vec<(f64, &mut View)> = placed.take(3).collect();
    let [(after_s, after), (at_s, view), (before_s, before)] = &mut last[..] else {
        return;
    };
    let [later, sooner] = [*after_s - *at_s, *at_s - *before_s];
    if later.max(sooner) <= REACH_S {
        let sides = [(&before.viewpoint, sooner), (&after.viewpoint, later)];
        view.moved = Some(moved(&view.viewpoint, &sides));
    }
}

/// Returns the motion of the viewpoint in half the read-out, taken as one standard deviation. The speed is the root mean square of those to both sides: a hand that turns
/// back does not stand still.
fn moved(at: &Viewpoint, sides: &[(&Viewpoint, f64); 2]) -> Sigma {
    let sigma = |way: &dyn Fn(&Viewpoint) -> f64| {
        let [before, after] = sides.map(|(other, seconds)| way(other) / seconds);
        before.hypot(after) / 2_f64.sqrt() * READ_OUT_S / 2.0
    };
    Sigma {
        azimuth_deg: sigma(&|other| turn(at.azimuth_deg, other.azimuth_deg)),
        pitch_deg: sigma(&|other| other.pitch_deg - at.pitch_deg),
        distance_mm: sigma(&|other| other.distance_mm - at.distance_mm),
    }
}
