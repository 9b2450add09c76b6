//! Chart of the drop of the mean confidence of each detector: a dot and a whisker for each texture.

use crate::figures::{Compared, Scores};
use crate::report::Findings;
use crate::report::charts::colours::colour;
use crate::report::words::{number, paired};
use scaleproof_plot::Anchor::{End, Middle, Start};
use scaleproof_plot::{BLACK, Colour, Drawing, FAINT, INK, Mark, NOTE, WHITE, distinct};

const LEFT: f64 = 170.0;
const PLOT: f64 = 560.0;
const RIGHT: f64 = 200.0;
/// Height of a texture's line in a detector's row.
const LINE: f64 = 17.0;
const GAP: f64 = 9.0;
/// Height of the numbers and title of the axis, below the last row.
const AXIS: f64 = 38.0;

/// Explanation of the marks.
pub(crate) const MARKS: &str =
    "Dot: drop of the mean confidence from the base; whisker: its 95 % interval; filled: a change is shown";

/// Returns the colours of the textures, with their names.
pub(crate) fn legend(findings: Findings) -> Vec<(Colour, String)> {
    let all = textures(findings.results).into_iter();
    all.map(|texture| (colour_of(findings.scores, texture), texture.to_owned()))
        .collect()
}

pub(crate) fn textures(results: &[Compared]) -> Vec<&str> {
    distinct(results.iter().map(|r| r.variant.as_str()))
}

pub(crate) fn colour_of(scores: &Scores, texture: &str) -> Colour {
    colour(
        scores
            .variants()
            .iter()
            .position(|variant| *variant == texture)
            .unwrap_or_default(),
    )
}

/// Draws a row for each detector, and in it a line for each texture.
pub(crate) fn chart(findings: Findings) -> Drawing {
    let (scores, results, base) = (findings.scores, findings.results, findings.base);
    let textures = textures(results);
    let row = LINE * textures.len() as f64 + GAP;
    let height = row * scores.detectors.len() as f64;
    let [low, high] = ends(results);
    let x = |drop: f64| LEFT + (drop - low) / (high - low) * PLOT;
    let steps = ((high - low) / STEP).round() as usize;
    let mut marks = Vec::new();
    for tick in (0..=steps).map(|step| low + STEP * step as f64) {
        let colour = if tick == 0.0 { INK } else { FAINT };
        marks.push(Mark::line([x(tick), 0.0], [x(tick), height], colour));
        marks.push(Mark::text(
            [x(tick), height + 14.0],
            11.0,
            Middle,
            NOTE,
            number(tick, 2),
        ));
    }
    let title = format!("drop of the mean confidence from {}", paired::named_base(base));
    marks.push(Mark::text(
        [LEFT + PLOT / 2.0, height + 29.0],
        11.5,
        Middle,
        BLACK,
        title,
    ));
    for (i, detector) in scores.detectors.iter().enumerate() {
        let top = row * i as f64;
        let name = [LEFT - 10.0, top + row / 2.0 + 4.0];
        marks.push(Mark::text(name, 12.5, End, BLACK, &detector.manifest.title));
        for (j, texture) in textures.iter().enumerate() {
            let own = |r: &&Compared| r.detector == detector.manifest.name && r.variant == *texture;
            if let Some(r) = results.iter().find(own) {
                marks.extend(line(scores, r, base, top + GAP / 2.0 + LINE * (j as f64 + 0.5), &x));
            }
        }
    }
    Drawing {
        area: [0.0, -4.0, LEFT + PLOT + RIGHT, height + AXIS],
        label: "Drop of the mean confidence of each detector, with 95 % intervals".to_owned(),
        marks,
    }
}

/// Draws the whisker, the dot and the word of one detector and texture at the height `y`.
fn line(scores: &Scores, r: &Compared, base: &str, y: f64, x: &dyn Fn(f64) -> f64) -> [Mark; 2] {
    let (d, colour) = (&r.mean_confidence, colour_of(scores, &r.variant));
    let (dot_fill, word_colour) = if r.effect().is_shown() {
        (colour, colour)
    } else {
        (WHITE, NOTE)
    };
    let whisker = d
        .interval_95
        .map(|i| Mark::line([x(i.low), y], [x(i.high), y], colour).outlined(colour, 2.0));
    let dot = Mark::circle([x(d.drop), y], 4.6).filled(dot_fill).outlined(colour, 1.8);
    let words = paired::effect_sentence(r, base);
    let title = format!(
        "{}, {}: drop {}; {words}",
        scores.title(&r.detector),
        r.variant,
        number(d.drop, 3)
    );
    [
        Mark::group([0.0; 2], whisker.into_iter().chain([dot]).collect()).titled(title),
        Mark::text(
            [LEFT + PLOT + 12.0, y + 4.0],
            11.5,
            Start,
            word_colour,
            paired::effect_word(r),
        ),
    ]
}

/// Distance between two lines of the grid.
const STEP: f64 = 0.25;

/// Returns the ends of the axis: multiples of [`STEP`] that enclose every interval, 0 and a drop of 0.5.
fn ends(results: &[Compared]) -> [f64; 2] {
    let all = results.iter().flat_map(|r| {
        let d = &r.mean_confidence;
        let interval = d.interval_95.map(|i| [i.low, i.high]);
        [d.drop, d.drop].into_iter().chain(interval.into_iter().flatten())
    });
    let (low, high) = all.fold((0.0_f64, 0.5_f64), |(low, high), v| (low.min(v), high.max(v)));
    [(low / STEP).floor() * STEP, (high / STEP).ceil() * STEP]
}
