//! How far a drop of AP moves when it is measured in another way on the same photos.

use super::pairs::{clustered_by, clusters, pair};
use super::{PairedAp, Side};
use crate::score::{EvaluatedDetector, Scores};
use scaleproof_core::ap::ApDefinition;
use scaleproof_core::statistics::{Interval, intervals_95};

/// The drop of AP of one detector and variant measured in another way, minus that in the usual way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovedDrop {
    pub by: f64,
    /// Over resamples of the places and bins, the same for both ways.
    pub interval_95: Option<Interval>,
}

/// Of each detector, for a variant against the base. `usual` and `other` are of the same photos and detectors, in the same order.
pub fn moved_drops(
    (usual, definition): (&Scores, ApDefinition),
    (other, other_definition): (&Scores, ApDefinition),
    (base, variant): (&str, &str),
) -> Vec<MovedDrop> {
    let cells = |scores| pair(Scores::set(scores), base, variant).0;
    let (own, others) = (cells(usual), cells(other));
    let by = clustered_by(&own);
    let own = clusters(&own.iter().collect::<Vec<_>>(), by);
    let others = clusters(&others.iter().collect::<Vec<_>>(), by);
    let count = own.len();
    let of = |(detector, evaluated): (usize, &EvaluatedDetector)| {
        let counted = &evaluated.counted;
        let side = Side { detector, counted };
        let (own, others) = (PairedAp::of(&own, side), PairedAp::of(&others, side));
        let moved = |drawn: &[u32]| {
            let drop = |(base, other): (f64, f64)| base - other;
            drop(others.of_both(drawn, other_definition)) - drop(own.of_both(drawn, definition))
        };
        let [interval_95] = intervals_95(count, |drawn| [moved(drawn)]);
        MovedDrop {
            by: moved(&vec![1; count]),
            interval_95,
        }
    };
    usual.detectors.iter().enumerate().map(of).collect()
}
