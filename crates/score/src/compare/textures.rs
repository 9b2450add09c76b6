//! Every variant of a run against its base, and against a control.

use crate::compare::decide::decide_among;
use crate::compare::differences::compared;
use crate::compare::{CompareError, pair, pairs, some_pairs};
use crate::evaluated::EvaluatedDetector;
use crate::figures::{Compared, Comparison, Control, DetectorView, ScoredPhoto, ScoredSet, Scores, variants};
use scaleproof_core::ap::ApDefinition;
use scaleproof_core::statistics::{DRAWS, SEED};

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

/// Compares these variants with `base` by intervals alone: nothing is tested until [`decide`](crate::decide).
pub fn compare_with(
    scores: &Scores,
    base: &str,
    others: &[&str],
    definition: ApDefinition,
) -> Result<Comparison, CompareError> {
    compare_set(scores.set(), base, others, definition)
}

/// Returns the variants but for the base and the control, of which there must be one.
pub(crate) fn others<'a>(scores: &Scores, all: &'a [String], base: &str) -> Result<Vec<&'a str>, CompareError> {
    let all = all.iter().map(String::as_str);
    let others: Vec<&str> = all.filter(|v| is_texture(scores, base, v)).collect();
    let none = || CompareError::NothingElse { base: base.into() };
    (!others.is_empty()).then_some(others).ok_or_else(none)
}

/// Returns the pairs of photos of two variants that are compared.
pub fn paired_photos<'a>(scores: &'a Scores, base: &str, variant: &str) -> Vec<(&'a ScoredPhoto, &'a ScoredPhoto)> {
    let (cells, _) = pair(scores.set(), base, variant);
    cells.into_iter().flat_map(|cell| cell.pairs).collect()
}

/// Compares these variants of a scored set with `base` by intervals alone.
pub(crate) fn compare_set(
    set: ScoredSet,
    base: &str,
    others: &[&str],
    definition: ApDefinition,
) -> Result<Comparison, CompareError> {
    let (mut results, mut unpaired) = (Vec::new(), Vec::new());
    for variant in others {
        let (cells, left_over) = some_pairs(set, base, variant)?;
        unpaired.extend(left_over);
        for (side, detector) in DetectorView::each(set.detectors) {
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
