//! Screen of a scoring run: the verdict, one table, and on request the rest.

use crate::figures::{Scores, disagreements};
use crate::report::RunReport;
use crate::report::text::screen::on_screen;
use crate::report::words::{certainty, counted, paper, truth_boxes, verdict};

/// Returns the screen of a run: a sentence on the findings for each texture; what they rest on; a line for each detector and texture. Below stand the
/// tables of options: a protocol's, by condition, of photos corrupted or defended, the order of the textures.
pub fn summary_table(scores: &Scores) -> String {
    let RunReport { findings, tables, .. } = RunReport::new(scores, None);
    let mut lines = verdict::sentences(findings);
    lines.extend(verdict::basis(findings));
    lines.extend(Some(String::new()).filter(|_| !lines.is_empty()));
    lines.extend(on_screen(tables.main(findings)));
    for table in tables.on_request() {
        lines.push(String::new());
        lines.extend(table.described());
    }
    lines.join("\n")
}

/// Returns the parts that the screen leaves out: the other tables, where AP and hits disagree and why, how effects were decided, sentences for a
/// paper, and the labels that count as the model.
pub fn further_tables(scores: &Scores) -> String {
    let RunReport { findings, tables, .. } = RunReport::new(scores, None);
    let mut lines = Vec::new();
    for table in [tables.figures, tables.outcomes, tables.papers] {
        lines.extend(table.described());
        lines.push(String::new());
    }
    lines.extend(disagreements(scores).into_iter().map(|sentence| sentence + "."));
    lines.extend(certainty::tested(findings).map(|sentence| sentence + "."));
    lines.extend(paper::sentences(findings));
    lines.push(format!("counts as the model: {}", counted::counted(scores)));
    lines.push(format!(
        "AP@0.5: {} ({}); a hit: {}",
        scores.criteria.ap.name(),
        scores.criteria.ap.meaning(),
        scores.criteria.hit()
    ));
    lines.push(format!("truth boxes: {}", truth_boxes(scores)));
    lines.join("\n")
}
