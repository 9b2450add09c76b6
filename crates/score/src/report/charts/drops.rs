//! Charts of drops with their intervals and numbers, a row for each detector and texture.

use crate::figures::{Compared, Comparison, Difference, Scores};
use crate::report::Findings;
use crate::report::charts::intervals;
use crate::report::words::{certainty, number, paired};
use scaleproof_plot::Anchor::{End, Middle, Start};
use scaleproof_plot::{BLACK, Drawing, FAINT, INK, Mark, NOTE, WHITE};

const PLOT: f64 = 300.0;
const LEFT: f64 = 200.0;
const ROW: f64 = 31.0;
const WIDTH: f64 = 1060.0;

/// One figure of a comparison: its name, the title of its chart, its difference, and whether it is shown to change.
pub(crate) struct Figure {
    pub name: &'static str,
    pub title: &'static str,
    pub of: fn(&Compared) -> &Difference,
    pub is_shown: fn(&Compared) -> bool,
}

pub(crate) const FIGURES: [Figure; 2] = [
    Figure {
        name: "hit rate",
        title: "Drop of the hit rate",
        of: |r| &r.hit_rate.rate,
        is_shown: paired::is_hit_rate_shown,
    },
    Figure {
        name: "AP@0.5",
        title: "Drop of AP@0.5",
        of: |r| &r.ap50,
        is_shown: |_| false,
    },
];

pub(crate) fn charts(scores: &Scores, comparison: &Comparison) -> Vec<(&'static str, Drawing)> {
    let first = (
        "Drop of the mean confidence",
        intervals::chart(Findings::of_comparison(scores, comparison)),
    );
    let others = FIGURES
        .iter()
        .map(|figure| (figure.title, forest(scores, comparison, figure)));
    std::iter::once(first).chain(others).collect()
}

/// Draws a row for each detector and texture: the drop on an axis from −1 to 1, and in numbers.
pub(crate) fn forest(scores: &Scores, comparison: &Comparison, figure: &Figure) -> Drawing {
    let Figure {
        name,
        title,
        of,
        is_shown,
    } = figure;
    let height = ROW * comparison.results.len() as f64;
    let x = |drop: f64| LEFT + (drop.clamp(-1.0, 1.0) + 1.0) / 2.0 * PLOT;
    let mut marks = Vec::new();
    for tick in [-1.0, -0.5, 0.0, 0.5, 1.0] {
        let colour = if tick == 0.0 { INK } else { FAINT };
        let (x, name) = (x(tick), number(tick, 1));
        marks.push(Mark::line([x, 0.0], [x, height], colour));
        marks.push(Mark::text([x, height + 15.0], 11.0, Middle, NOTE, name));
    }
    for (i, r) in comparison.results.iter().enumerate() {
        let (d, y) = (of(r), ROW * (i as f64 + 0.5));
        let name_of_row = format!("{}, {}", scores.title(&r.detector), r.variant);
        let title = format!("{name_of_row}: drop, {name}, {}", number(d.drop, 3));
        let ends = d.interval_95.map(|i| [x(i.low), x(i.high)]);
        let line = ends.map(|[low, high]| Mark::line([low, y], [high, y], INK).outlined(INK, 1.6));
        let dot = Mark::circle([x(d.drop), y], 4.2).filled(if is_shown(r) { INK } else { WHITE });
        let both = line.into_iter().chain([dot.outlined(INK, 1.4)]).collect();
        marks.push(Mark::text([LEFT - 10.0, y + 4.0], 12.0, End, BLACK, name_of_row));
        marks.push(Mark::group([0.0; 2], both).titled(title));
        let right = LEFT + PLOT + 16.0;
        marks.push(Mark::text([right, y], 11.5, Start, BLACK, numbers(d)));
        if d.asr.is_some() && d.asr_interval_95.is_none() {
            let why = format!("ASR: {}", certainty::without_interval(r, d));
            marks.push(Mark::text([right, y + 12.0], 9.5, Start, NOTE, why));
        }
    }
    Drawing {
        area: [0.0, -4.0, WIDTH, height + 26.0],
        label: (*title).to_owned(),
        marks,
    }
}

fn numbers(d: &Difference) -> String {
    let two = |v: f64| number(v, 2);
    let interval = paired::interval(d, two).map_or(String::new(), |i| format!(" {i}"));
    let asr = paired::asr(d, two);
    let [base, other, drop] = [d.base, d.other, d.drop].map(|v| number(v, 2));
    format!("{base} → {other}, {drop}{interval}, ASR {asr}")
}
