//! Views of a scene's bins that a session plans or captures.

use super::{Bins, Viewpoint};

/// The pitch of a standing or slightly stooping photographer, where a scene has several.
const USUAL_PITCH_DEG: f64 = 15.0;

impl Bins {
    /// The centres of the bins at these pitches and distances: once round the model for each.
    pub fn viewpoints(&self, pitches_deg: &[f64], distances_mm: &[f64]) -> Vec<Viewpoint> {
        Viewpoint::combinations(&self.azimuth_centres(), pitches_deg, distances_mm)
    }

    /// The pitch and distance that are photographed when none are named: of the scene's, the pitch nearest to 15° and the middle distance (the
    /// nearer of two).
    pub fn usual_view(&self) -> (f64, f64) {
        let from_usual = |pitch: &f64| (pitch - USUAL_PITCH_DEG).abs();
        let pitches = self.pitch_deg.iter().copied();
        let pitch = pitches.min_by(|a, b| from_usual(a).total_cmp(&from_usual(b)));
        let distance = self.distance_mm.get(self.distance_mm.len().saturating_sub(1) / 2);
        // Neither is ever missing: a scene without them is refused when it is read.
        (pitch.unwrap_or(USUAL_PITCH_DEG), distance.copied().unwrap_or(1000.0))
    }
}
