//! The drop of the mean confidence of each detector: a dot and a whisker for each texture.

use maud::{Markup, html};

use super::{colour, round};
use crate::report::{number, paired};
use crate::score::{Compared, Scores};
use scaleproof_plot::{Drawing, distinct};

const LEFT: f64 = 170.0;
const PLOT: f64 = 560.0;
const RIGHT: f64 = 200.0;
/// Of a texture in a detector's row.
const LINE: f64 = 17.0;
const GAP: f64 = 9.0;
/// Below the last row: numbers and title of the axis.
const AXIS: f64 = 34.0;

/// What the marks mean.
pub(in crate::report) const MARKS: &str =
    "Dot: drop of the mean confidence from the base; whisker: its 95 % interval; filled: a change is shown";

/// The chart with its legend.
pub(super) fn figure(scores: &Scores, results: &[Compared], base: &str) -> Markup {
    let textures = textures(results);
    html! {
        ul.legend {
            @for texture in &textures { li { i style=(format!("background:{}", colour_of(scores, texture))) {} (texture) } }
            li.note { (MARKS) "." }
        }
        div.scroll { (chart(scores, results, base).inline(Some("intervals"))) }
    }
}

fn textures(results: &[Compared]) -> Vec<&str> {
    distinct(results.iter().map(|r| r.variant.as_str()))
}

fn colour_of(scores: &Scores, texture: &str) -> &'static str {
    colour(
        scores
            .variants()
            .iter()
            .position(|variant| *variant == texture)
            .unwrap_or_default(),
    )
}

/// A row for each detector, below each other a line for each texture.
pub(in crate::report) fn chart(scores: &Scores, results: &[Compared], base: &str) -> Drawing {
    let textures = textures(results);
    let row = LINE * textures.len() as f64 + GAP;
    let height = row * scores.detectors.len() as f64;
    let [low, high] = ends(results);
    let x = |drop: f64| round(LEFT + (drop - low) / (high - low) * PLOT);
    let steps = ((high - low) / STEP).round() as usize;
    let marks = html! {
        @for tick in (0..=steps).map(|step| low + STEP * step as f64) {
            line x1=(x(tick)) x2=(x(tick)) y2=(height) stroke=(if tick == 0.0 { "#1b1f24" } else { "#d7dce2" }) {}
            text x=(x(tick)) y=(height + 14.0) font-size="11" text-anchor="middle" fill="#5b6573" { (number(tick, 2)) }
        }
        text x=(LEFT + PLOT / 2.0) y=(height + 29.0) font-size="11.5" text-anchor="middle" { "drop of the mean confidence from " (paired::named_base(base)) }
        @for (i, detector) in scores.detectors.iter().enumerate() {
            @let top = row * i as f64;
            text x=(LEFT - 10.0) y=(top + row / 2.0 + 4.0) font-size="12.5" text-anchor="end" { (detector.manifest.title) }
            @for (j, texture) in textures.iter().enumerate() {
                @let y = top + GAP / 2.0 + LINE * (j as f64 + 0.5);
                @if let Some(r) = results.iter().find(|r| r.detector == detector.manifest.name && r.variant == *texture) {
                    (line(scores, r, base, y, &x))
                }
            }
        }
    };
    Drawing {
        area: [0.0, -4.0, LEFT + PLOT + RIGHT, height + AXIS],
        label: "Drop of the mean confidence of each detector, with 95 % intervals".to_owned(),
        marks,
    }
}

fn line(scores: &Scores, r: &Compared, base: &str, y: f64, x: &dyn Fn(f64) -> f64) -> Markup {
    let (d, colour) = (&r.mean_confidence, colour_of(scores, &r.variant));
    let is_shown = r.effect().is_shown();
    html! {
        g.drop {
            title { (scores.title(&r.detector)) ", " (r.variant) ": drop " (number(d.drop, 3)) "; " (paired::in_words(r, base)) }
            @if let Some(interval) = d.interval_95 {
                line x1=(x(interval.low)) x2=(x(interval.high)) y1=(y) y2=(y) stroke=(colour) stroke-width="2" {}
            }
            circle cx=(x(d.drop)) cy=(y) r="4.6" stroke=(colour) stroke-width="1.8" fill=(if is_shown { colour } else { "#fff" }) {}
        }
        text x=(LEFT + PLOT + 12.0) y=(y + 4.0) font-size="11.5" fill=(if is_shown { colour } else { "#5b6573" }) { (paired::word(r)) }
    }
}

/// Between two lines of the grid.
const STEP: f64 = 0.25;

/// The ends of the axis: steps that hold every interval, 0 and a drop of 0.5.
fn ends(results: &[Compared]) -> [f64; 2] {
    let all = results.iter().flat_map(|r| {
        let d = &r.mean_confidence;
        let interval = d.interval_95.map(|i| [i.low, i.high]);
        [d.drop, d.drop].into_iter().chain(interval.into_iter().flatten())
    });
    let (low, high) = all.fold((0.0_f64, 0.5_f64), |(low, high), v| (low.min(v), high.max(v)));
    [(low / STEP).floor() * STEP, (high / STEP).ceil() * STEP]
}
