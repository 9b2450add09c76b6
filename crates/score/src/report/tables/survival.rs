//! Table of the severities up to which each drop holds on corrupted photos.

use crate::figures::{BASE_LOST, Robustness, Survival};
use crate::report::table::{Cell, Column, Table};
use crate::robustness::SEVERITIES;
use scaleproof_plot::distinct;

/// Returns a row for each detector and comparison, a column for each corruption: the severities at which the drop of AP@0.5 lies above 0.
pub(crate) fn survival(robustness: &Robustness) -> Table {
    let corruptions = robustness.corruptions();
    let names = ["detector", "texture", "from"].map(Column::words);
    let columns = names
        .into_iter()
        .chain(corruptions.iter().map(|name| Column::words(name)));
    let caption = format!(
        "On photos made worse: severities at which the 95 % interval of the drop of AP@0.5 lies above 0, uncorrected (0: reduced to 640 px, no worse; ?: too few photos for an \
         interval; lost: the base itself has an AP below {BASE_LOST} there)"
    );
    let mut table = Table::new(&caption, columns.collect());
    let key = |s: &Survival| [s.detector.clone(), s.variant.clone(), s.base.clone()];
    let rows = distinct(robustness.survival.iter().map(key)).into_iter().map(|names| {
        let own = |corruption: &&str| {
            let mut all = robustness.survival.iter();
            all.find(|s| s.corruption == *corruption && key(s) == names)
        };
        let cells = corruptions
            .iter()
            .map(|corruption| own(corruption).map_or_else(|| Cell::text(""), cell));
        names.clone().map(Cell::text).into_iter().chain(cells).collect()
    });
    table.blocks.push(rows.collect());
    table
}

/// Returns a cell as in `0–2, lost 4–5`.
fn cell(survival: &Survival) -> Cell {
    let shown = match (&survival.above_zero_at[..], survival.without_interval_at.len()) {
        ([], too_few) if too_few > usize::from(SEVERITIES) => "?".to_owned(),
        ([], _) => "none".to_owned(),
        (shown, _) => ranges(shown),
    };
    Cell::text(match &survival.base_lost_at[..] {
        [] => shown,
        lost => format!("{shown}, lost {}", ranges(lost)),
    })
}

/// Writes ascending numbers as in `0–2, 4`.
fn ranges(numbers: &[u8]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let text = runs.map(|run| match run {
        [only] => only.to_string(),
        run => format!("{}–{}", run[0], run[run.len() - 1]),
    });
    text.collect::<Vec<_>>().join(", ")
}
