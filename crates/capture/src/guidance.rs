//! Required views, those that are filled, and the step from the camera's viewpoint to the next one.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;

use scaleproof_core::geometry::angle::turn;
use scaleproof_pose::scene::{Bin, Bins, Viewpoint};

/// Largest deviation of a camera from its target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tolerance {
    pub azimuth_deg: f64,
    pub pitch_deg: f64,
    pub distance_mm: f64,
}

/// One required view.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    pub viewpoint: Viewpoint,
    /// The bin it fills; a photo must fall into it, whatever the tolerance.
    pub bin: Bin,
    /// The photo that fills it.
    pub photo: Option<String>,
}

/// A target as people name it, as in `90°/15°/850 mm`.
impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let v = &self.viewpoint;
        write!(f, "{:.0}°/{:.0}°/{:.0} mm", v.azimuth_deg, v.pitch_deg, v.distance_mm)
    }
}

impl Target {
    /// Returns the viewpoint in words.
    pub fn in_words(&self) -> String {
        let v = &self.viewpoint;
        let side = match v.azimuth_deg.round().rem_euclid(360.0) {
            0.0 => "in front of the model".to_owned(),
            90.0 => "at the model's left side".to_owned(),
            180.0 => "behind the model".to_owned(),
            270.0 => "at the model's right side".to_owned(),
            azimuth => format!("at {azimuth:.0}° round the model"),
        };
        format!("{side} ({:.0}° up, {:.0} mm away)", v.pitch_deg, v.distance_mm)
    }
}

/// Step that brings a camera to its target: its largest part. Amounts are signed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NextMove {
    /// To a larger azimuth, degrees: counter-clockwise seen from above, which is to the right for somebody who faces the model.
    Azimuth(f64),
    /// Away from the model, mm.
    Distance(f64),
    /// Upwards, mm.
    Height(f64),
}

/// The targets of one capture.
#[derive(Debug, Clone)]
pub struct Guidance {
    targets: Vec<Target>,
    tolerance: Tolerance,
    bins: Bins,
}

impl Guidance {
    /// Creates targets at these viewpoints, in their order.
    pub fn at(viewpoints: &[Viewpoint], tolerance: Tolerance, bins: &Bins) -> Guidance {
        let target = |viewpoint: &Viewpoint| Target {
            viewpoint: *viewpoint,
            bin: bins.bin_of(viewpoint),
            photo: None,
        };
        Guidance {
            targets: viewpoints.iter().map(target).collect(),
            tolerance,
            bins: bins.clone(),
        }
    }

    pub fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// Returns the numbers of filled targets and of all.
    pub fn filled_of_all(&self) -> (usize, usize) {
        (self.targets.len() - self.open().count(), self.targets.len())
    }

    /// Returns the step between the scene's azimuth bins, deg.
    pub fn azimuth_step_deg(&self) -> f64 {
        self.bins.azimuth_deg
    }

    pub fn open(&self) -> impl Iterator<Item = &Target> {
        self.targets.iter().filter(|target| target.photo.is_none())
    }

    pub fn is_finished(&self) -> bool {
        self.open().next().is_none()
    }

    /// Marks a target as filled by a photo.
    pub fn fill(&mut self, index: usize, photo: &str) {
        self.targets[index].photo = Some(photo.to_owned());
    }

    /// Opens the target that a photo filled, if any.
    pub fn reopen(&mut self, photo: &str) {
        for target in &mut self.targets {
            target.photo.take_if(|filled_by| filled_by == photo);
        }
    }

    /// Returns the open target nearest to a viewpoint, each part measured by its tolerance.
    pub fn nearest_open(&self, from: &Viewpoint) -> Option<usize> {
        let open = (0..self.targets.len()).filter(|i| self.targets[*i].photo.is_none());
        open.min_by(|a, b| self.offset(*a, from).total_cmp(&self.offset(*b, from)))
    }

    /// Returns the filled target that a viewpoint would fill as well.
    pub fn filled_at(&self, from: &Viewpoint) -> Option<&Target> {
        let mut filled = (0..self.targets.len()).filter(|i| self.targets[*i].photo.is_some());
        filled.find(|i| self.step(*i, from).is_none()).map(|i| &self.targets[i])
    }

    /// Returns the step that is missing most, by its tolerance; `None` when the target is reached.
    pub fn step(&self, index: usize, from: &Viewpoint) -> Option<NextMove> {
        let target = &self.targets[index];
        let parts = self.parts(index, from);
        if parts.iter().all(|part| part.abs() <= 1.0) && self.bins.bin_of(from) == target.bin {
            return None;
        }
        let (to, sin) = (&target.viewpoint, |v: &Viewpoint| v.pitch_deg.to_radians().sin());
        let most = (0..3).max_by(|a, b| parts[*a].abs().total_cmp(&parts[*b].abs()))?;
        Some(match most {
            0 => NextMove::Azimuth(turn(from.azimuth_deg, to.azimuth_deg)),
            1 => NextMove::Distance(to.distance_mm - from.distance_mm),
            // The way along the line of sight is another step.
            _ => NextMove::Height(from.distance_mm * (sin(to) - sin(from))),
        })
    }

    /// Returns the largest deviation of a viewpoint from a target, in tolerances: up to 1 within them.
    pub fn off_by(&self, index: usize, from: &Viewpoint) -> f64 {
        let parts = self.parts(index, from);
        parts.iter().fold(0.0, |most, part| part.abs().max(most))
    }

    /// Returns the deviations of azimuth, distance and elevation, in tolerances.
    fn parts(&self, index: usize, from: &Viewpoint) -> [f64; 3] {
        let (to, tolerance) = (&self.targets[index].viewpoint, &self.tolerance);
        [
            turn(from.azimuth_deg, to.azimuth_deg) / tolerance.azimuth_deg,
            (to.distance_mm - from.distance_mm) / tolerance.distance_mm,
            (to.pitch_deg - from.pitch_deg) / tolerance.pitch_deg,
        ]
    }

    fn offset(&self, index: usize, from: &Viewpoint) -> f64 {
        self.parts(index, from).iter().map(|part| part * part).sum()
    }
}

/// Bins as people name them: by the azimuth, as in `90`, or by azimuth, pitch and distance, as in `90/15/850`.
#[derive(Debug, Clone)]
pub struct BinName {
    azimuth_deg: f64,
    pitch_and_distance: Option<[f64; 2]>,
}

/// A text names no bin.
#[derive(Debug, thiserror::Error)]
#[error("name a bin by its azimuth, or by azimuth/pitch/distance as in 90/15/850")]
pub struct NoBinName;

impl FromStr for BinName {
    type Err = NoBinName;

    fn from_str(text: &str) -> Result<BinName, NoBinName> {
        let number = |part: &str| part.trim().parse().ok().filter(|value: &f64| value.is_finite());
        let numbers: Option<Vec<f64>> = text.split('/').map(number).collect();
        let (azimuth_deg, pitch_and_distance) = match numbers.as_deref() {
            Some([azimuth]) => (*azimuth, None),
            Some([azimuth, pitch, distance]) => (*azimuth, Some([*pitch, *distance])),
            _ => return Err(NoBinName),
        };
        Ok(BinName {
            azimuth_deg,
            pitch_and_distance,
        })
    }
}

impl BinName {
    /// Returns true if it names this bin.
    pub fn names(&self, bin: &Bin) -> bool {
        let [pitch_deg, distance_mm] = self.pitch_and_distance.unwrap_or([bin.pitch_deg, bin.distance_mm]);
        *bin == Bin {
            azimuth_deg: self.azimuth_deg,
            pitch_deg,
            distance_mm,
        }
    }
}

impl Tolerance {
    /// Returns the tolerance of targets in the middle of bins: a sixth of the azimuth step but 8° at most, 6°, and a tenth of the nearest distance. The stored
    /// session, taken by hand as it were, is off by up to 5°, 4° and 7 %.
    pub fn of_bins(bins: &Bins, distances_mm: &[f64]) -> Tolerance {
        Tolerance {
            azimuth_deg: (bins.azimuth_deg / 6.0).min(8.0),
            pitch_deg: 6.0,
            distance_mm: 0.1 * nearest(distances_mm),
        }
    }

    /// Returns the tolerance of targets that are the viewpoints of other photos, so that pairs differ by little: 3°, 3°, and a twentieth of the distance.
    pub fn of_pairs(viewpoints: &[Viewpoint]) -> Tolerance {
        let distances: Vec<f64> = viewpoints.iter().map(|v| v.distance_mm).collect();
        Tolerance {
            azimuth_deg: 3.0,
            pitch_deg: 3.0,
            distance_mm: 0.05 * nearest(&distances),
        }
    }
}

fn nearest(distances_mm: &[f64]) -> f64 {
    distances_mm.iter().copied().fold(f64::INFINITY, f64::min)
}
