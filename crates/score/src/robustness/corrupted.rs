//! Comparisons of a run on photos that are corrupted.

use crate::error::ScoreError;
use crate::figures::{CorruptedRow, Held, Robustness, Scores, Survival};
use crate::observe::Options;
use crate::robustness::SEVERITIES;
use crate::robustness::changes::changes;
use crate::robustness::condition::Condition;
use crate::robustness::corrupt::Corruption;
use crate::robustness::rerun::Again;
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
    let again = Again::of(scores, worse, options, on_photo)?;
    again
        .map(|again| {
            let cautions = again.left_out(scores, "made worse");
            let changes = changes(scores, &again.photos, again.conditions.len(), options)?;
            Ok(together(&kinds, again.held, changes, cautions))
        })
        .transpose()
}

/// Joins the rows of each corruption, the reduced photo before its severities. `compared`, `changes`: those of the reduced photo, then those of each
/// corruption's severities.
fn together(
    corruptions: &[Corruption],
    compared: Vec<Vec<Held>>,
    changes: Vec<Vec<Held>>,
    cautions: Vec<String>,
) -> Robustness {
    let mut compared = compared.into_iter();
    let clean = compared.next().unwrap_or_default();
    let (mut rows, mut survival) = (Vec::new(), Vec::new());
    let row = |kind: Corruption, severity: u8, held: Held| CorruptedRow {
        corruption: kind.name(),
        severity,
        amount: kind.amount(severity),
        held,
    };
    let steps = corruptions
        .iter()
        .flat_map(|kind| (1..=SEVERITIES).map(|severity| (*kind, severity)));
    let changes = steps.zip(changes.into_iter().skip(1));
    let changes =
        changes.flat_map(|((kind, severity), own)| own.into_iter().map(move |held| row(kind, severity, held)));
    let changes = changes.collect();
    for kind in corruptions {
        let start = rows.len();
        let row = |severity, held| row(*kind, severity, held);
        rows.extend(clean.iter().cloned().map(|held| row(0, held)));
        for (severity, worse) in (1..=SEVERITIES).zip(compared.by_ref()) {
            rows.extend(worse.into_iter().map(|held| row(severity, held)));
        }
        let own: &[CorruptedRow] = &rows[start..];
        let same = |first: &CorruptedRow| Survival::of(first, own.iter().filter(|row| row.held.is_as(&first.held)));
        survival.extend(own[..clean.len()].iter().map(same));
    }
    Robustness {
        rows,
        changes,
        survival,
        cautions,
    }
}
