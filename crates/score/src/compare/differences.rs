//! Differences of one detector's figures between the photos of two variants, with their intervals.

use std::collections::BTreeSet;

use crate::compare::pairs::Cluster;
use crate::compare::{Cell, Pair, clusters};
use crate::figures::{
    BinHits, ClusteredAp, ClusteredBy, Compared, DetectorView, Difference, Hits, PairedView, ScoredPhoto, Sums,
};
use scaleproof_core::ap::ApDefinition;
use scaleproof_core::statistics::intervals_95;

pub(crate) fn compared(
    detector: String,
    variant: &str,
    cells: &[Cell],
    side: DetectorView,
    definition: ApDefinition,
) -> Compared {
    let all = clusters(&cells.iter().collect::<Vec<_>>(), ClusteredBy::PlaceAndBin);
    Compared {
        detector,
        variant: variant.to_owned(),
        pairs: pairs_in(&all),
        near_copies: copies_in(&all),
        places: cells.iter().map(|c| c.place).collect::<BTreeSet<_>>().len(),
        bins: cells.iter().map(|c| c.bin).collect::<BTreeSet<_>>().len(),
        clusters: all.len(),
        finding: None,
        mean_confidence: of_means(&all, |photo| side.outcome(photo).confidence),
        hit_rate: hits(&all, side),
        ap50: of_ap(&all, side, definition),
        azimuth_bins: by_azimuth(cells, side),
        views: cells.iter().map(|cell| view(cell, side)).collect(),
    }
}

pub(crate) fn view(cell: &Cell, side: DetectorView) -> PairedView {
    let sums = |pairs: &[&Pair]| {
        let lost =
            |figure: &dyn Fn(&ScoredPhoto) -> f64| pairs.iter().map(|(base, other)| figure(base) - figure(other)).sum();
        Sums {
            pairs: pairs.len(),
            confidence_lost: lost(&|photo| side.outcome(photo).confidence),
            hits_lost: lost(&|photo| side.hit(photo)),
        }
    };
    let pairs = || cell.pairs.iter();
    PairedView {
        place: cell.place.to_owned(),
        bin: cell.bin,
        all: sums(&pairs().collect::<Vec<_>>()),
        once: sums(
            &pairs()
                .filter(|(a, b)| a.repeat_of.is_none() && b.repeat_of.is_none())
                .collect::<Vec<_>>(),
        ),
    }
}

fn by_azimuth(cells: &[Cell], side: DetectorView) -> Vec<BinHits> {
    // Cells come in the order of their bins, azimuth first.
    let groups = cells.chunk_by(|a, b| a.bin.azimuth_deg == b.bin.azimuth_deg);
    let bin = |group: &[Cell]| {
        let own = clusters(&group.iter().collect::<Vec<_>>(), ClusteredBy::PlaceAndBin);
        BinHits {
            azimuth_deg: group[0].bin.azimuth_deg,
            pairs: pairs_in(&own),
            clusters: own.len(),
            hits: hits(&own, side),
        }
    };
    groups.map(bin).collect()
}

/// Counts the near-copies that count with the photos of some pairs.
fn copies_in(clusters: &[Cluster]) -> usize {
    let pairs = clusters.iter().flat_map(|c| &c.pairs);
    pairs.map(|(base, other)| base.near_copies + other.near_copies).sum()
}

fn pairs_in(clusters: &[Cluster]) -> usize {
    clusters.iter().map(|c| c.pairs.len()).sum()
}

fn hits(clusters: &[Cluster], side: DetectorView) -> Hits {
    let alone = |one: fn(bool, bool) -> bool| {
        let pairs = clusters.iter().flat_map(|c| &c.pairs);
        let is_hit = |photo| side.outcome(photo).is_hit();
        pairs.filter(|(base, other)| one(is_hit(base), is_hit(other))).count()
    };
    Hits {
        rate: of_means(clusters, |photo| side.hit(photo)),
        base_alone: alone(|base, other| base && !other),
        other_alone: alone(|base, other| !base && other),
    }
}

fn of_means(clusters: &[Cluster], figure: impl Fn(&ScoredPhoto) -> f64) -> Difference {
    let sum = |c: &Cluster| {
        let base = c.pairs.iter().map(|(photo, _)| figure(photo)).sum();
        let other = c.pairs.iter().map(|(_, photo)| figure(photo)).sum();
        (base, other, c.pairs.len() as f64)
    };
    let sums: Vec<(f64, f64, f64)> = clusters.iter().map(sum).collect();
    difference(clusters.len(), |drawn| {
        let total = |of: fn(&(f64, f64, f64)) -> f64| -> f64 {
            sums.iter().zip(drawn).map(|(s, times)| f64::from(*times) * of(s)).sum()
        };
        let photos = total(|s| s.2);
        (total(|s| s.0) / photos, total(|s| s.1) / photos)
    })
}

fn of_ap(clusters: &[Cluster], side: DetectorView, definition: ApDefinition) -> Difference {
    let ap = paired_ap(clusters, side);
    difference(clusters.len(), |drawn| {
        ap.each_ref().map(|ap| ap.of_draw(drawn, definition)).into()
    })
}

/// Returns the rankings behind the AP of both variants, for any draw of clusters.
pub(crate) fn paired_ap(clusters: &[Cluster], side: DetectorView) -> [ClusteredAp; 2] {
    let pairs = || {
        clusters
            .iter()
            .enumerate()
            .flat_map(|(i, c)| c.pairs.iter().map(move |pair| (pair, i)))
    };
    [
        side.clustered(pairs().map(|((base, _), i)| (*base, i))),
        side.clustered(pairs().map(|((_, other), i)| (*other, i))),
    ]
}

/// Computes the difference of a figure; `figures` returns it as (base, other) for the number of times that each cluster counts.
pub fn difference(clusters: usize, figures: impl Fn(&[u32]) -> (f64, f64)) -> Difference {
    let (base, other) = figures(&vec![1; clusters]);
    let [interval_95, asr_interval_95] = intervals_95(clusters, |drawn| {
        let (base, other) = figures(drawn);
        [base - other, 1.0 - other / base]
    });
    Difference {
        base,
        other,
        drop: base - other,
        interval_95,
        asr: (base > 0.0).then(|| 1.0 - other / base),
        asr_interval_95,
    }
}
