//! Two textures against each other on paired photos: differences with intervals, exact tests, and "too few photos to tell".

mod control;
mod decide;
mod detectable;
mod finding;
mod moved;
mod pairs;
mod plan;
mod result;
mod sequential;
mod sequential_plan;
mod spread;

pub use control::check_control;
use decide::decide_among;
pub(super) use decide::{LEVEL, decide_families};
pub use decide::{MOST_HIT, decide};
pub use finding::{Effect, Finding, InPlacesLikeThese};
pub use moved::moved_drops;
pub use plan::{PLAN_EXPERIMENTS, PLAN_SEED, PlanError, Question, ViewsNeeded};
pub use result::{
    BinHits, ClusteredBy, Compared, Comparison, Control, Course, Decision, Difference, Hits, PlanCheck, Sequential,
    SequentialFinding,
};
pub use sequential::{decide_by_looks, most_telling, sequential};
pub use sequential_plan::{Expected, SEQUENTIAL_ROWS, SequentialPlan, sequential_plan};
pub use spread::{FewViews, Observed, Spread, SpreadFrom};

use std::collections::BTreeSet;

use super::side::{ClusteredAp, Side};
use super::summary::variants;
use super::{EvaluatedDetector, NotScored, ScoredPhoto, ScoredSet, Scores};
use pairs::{Cell, Cluster, Pair, clusters, pair};
use result::{PairedView, Sums};
use scaleproof_core::ap::ApDefinition;
use scaleproof_core::statistics::{DRAWS, SEED, intervals_95};

/// Reason why nothing can be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    #[error("no photo has the variant `{base}`, only {variants}")]
    NoBase { base: String, variants: String },
    #[error("all photos have the variant `{base}`: add those of another texture")]
    NothingElse { base: String },
    #[error("no photo has the variant `{control}`, which is to be the control, only {variants}{hint}")]
    NoControl {
        control: String,
        variants: String,
        hint: String,
    },
    #[error("the control is the base itself, `{base}`: it has to be a second plain round, under another name{hint}")]
    ControlIsBase { base: String, hint: String },
    #[error("all photos have the variant `{base}` or that of its control, `{control}`: add those of a texture")]
    NothingBesideControl { base: String, control: String },
    #[error(
        "no photo of `{variant}` was taken from the same place and bin as one of `{base}`: they cannot be compared"
    )]
    NoPair { base: String, variant: String },
}

/// Compares every variant of a run with `base`. The run's control is none of the variants; effects no larger than its own are withheld.
pub fn compare(scores: &Scores, base: &str, definition: ApDefinition) -> Result<Comparison, CompareError> {
    let all = variants(&scores.photos, base);
    if all.iter().all(|v| v != base) {
        return Err(CompareError::NoBase {
            base: base.into(),
            variants: all.join(", "),
        });
    }
    let others = others(scores, &all, base)?;
    decided(scores, base, &others, definition)
}

fn decided(scores: &Scores, base: &str, others: &[&str], definition: ApDefinition) -> Result<Comparison, CompareError> {
    let mut comparison = compare_set(scores.set(), base, others, definition)?;
    if let Some(variant) = &scores.control {
        let own = compare_set(scores.set(), base, &[variant], definition)?;
        comparison.unpaired.extend(own.unpaired);
        comparison.control = Some(Control {
            variant: variant.clone(),
            results: own.results,
        });
    }
    let is_tested = |name: &str| {
        let named = |d: &&EvaluatedDetector| d.manifest.name == name;
        scores.detectors.iter().find(named).is_none_or(|d| d.is_tested)
    };
    decide_among(&mut comparison, is_tested);
    Ok(comparison)
}

/// Returns the comparisons of a run's variants with its base, for as many as can be paired, without the control.
pub fn paired(scores: &Scores) -> &[Compared] {
    compared_once(scores).map_or(&[], |comparison| &comparison.results)
}

/// Returns the comparisons of a run's control with its base.
pub fn paired_control(scores: &Scores) -> &[Compared] {
    // Without a control no comparison is needed.
    let own = scores
        .control
        .as_ref()
        .and_then(|_| compared_once(scores)?.control.as_ref());
    own.map_or(&[], |control| &control.results)
}

fn compared_once(scores: &Scores) -> Option<&Comparison> {
    let compared = scores.paired.get_or_init(|| {
        let (base, ap) = (&scores.base, scores.criteria.ap);
        let others = scores.variants().into_iter().filter(|v| is_texture(scores, base, v));
        let paired = others.filter(|other| pairs(scores.set(), base, other));
        decided(scores, base, &paired.collect::<Vec<_>>(), ap).ok()
    });
    compared.as_ref()
}

/// Returns true if a variant is neither the base nor the control.
fn is_texture(scores: &Scores, base: &str, variant: &str) -> bool {
    variant != base && scores.control.as_deref() != Some(variant)
}

/// Compares these variants with `base` by intervals alone: nothing is tested until [`decide`].
pub fn compare_with(
    scores: &Scores,
    base: &str,
    others: &[&str],
    definition: ApDefinition,
) -> Result<Comparison, CompareError> {
    compare_set(scores.set(), base, others, definition)
}

/// Returns the variants but for the base and the control, of which there must be one.
fn others<'a>(scores: &Scores, all: &'a [String], base: &str) -> Result<Vec<&'a str>, CompareError> {
    let all = all.iter().map(String::as_str);
    let others: Vec<&str> = all.filter(|v| is_texture(scores, base, v)).collect();
    let none = || CompareError::NothingElse { base: base.into() };
    (!others.is_empty()).then_some(others).ok_or_else(none)
}

/// Returns the pairs of two variants, of which there must be one, and the photos left over.
fn some_pairs<'a>(
    set: ScoredSet<'a>,
    base: &str,
    variant: &str,
) -> Result<(Vec<Cell<'a>>, Vec<NotScored>), CompareError> {
    let (cells, left_over) = pair(set, base, variant);
    if cells.is_empty() {
        let (base, variant) = (base.to_owned(), variant.to_owned());
        return Err(CompareError::NoPair { base, variant });
    }
    Ok((cells, left_over))
}

/// Returns the pairs of photos of two variants that are compared.
pub fn paired_photos<'a>(scores: &'a Scores, base: &str, variant: &str) -> Vec<(&'a ScoredPhoto, &'a ScoredPhoto)> {
    let (cells, _) = pair(scores.set(), base, variant);
    cells.into_iter().flat_map(|cell| cell.pairs).collect()
}

pub(super) fn pairs(set: ScoredSet, base: &str, other: &str) -> bool {
    !pair(set, base, other).0.is_empty()
}

/// Compares these variants of a scored set with `base` by intervals alone.
pub(super) fn compare_set(
    set: ScoredSet,
    base: &str,
    others: &[&str],
    definition: ApDefinition,
) -> Result<Comparison, CompareError> {
    let (mut results, mut unpaired) = (Vec::new(), Vec::new());
    for variant in others {
        let (cells, left_over) = some_pairs(set, base, variant)?;
        unpaired.extend(left_over);
        for (side, detector) in Side::each(set.detectors) {
            let name = detector.manifest.name.clone();
            results.push(compared(name, variant, &cells, side, definition));
        }
    }
    Ok(Comparison {
        base: base.to_owned(),
        ap_definition: definition.name(),
        bootstrap_draws: DRAWS,
        bootstrap_seed: SEED,
        results,
        control: None,
        unpaired,
        plan: None,
        sequential: None,
    })
}

fn compared(detector: String, variant: &str, cells: &[Cell], side: Side, definition: ApDefinition) -> Compared {
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

fn view(cell: &Cell, side: Side) -> PairedView {
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

fn by_azimuth(cells: &[Cell], side: Side) -> Vec<BinHits> {
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

fn hits(clusters: &[Cluster], side: Side) -> Hits {
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

fn of_ap(clusters: &[Cluster], side: Side, definition: ApDefinition) -> Difference {
    let ap = paired_ap(clusters, side);
    difference(clusters.len(), |drawn| {
        ap.each_ref().map(|ap| ap.of_draw(drawn, definition)).into()
    })
}

/// Returns the rankings behind the AP of both variants, for any draw of clusters.
fn paired_ap(clusters: &[Cluster], side: Side) -> [ClusteredAp; 2] {
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
