//! The headline figures as plain text for the terminal.

use super::counted;
use crate::score::{BASE_VARIANT, Scores, Summary, TransferDrop, transfer};

/// A line per detector: AP@0.5, hit rate and mean confidence of every variant. Below it what became of the misses, and
/// the drops from the base as a matrix pattern × detector, and which labels count as the model.
pub fn summary_table(scores: &Scores) -> String {
    let headline = format!("AP@0.5 ({}) / hits / mean confidence", scores.criteria.ap.name());
    let mut lines = by_detector(scores, &headline, headline_cell);
    lines.push(String::new());
    lines.extend(by_detector(
        scores,
        "misclassified / disappeared / hallucinations per image",
        misses_cell,
    ));
    let rows = transfer(&scores.summaries);
    if !rows.is_empty() {
        lines.push(String::new());
        let heading = format!("drop from {BASE_VARIANT}: AP@0.5 / hit rate");
        let names = scores.detectors.iter().map(|c| c.manifest.name.as_str());
        lines.push(line(&heading, names.map(str::to_owned), TRANSFER_WIDTHS));
    }
    for row in rows {
        lines.push(line(&row.variant, row.detectors.iter().map(drop_cell), TRANSFER_WIDTHS));
    }
    lines.push(String::new());
    lines.push(format!("counts as the model: {}", counted(scores)));
    lines.join("\n")
}

/// Widths of the first column and of the others.
const WIDTHS: (usize, usize) = (14, 34);
const TRANSFER_WIDTHS: (usize, usize) = (36, 16);

/// A heading with the variants, then a line per detector.
fn by_detector(scores: &Scores, what: &str, cell: fn(&Summary) -> String) -> Vec<String> {
    let detectors = scores.summaries.chunk_by(|a, b| a.detector == b.detector);
    let mut lines = vec![what.to_owned()];
    for (i, own) in detectors.enumerate() {
        if i == 0 {
            lines.push(line("detector", own.iter().map(|s| s.variant.clone()), WIDTHS));
        }
        lines.push(line(&own[0].detector, own.iter().map(cell), WIDTHS));
    }
    lines
}

fn line(first: &str, cells: impl Iterator<Item = String>, (head, width): (usize, usize)) -> String {
    let cells: String = cells.map(|cell| format!("  {cell:<width$}")).collect();
    format!("{first:<head$}{cells}").trim_end().to_owned()
}

fn headline_cell(s: &Summary) -> String {
    let f = &s.overall;
    let hits = format!("{}/{} ({:.0} %)", f.hit_rate.count, f.photos, 100.0 * f.hit_rate.rate);
    format!("{:.3} / {hits} / {:.2}", f.ap50, f.mean_confidence)
}

fn misses_cell(s: &Summary) -> String {
    let f = &s.overall;
    let (other, gone) = (f.misclassification_rate.count, f.disappearance_rate.count);
    format!("{other} / {gone} / {:.2}", f.hallucinations_per_image)
}

fn drop_cell(d: &TransferDrop) -> String {
    format!("{:.3} / {:.2}", d.drop.ap50, d.drop.hit_rate)
}
