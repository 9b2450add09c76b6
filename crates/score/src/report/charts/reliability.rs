//! Reliability diagrams: share of correct detections by their confidence.

use crate::figures::{ConfidenceBin, Reliability, Scores, reliability};
use crate::report::charts::plane::{SIDE, SQUARE};
use scaleproof_plot::Anchor::Middle;
use scaleproof_plot::{BLACK, Colour, Drawing, INK, Mark, NOTE};

pub(crate) fn charts(scores: &Scores) -> Vec<(&str, Drawing)> {
    let all = reliability(&scores.photos, &scores.detectors);
    let titles = scores.detectors.iter().map(|c| c.manifest.title.as_str());
    titles.zip(&all).map(|(title, r)| (title, diagram(title, r))).collect()
}

const BAR: Colour = Colour(0x9ec5e8);
const BAR_EDGE: Colour = Colour(0x30628f);

fn diagram(title: &str, r: &Reliability) -> Drawing {
    let mut marks = SQUARE.grid(-5.0, Some(24.0));
    marks.extend(r.bins.iter().flat_map(bar));
    marks.push(Mark::line(SQUARE.at(0.0, 0.0), SQUARE.at(1.0, 1.0), INK).dashed(true));
    marks.push(Mark::text([SIDE / 2.0, SIDE + 38.0], 10.0, Middle, BLACK, "confidence"));
    marks.push(SQUARE.upright_title(-21.0, "share correct"));
    Drawing {
        area: [-30.0, -8.0, 222.0, 232.0],
        label: format!("Share correct by confidence, {title}"),
        marks,
    }
}

/// Draws a bin's bar with its interval, where it has detections, and their number below it.
fn bar(bin: &ConfidenceBin) -> Vec<Mark> {
    let [middle, bottom] = SQUARE.at((bin.low + bin.high) / 2.0, 0.0);
    let count = Mark::text([middle, bottom + 11.0], 7.5, Middle, NOTE, bin.detections);
    let drawn = bin.mean_confidence.zip(bin.correct).map(|(confidence, rate)| {
        let ([left, top], [right, _]) = (SQUARE.at(bin.low, rate.rate), SQUARE.at(bin.high, rate.rate));
        let [low, high] = [rate.low, rate.high].map(|share| SQUARE.at(0.0, share)[1]);
        let bar = Mark::rect([left + 1.0, top], [right - left - 2.0, bottom - top]);
        let marks = vec![
            bar.filled(BAR).outlined(BAR_EDGE, 0.8),
            Mark::polyline(whisker(middle, low, high), INK, 0.9),
            Mark::circle(SQUARE.at(confidence, rate.rate), 2.6).filled(INK),
        ];
        Mark::group([0.0; 2], marks).titled(format!(
            "confidence {:.1} to {:.1}: {} of {} correct ({:.3}), mean confidence {confidence:.3}",
            bin.low, bin.high, rate.count, bin.detections, rate.rate
        ))
    });
    drawn.into_iter().chain([count]).collect()
}

/// Returns an upright line with a bar at each end.
fn whisker(x: f64, from: f64, to: f64) -> [[f64; 2]; 6] {
    let end = |y: f64| [[x - 3.0, y], [x + 3.0, y]];
    let ([a, b], [c, d]) = (end(from), end(to));
    [a, b, [x, from], [x, to], c, d]
}
