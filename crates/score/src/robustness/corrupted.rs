//! Comparisons of a run on photos that are corrupted.

use crate::error::ScoreError;
use crate::figures::{CorruptedRow, PairedDifference, Robustness, Scores, Survival};
use crate::observe::Options;
use crate::robustness::changes::changes;
use crate::robustness::{Condition, Corruption, Rerun, SEVERITIES};
use scaleproof_plot::distinct;

/// Runs the detectors on every photo of a run again, at each severity of each of these corruptions, and compares the variants with the base, and with
/// the random control where there is one. `None` where no photos pair. `on_photo` is called after each photo.
pub fn under_corruption(
    scores: &Scores,
    corruptions: &[Corruption],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Option<Robustness>, ScoreError> {
    let kinds = distinct(corruptions.iter().copied());
    let worse = kinds
        .iter()
        .flat_map(|kind| (1..=SEVERITIES).map(|severity| Condition::Worse(*kind, severity)));
    let rerun = Rerun::of(scores, worse, options, on_photo)?;
    rerun
        .map(|rerun| {
            let cautions = rerun.left_out(scores, "made worse");
            let changes = changes(scores, &rerun.photos, rerun.conditions.len(), options)?;
            Ok(together(&kinds, rerun.differences, changes, cautions))
        })
        .transpose()
}

/// Joins the rows of each corruption, the reduced photo before its severities. `compared`, `changes`: those of the reduced photo, then those of each
/// corruption's severities.
fn together(
    corruptions: &[Corruption],
    compared: Vec<Vec<PairedDifference>>,
    changes: Vec<Vec<PairedDifference>>,
    cautions: Vec<String>,
) -> Robustness {
    let mut compared = compared.into_iter();
    let clean = compared.next().unwrap_or_default();
    let (mut rows, mut survival) = (Vec::new(), Vec::new());
    let row = |kind: Corruption, severity: u8, difference: PairedDifference| CorruptedRow {
        corruption: kind.name(),
        severity,
        amount: kind.amount(severity),
        difference,
    };
    let steps = corruptions
        .iter()
        .flat_map(|kind| (1..=SEVERITIES).map(|severity| (*kind, severity)));
    let changes = steps.zip(changes.into_iter().skip(1));
    let changes = changes
        .flat_map(|((kind, severity), own)| own.into_iter().map(move |difference| row(kind, severity, difference)));
    let changes = changes.collect();
    for kind in corruptions {
        let start = rows.len();
        let row = |severity, difference| row(*kind, severity, difference);
        rows.extend(clean.iter().cloned().map(|difference| row(0, difference)));
        for (severity, worse) in (1..=SEVERITIES).zip(compared.by_ref()) {
            rows.extend(worse.into_iter().map(|difference| row(severity, difference)));
        }
        let own: &[CorruptedRow] = &rows[start..];
        let same = |first: &CorruptedRow| {
            Survival::of(first, own.iter().filter(|row| row.difference.is_as(&first.difference)))
        };
        survival.extend(own[..clean.len()].iter().map(same));
    }
    Robustness {
        rows,
        changes,
        survival,
        cautions,
    }
}
