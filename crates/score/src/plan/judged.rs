//! Plans that were sealed when the hit rate decided: their comparisons are judged by it.

use crate::compare::{LEVEL, MOST_HIT};
use crate::figures::{Comparison, Effect};
use crate::plan::{Endpoint, SealedPlan};
use scaleproof_core::statistics::{holm, mcnemar_p};

impl SealedPlan {
    /// Returns the endpoint that the plan decides by; plans that do not state it are of versions that knew the hit rate alone.
    pub fn endpoint(&self) -> Endpoint {
        self.aim.map_or(Endpoint::HitRate, |aim| aim.primary_endpoint)
    }

    /// Judges a comparison by McNemar's exact p of the hit rate, corrected by Holm over all detectors and textures, where the plan was sealed so.
    pub fn judge(&self, comparison: &mut Comparison) {
        if self.endpoint() != Endpoint::HitRate {
            return;
        }
        // A view's sum of hits is a whole number.
        let lost = comparison
            .results
            .iter()
            .map(|r| r.views.iter().map(|view| view.all.hits_lost as i64).collect());
        let p: Vec<f64> = lost.map(|lost: Vec<i64>| mcnemar_p(&lost)).collect();
        for (r, p) in comparison.results.iter_mut().zip(holm(&p)) {
            let hits = r.hit_rate.rate;
            let Some(finding) = &mut r.finding else { continue };
            (finding.hit_rate_p, finding.hit_rate_level) = (p, LEVEL);
            (finding.drop_shown_from, finding.in_places_like_these) = (None, None);
            finding.effect = match hits.drop {
                _ if p >= LEVEL => Effect::NothingShown,
                drop if drop < 0.0 => Effect::Strengthens,
                _ if hits.other <= MOST_HIT => Effect::Hides,
                _ => Effect::Weakens,
            };
        }
    }
}
