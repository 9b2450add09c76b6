//! What is shown of many detectors and textures at once, and in several figures of each.

use super::result::{Compared, Comparison, Finding};
use scaleproof_core::statistics::holm;

/// Where nothing differs, anything at all is shown with this probability at most.
pub(super) const LEVEL: f64 = 0.05;

/// Corrects the findings of a comparison, each of which was made at the level by itself, for their number.
///
/// The hit rate is tested for every detector and texture, and its p corrected over all of them (Holm 1979). The other figures, and the single
/// directions, pass where that of the same detector and texture did (a gate, as by Dmitrienko, Offen and Westfall, "Gatekeeping strategies for
/// clinical trials that do not require all primary effects to be significant", Statistics in Medicine 22 (2003)): where nothing differs nothing passes
/// but by a wrong finding of the hit rate.
pub(in crate::score) fn decide(results: &mut [&mut Compared]) {
    let p: Vec<f64> = results.iter().map(|r| r.hit_rate.mcnemar_p).collect();
    let tests = results.len();
    for (r, holm_p) in results.iter_mut().zip(holm(&p)) {
        (r.holm_p, r.tests) = (holm_p, tests);
        if holm_p < LEVEL {
            continue;
        }
        let figures = [&mut r.hit_rate.rate, &mut r.mean_confidence, &mut r.ap50];
        let directions = r.azimuth_bins.iter_mut().map(|bin| &mut bin.hits.rate);
        figures
            .into_iter()
            .chain(directions)
            .for_each(|d| d.finding = d.finding.undone());
    }
}

/// As [`decide`], for several comparisons that are read together.
pub fn decide_together(comparisons: &mut [Comparison]) {
    let results = comparisons.iter_mut().flat_map(|comparison| &mut comparison.results);
    decide(&mut results.collect::<Vec<_>>());
}

impl Finding {
    pub fn is_shown(self) -> bool {
        matches!(self, Finding::Drop | Finding::Rise)
    }

    /// What is left of a finding that does not pass.
    pub(in crate::score) fn undone(self) -> Finding {
        if self.is_shown() {
            Finding::NotAfterCorrection
        } else {
            self
        }
    }
}
