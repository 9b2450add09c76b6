//! A comparison for the terminal.

use crate::figures::{Compared, Comparison, Difference, Scores};
use crate::report::text::screen::on_screen;
use crate::report::words::{certainty, counted, paired, paper, verdict};
use crate::report::{Findings, tables};
use scaleproof_core::spelling::digits;

/// Returns a comparison for the terminal: deviations from its plan; a sentence on the findings for each texture, and what they rest on; a line for
/// each detector and texture; the looks of a sequential test.
pub fn comparison_table(scores: &Scores, comparison: &Comparison) -> String {
    let findings = Findings::of_comparison(scores, comparison);
    let mut lines = Vec::new();
    if let Some(plan) = &comparison.plan {
        lines.push(format!("plan {}: {}", plan.seal, paired::deviations(plan)));
        lines.extend(plan.deviations.iter().map(|deviation| format!("  {deviation}")));
    }
    lines.extend(verdict::sentences(findings));
    lines.extend(verdict::basis(findings));
    lines.push(String::new());
    lines.extend(on_screen(&tables::effects(findings)));
    if let Some(own) = &comparison.sequential {
        lines.push(String::new());
        lines.extend(tables::looks(scores, own).described());
    }
    lines.join("\n")
}

/// Returns the parts of a comparison that the screen leaves out: sentences for a paper, the drop of each figure with its interval, how effects were
/// decided, and the labels that count as the model.
pub fn further_comparison(scores: &Scores, comparison: &Comparison) -> String {
    let findings = Findings::of_comparison(scores, comparison);
    let mut lines = paper::sentences(findings);
    lines.push(String::new());
    let control = comparison.control.iter().flat_map(|control| &control.results);
    for r in comparison.results.iter().chain(control) {
        let head = format!("{}: {} → {}", r.detector, comparison.base, r.variant);
        let words = match &comparison.control {
            Some(control) if control.variant == r.variant => "the control".to_owned(),
            _ => paired::effect_sentence(r, &comparison.base),
        };
        lines.push(format!("{head}, {}: {words}", paired::basis(r)));
        lines.push(line("mean confidence", r, &r.mean_confidence));
        lines.push(line("hit rate", r, &r.hit_rate.rate));
        lines.push(line(&format!("AP@0.5 ({})", comparison.ap_definition), r, &r.ap50));
    }
    lines.extend(certainty::tested(findings));
    if let Some(protocol) = scores.criteria.protocol {
        lines.push(format!("protocol {}: {}", protocol.name(), protocol.source()));
    }
    lines.push(format!("counts as the model: {}", counted::counted(scores)));
    lines.join("\n")
}

fn line(name: &str, r: &Compared, d: &Difference) -> String {
    let interval = paired::interval(d, two).unwrap_or_else(|| "no interval".to_owned());
    let [base, other, drop] = [d.base, d.other, d.drop].map(|v| digits(v, 3));
    let asr = certainty::asr_text(r, d, two);
    format!("  {name:<24} {base} → {other}, drop {drop} {interval}, ASR {asr}")
}

fn two(value: f64) -> String {
    digits(value, 2)
}
