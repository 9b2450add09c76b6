//! Change of a drop of AP when it is measured in another way on the same photos.

use crate::compare::differences::paired_ap;
use crate::compare::pairs::clustered_by;
use crate::compare::{clusters, pair};
use crate::figures::{ClusteredAp, DetectorView, Scores};
use scaleproof_core::ap::ApDefinition;
use scaleproof_core::statistics::{Interval, interval_95};

/// Drop of AP of one detector and variant measured in another way, minus that in the usual way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovedDrop {
    pub by: f64,
    /// 95 % interval over resamples of the places and bins, the same for both ways.
    pub interval_95: Option<Interval>,
}

/// Returns the change of the drop for each detector, for a variant against the base. `usual` and `other` are of the same photos and detectors, in the
/// same order.
pub fn moved_drops(
    usual: &Scores,
    definition: ApDefinition,
    other: &Scores,
    other_definition: ApDefinition,
    base: &str,
    variant: &str,
) -> Vec<MovedDrop> {
    let cells = |scores| pair(Scores::set(scores), base, variant).0;
    let (own, others) = (cells(usual), cells(other));
    let by = clustered_by(&own);
    let own = clusters(&own.iter().collect::<Vec<_>>(), by);
    let others = clusters(&others.iter().collect::<Vec<_>>(), by);
    let count = own.len();
    let of = |(side, _)| {
        let (own, others) = (paired_ap(&own, side), paired_ap(&others, side));
        let drop = |[base, other]: &[ClusteredAp; 2], drawn: &[u32], definition| {
            base.of_draw(drawn, definition) - other.of_draw(drawn, definition)
        };
        let moved = |drawn: &[u32]| drop(&others, drawn, other_definition) - drop(&own, drawn, definition);
        MovedDrop {
            by: moved(&vec![1; count]),
            interval_95: interval_95(count, moved),
        }
    };
    DetectorView::each(&usual.detectors).map(of).collect()
}
