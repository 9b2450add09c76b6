//! Selection of the bins' views that a session plans or captures.

use super::{Bins, Viewpoint};

/// Elevation of a standing or slightly stooping photographer: the default if a scene has several.
const USUAL_PITCH_DEG: f64 = 15.0;

/// Elevation or distance that is the centre of no bin.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what} {given} is no bin of the scene: give some of {}", centres.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))]
pub struct NoSuchBin {
    what: &'static str,
    given: f64,
    centres: Vec<f64>,
}

impl Bins {
    /// Returns the views to photograph in each texture at each place, once round the model for each elevation and distance: the given ones, or by
    /// default the usual one.
    ///
    /// # Errors
    /// An elevation or distance that is the centre of no bin.
    pub fn photographed(&self, pitches_deg: &[f64], distances_mm: &[f64]) -> Result<Vec<Viewpoint>, NoSuchBin> {
        let usual = self.usual_view();
        let pitches = named("the pitch", pitches_deg, usual.0, &self.pitch_deg)?;
        let distances = named("the distance", distances_mm, usual.1, &self.distance_mm)?;
        Ok(self.viewpoints(&pitches, &distances))
    }

    /// Returns the centres of the bins at these elevations and distances: once round the model for each.
    pub fn viewpoints(&self, pitches_deg: &[f64], distances_mm: &[f64]) -> Vec<Viewpoint> {
        Viewpoint::combinations(&self.azimuth_centres(), pitches_deg, distances_mm)
    }

    /// Returns the default elevation and distance: of the scene's, the elevation nearest to 15° and the middle distance (the nearer of two).
    pub fn usual_view(&self) -> (f64, f64) {
        let from_usual = |pitch: &f64| (pitch - USUAL_PITCH_DEG).abs();
        let pitches = self.pitch_deg.iter().copied();
        let pitch = pitches.min_by(|a, b| from_usual(a).total_cmp(&from_usual(b)));
        let distance = self.distance_mm.get(self.distance_mm.len().saturating_sub(1) / 2);
        // Neither is ever missing: a scene without them is refused when it is read.
        (pitch.unwrap_or(USUAL_PITCH_DEG), distance.copied().unwrap_or(1000.0))
    }
}

/// Returns the given centres in the scene's order, each once; the usual one if none is given.
fn named(what: &'static str, given: &[f64], usual: f64, centres: &[f64]) -> Result<Vec<f64>, NoSuchBin> {
    if given.is_empty() {
        return Ok(vec![usual]);
    }
    match given.iter().find(|value| !centres.contains(value)) {
        Some(&given) => Err(NoSuchBin {
            what,
            given,
            centres: centres.to_vec(),
        }),
        None => Ok(centres
            .iter()
            .copied()
            .filter(|centre| given.contains(centre))
            .collect()),
    }
}
