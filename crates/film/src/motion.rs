//! How the camera moved in each frame, and how long the sensor took to read it; a rolling shutter puts the frame's pose off by both.
//!
//! The motion of a frame is the derivative of the poses around it, never only of those before: a hand turns back within a tenth of a second. The read-out is told by the video
//! itself, in what its frames' poses leave unexplained.

use std::collections::BTreeMap;

use nalgebra::Vector6;

use crate::exposure::exposure_s;
use crate::look::{Look, Motion};
use scaleproof_core::geometry::Rigid;
use scaleproof_core::geometry::rigid::{step_between, stepped};
use scaleproof_pose::locate::{ShutterResponse, Sigma, step_sigma};
use scaleproof_pose::scene::Scene;

/// So many frames before and after one tell how the camera moved in it.
pub const BESIDE: usize = 2;
/// Neighbours further away, s, say nothing of a frame's motion.
const REACH_S: f64 = 0.25;
/// Two neighbours on each side are better than one where all lie within so many seconds of the frame. Simulated walks with a hand's shake up to 12 Hz: at 30 frames a second errors
/// of azimuth fall from 0.029° to 0.020°, at 15 they do not.
const DENSE_S: f64 = 0.09;
/// How much larger an error of the motion is than the difference of two ways to estimate it: with it 69, 97 and 99.9 % of the simulated azimuths are within 1, 2, 3 σ.
const DOUBT: f64 = 1.5;
/// What is known of the read-out before a video is seen, s: 0 to 33 ms.
const READ_OUT_S: (f64, f64) = (0.0165, 0.0095);
/// No read-out is known better, s: errors of the motions make the read-out that is found shorter. In four rendered videos it was off by 0.1, 0.2, 1.0 and 1.2 ms.
const LEAST_SIGMA_S: f64 = 0.001;

/// Poses of frames by their number, each with its time, s.
#[derive(Debug, Clone, Default)]
pub struct Track(BTreeMap<u64, (f64, Rigid)>);

impl Track {
    /// Those that were found in looks.
    pub fn new(looks: &[Look]) -> Track {
        let placed = looks.iter().filter_map(|look| Some((look, look.shows.as_ref().ok()?)));
        Track(
            placed
                .map(|(look, view)| (look.number, (look.time_s, view.pose())))
                .collect(),
        )
    }

    /// Those of looks whose motion is set, each when its middle row was read.
    fn corrected(looks: &[Look]) -> Track {
        let seconds = read_out(looks).seconds;
        let mut track = Track::new(looks);
        for look in looks {
            let view = look.shows.as_ref().ok();
            let known = view.and_then(|view| Some((view.response?, view.motion?)));
            if let (Some((response, motion)), Some((_, pose))) = (known, track.0.get_mut(&look.number)) {
                *pose = stepped(pose, &(-seconds * response.step(&motion.per_s)));
            }
        }
        track
    }

    pub fn has(&self, number: u64) -> bool {
        self.0.contains_key(&number)
    }

    pub fn pose(&self, number: u64) -> Option<&Rigid> {
        self.0.get(&number).map(|(_, pose)| pose)
    }

    pub fn add(&mut self, number: u64, time_s: f64, pose: Rigid) {
        self.0.insert(number, (time_s, pose));
    }

    /// The motion at a frame, from the frames with a pose before and after it; `None` where either is missing.
    pub fn motion(&self, number: u64) -> Option<Motion> {
        let (at_s, pose) = self.0.get(&number)?;
        let step = |(_, (time_s, other)): (&u64, &(f64, Rigid))| (time_s - at_s, step_between(pose, other));
        let near = |(seconds, _): &(f64, Vector6<f64>)| seconds.abs() <= REACH_S;
        let before: Vec<_> = self.0.range(..number).rev().take(2).map(step).filter(near).collect();
        let after: Vec<_> = self.0.range(number + 1..).take(2).map(step).filter(near).collect();
        let (first, next) = (*before.first()?, *after.first()?);
        let nearest = [first, next];
        let (better, worse) = match (before.get(1), after.get(1)) {
            (Some(a), Some(b)) if a.0.abs().max(b.0) <= DENSE_S => {
                (derivative(&[*a, first, next, *b]), derivative(&nearest))
            }
            _ => (derivative(&nearest), derivative(&[next])),
        };
        Some(Motion {
            per_s: better,
            doubt: (better - worse) * DOUBT,
        })
    }
}

/// The derivative at 0 of the polynomial through 0 at 0 and other values at other times (Lagrange's).
fn derivative(others: &[(f64, Vector6<f64>)]) -> Vector6<f64> {
    let weight = |at: f64| {
        let rest = others.iter().map(|(time, _)| *time).filter(|time| *time != at);
        rest.map(|time| time / (time - at)).product::<f64>() / at
    };
    others.iter().map(|(at, value)| value * weight(*at)).sum()
}

/// Sets the motion of every frame that has one, and how far it smears the model; when all were looked at.
pub fn set(looks: &mut [Look]) {
    set_by(looks, &Track::new(looks));
    // A rolling shutter puts each pose off by as much as the camera moves, so that where a motion changes the poses say it wrong.
    let corrected = Track::corrected(looks);
    set_by(looks, &corrected);
    set_smears(looks);
}

/// Sets how far the motion of each frame that has one smears the model.
pub(crate) fn set_smears(looks: &mut [Look]) {
    let exposure_s = exposure_s(looks);
    for view in looks.iter_mut().filter_map(|look| look.shows.as_mut().ok()) {
        view.smear_px = view
            .response
            .zip(view.motion)
            .map(|(response, motion)| exposure_s * response.speed_px_s(&motion.per_s));
    }
}

fn set_by(looks: &mut [Look], track: &Track) {
    for look in looks {
        if let Ok(view) = &mut look.shows {
            view.motion = track.motion(look.number);
        }
    }
}

/// How long the sensor took to read a frame, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadOut {
    pub seconds: f64,
    pub sigma_s: f64,
}

/// The read-out by the frames of a video whose motion is set, and by what is usual, each as far as it is known.
pub fn read_out(looks: &[Look]) -> ReadOut {
    let views = looks.iter().filter_map(|look| look.shows.as_ref().ok());
    let said: Vec<[f64; 2]> = views
        .filter_map(|view| Some(view.response?.says(&view.motion?.per_s)))
        .collect();
    let weight: f64 = said.iter().map(|[_, h]| h).sum();
    let (usual, usual_sigma) = READ_OUT_S;
    let by_video = said.iter().map(|[g, _]| g).sum::<f64>() / weight;
    // From the frames' own scatter: the errors of one frame's corners are not independent.
    let scatter: f64 = said.iter().map(|[g, h]| (g - by_video * h).powi(2)).sum();
    let variance = scatter / weight.powi(2) + LEAST_SIGMA_S.powi(2);
    if said.len() < 2 || !variance.is_finite() {
        return ReadOut {
            seconds: usual,
            sigma_s: usual_sigma,
        };
    }
    let [of_video, of_usual] = [1.0 / variance, 1.0 / usual_sigma.powi(2)];
    ReadOut {
        seconds: (by_video * of_video + usual * of_usual) / (of_video + of_usual),
        sigma_s: 1.0 / (of_video + of_usual).sqrt(),
    }
}

/// Where the camera was when a frame's middle row was read, and the standard deviations that the correction adds to the viewpoint. `usual`: doubts of other frames' motions, which one
/// frame's own may fall short of by chance.
pub fn at_middle_row(
    pose: &Rigid,
    response: &ShutterResponse,
    motion: &Motion,
    read_out: ReadOut,
    usual: &[Vector6<f64>],
    scene: &Scene,
) -> (Rigid, Sigma) {
    let step = response.step(&motion.per_s);
    let corrected = stepped(pose, &(-read_out.seconds * step));
    let half = |doubt: &Vector6<f64>, of: usize| {
        response.step(doubt)
            * (read_out.seconds.hypot(read_out.sigma_s) / (of as f64 * if usual.is_empty() { 1.0 } else { 2.0 }).sqrt())
    };
    let mut errors = vec![step * read_out.sigma_s, half(&motion.doubt, 1)];
    errors.extend(usual.iter().map(|doubt| half(doubt, usual.len())));
    let sigma = step_sigma(&errors, &corrected, scene);
    (corrected, sigma)
}
