//! Tables of the transfer of each texture's effect to other detectors.

use crate::figures::{TransferDrop, transfer};
use crate::report::Findings;
use crate::report::table::{Cell, Column, Table};
use crate::report::words::paired;
use scaleproof_core::spelling::digits;

/// Returns pattern × detector: the drop of AP@0.5, darker the larger it is, and that of the hit rate; a table for every `across` detectors. None
/// without a base to drop from.
pub(crate) fn transferred(findings: Findings, across: usize) -> Vec<Table> {
    let scores = findings.scores;
    let rows = transfer(&scores.summaries);
    if rows.is_empty() {
        return Vec::new();
    }
    let caption = format!("Transfer: drop from {}, pattern × detector", scores.base);
    let of_some = |(i, some): (usize, &[crate::evaluated::EvaluatedDetector])| {
        let titles = some.iter().map(|d| Column::numbers(&d.manifest.title));
        let mut table = Table::new(
            &caption,
            std::iter::once(Column::words("pattern")).chain(titles).collect(),
        );
        table.blocks.push(
            rows.iter()
                .map(|row| {
                    let own = row.detectors.iter().skip(i * across).take(across);
                    let cells = own.map(|drop| cell(findings, &row.variant, drop));
                    std::iter::once(Cell::text(&row.variant)).chain(cells).collect()
                })
                .collect(),
        );
        let note = "Drop of AP@0.5, the darker the larger; in brackets that of the hit rate; bold: an effect is shown on paired photos";
        table.notes.push(note.to_owned());
        table
    };
    scores.detectors.chunks(across).enumerate().map(of_some).collect()
}

fn cell(findings: Findings, variant: &str, drop: &TransferDrop) -> Cell {
    let compared = findings.compared(&drop.detector, variant);
    Cell::number(drop.drop.ap50, 3)
        .shaded(drop.drop.ap50)
        .strong(compared.is_some_and(paired::is_confidence_shown))
        .with_remark(Some(format!("hits {}", digits(drop.drop.hit_rate, 2))))
}
