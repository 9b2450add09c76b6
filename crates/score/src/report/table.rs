//! The headline figures as plain text for the terminal.

use super::{certainty, counted, defences, paired, protocol, ranking, robustness, verdict};
use crate::score::{
    Compared, ConditionFigures, Difference, Drop, Scores, Summary, disagreements, paired as all_paired, protocol_table,
};
use scaleproof_core::spelling::digits;
use scaleproof_plot::distinct;

/// What was found, in a sentence; a line per detector: AP@0.5, hit rate and mean confidence of every variant. Below it what became of the misses, the figures that papers
/// compare, the drops from the base with what the pairs say of them, the groups and the protocol that were asked for, and which labels
/// count as the model.
pub fn summary_table(scores: &Scores) -> String {
    let headline = format!("AP@0.5 ({}) / hits / mean confidence", scores.criteria.ap.name());
    let mut lines = verdict::sentences(scores, all_paired(scores), &scores.base);
    lines.extend(by_detector(scores, &headline, headline_cell));
    let explained = disagreements(scores).into_iter();
    lines.extend(explained.map(|sentence| format!("  {sentence}")));
    let misses = "misclassified / disappeared / hallucinations per image";
    let comparable = "AP@[.5:.95] / mAR / mAR 50 / false positives per image";
    for (what, cell) in [
        (misses, misses_cell as fn(&Summary) -> String),
        (comparable, comparable_cell),
    ] {
        lines.push(String::new());
        lines.extend(by_detector(scores, what, cell));
    }
    lines.extend(drops(scores));
    lines.extend(certainty::tested(scores, all_paired(scores)));
    lines.extend(groups(scores));
    if let Some(table) = protocol_table(scores) {
        lines.push(String::new());
        lines.extend(protocol::lines(scores, &table));
    }
    lines.extend(robustness::lines(scores));
    lines.extend(defences::lines(scores));
    lines.extend(ranking::lines(scores));
    lines.push(String::new());
    lines.push(format!("counts as the model: {}", counted(scores)));
    lines.join("\n")
}

/// Width of the columns but the first.
const WIDTH: usize = 34;

/// Width of the detectors' column: their longest name, 14 at least.
fn names_width(scores: &Scores) -> usize {
    let names = scores.summaries.iter().map(|s| s.detector.chars().count());
    names.fold(14, usize::max)
}

/// A heading with the variants, then a line per detector.
fn by_detector(scores: &Scores, what: &str, cell: fn(&Summary) -> String) -> Vec<String> {
    let detectors = scores.summaries.chunk_by(|a, b| a.detector == b.detector);
    let widths = (names_width(scores), WIDTH);
    let mut lines = vec![what.to_owned()];
    for (i, own) in detectors.enumerate() {
        if i == 0 {
            lines.push(line("detector", own.iter().map(|s| s.variant.clone()), widths));
        }
        lines.push(line(&own[0].detector, own.iter().map(cell), widths));
    }
    lines
}

/// Cells of these widths, the first and the others.
pub(super) fn line(first: &str, cells: impl Iterator<Item = String>, (head, width): (usize, usize)) -> String {
    let cells: String = cells.map(|cell| format!("  {cell:<width$}")).collect();
    format!("{first:<head$}{cells}").trim_end().to_owned()
}

fn headline_cell(s: &Summary) -> String {
    let f = &s.overall;
    let share = digits(100.0 * f.hit_rate.rate, 0);
    let hits = format!("{}/{} ({share} %)", f.hit_rate.count, f.photos);
    format!("{} / {hits} / {}", digits(f.ap50, 3), digits(f.mean_confidence, 2))
}

fn misses_cell(s: &Summary) -> String {
    let f = &s.overall;
    let (other, gone) = (f.misclassification_rate.count, f.disappearance_rate.count);
    format!("{other} / {gone} / {}", digits(f.hallucinations_per_image, 2))
}

fn comparable_cell(s: &Summary) -> String {
    let f = &s.overall;
    let averages = [f.ap50_95, f.mar, f.mar50].map(|v| digits(v, 3)).join(" / ");
    format!("{averages} / {}", digits(f.false_positives_per_image, 2))
}

/// For each variant but the base, and each detector: drops, what the pairs say of them, and attack success rates.
fn drops(scores: &Scores) -> Vec<String> {
    let mut lines = Vec::new();
    let dropped = |variant: &&str| {
        scores
            .summaries
            .iter()
            .any(|s| s.variant == *variant && s.drop.is_some())
    };
    for variant in scores.variants().into_iter().filter(dropped) {
        let own = || scores.summaries.iter().filter(|s| s.variant == variant);
        let paired = |s: &Summary| paired::compared(scores, &s.detector, variant);
        let basis = own()
            .find_map(paired)
            .map_or("no photos pair".to_owned(), paired::basis);
        lines.push(String::new());
        lines.push(format!(
            "drop from {} to {variant} [95 %], and attack success rate (ASR); {basis}",
            scores.base
        ));
        for (s, drop) in own().filter_map(|s| Some((s, s.drop?))) {
            lines.extend(drop_lines(scores, s, &drop, paired(s)));
        }
    }
    lines
}

fn drop_lines(scores: &Scores, s: &Summary, drop: &Drop, compared: Option<&Compared>) -> Vec<String> {
    let width = names_width(scores);
    let said = |overall: f64, of: fn(&Compared) -> &Difference| {
        compared.map_or_else(
            || format!("{}, over all photos: not paired", digits(overall, 3)),
            |r| {
                let (d, number) = (of(r), |v: f64| digits(v, 2));
                let interval = paired::interval(d, number).unwrap_or_else(|| "no interval".into());
                format!(
                    "{} {interval}; ASR {}",
                    digits(d.drop, 3),
                    certainty::asr_text(r, d, number)
                )
            },
        )
    };
    let line = |head: &str, name: &str, said: String| format!("{head:<width$}  {name:<10}  {said}");
    let effect = compared.map(|r| line(&s.detector, "effect", paired::in_words(r, &scores.base)));
    let head = if effect.is_some() { "" } else { &s.detector };
    let figures = [
        line(head, "confidence", said(drop.mean_confidence, |r| &r.mean_confidence)),
        line("", "hit rate", said(drop.hit_rate, |r| &r.hit_rate.rate)),
        line("", "AP@0.5", said(drop.ap50, |r| &r.ap50)),
    ];
    effect.into_iter().chain(figures).collect()
}

/// A line for each value of a condition and variant, a column for each detector.
fn groups(scores: &Scores) -> Vec<String> {
    let names = scores.detectors.iter().map(|d| d.manifest.name.clone());
    let heads = ["condition", "value", "texture"].map(str::to_owned);
    let mut rows: Vec<Vec<String>> = vec![heads.into_iter().chain(names).collect()];
    let all = scores.summaries.iter().flat_map(|s| &s.conditions);
    for (condition, value) in distinct(all.map(|c| (&c.condition, &c.value))) {
        let is_own = |c: &&ConditionFigures| c.condition == *condition && c.value == *value;
        for variant in scores.variants() {
            let own = scores.summaries.iter().filter(|s| s.variant == variant);
            let cells = own.map(|s| s.conditions.iter().find(is_own).map_or("–".to_owned(), group_cell));
            let head = [condition.clone(), value.clone(), variant.to_owned()];
            rows.push(head.into_iter().chain(cells).collect());
        }
    }
    if rows.len() == 1 {
        return Vec::new();
    }
    let heading = [String::new(), "by condition: AP@0.5 / hits".to_owned()];
    heading
        .into_iter()
        .chain(protocol::aligned(&rows.iter().collect::<Vec<_>>()))
        .collect()
}

fn group_cell(c: &ConditionFigures) -> String {
    let f = &c.figures;
    let ap50 = if f.photos > 1 {
        digits(f.ap50, 3)
    } else {
        "–".to_owned()
    };
    format!("{ap50} / {}/{}", f.hit_rate.count, f.photos)
}
