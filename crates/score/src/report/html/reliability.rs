//! Reliability diagrams: what share of the detections of some confidence is correct?

use maud::{Markup, html};

use super::{SIDE, SQUARE, small_charts};
use crate::report::number;
use crate::score::{ConfidenceBin, RELIABILITY_FLOOR, Reliability, Scores, reliability};
use scaleproof_core::spelling;
use scaleproof_plot::Drawing;

/// With fewer detections the error says little.
const FEW: usize = 100;

pub(super) fn diagrams(scores: &Scores) -> Markup {
    let all = reliability(&scores.photos, &scores.detectors);
    let captioned = charts(scores).into_iter().zip(&all);
    html! {
        (small_charts(captioned.map(|((title, chart), r)| (html! { (title) br; small { (verdict(r)) } }, chart))))
        p.note {
            "Bars: share of the detections of the class that are correct (the most confident one at IoU ≥ 0.5 in its photo), with its 95 % Wilson "
            "interval; dots at the mean confidence, on the dashed line when confidence is what it says. Below: how many detections. All textures "
            "together, from confidence " (RELIABILITY_FLOOR) " up. ECE: expected calibration error, the mean distance from the line over all "
            "detections; “by chance” is what a detector with true confidences would show with as many. Real objects of the class in the "
            "background count as wrong: only the model is known to be there."
        }
    }
}

pub(in crate::report) fn charts(scores: &Scores) -> Vec<(&str, Drawing)> {
    let all = reliability(&scores.photos, &scores.detectors);
    let titles = scores.detectors.iter().map(|c| c.manifest.title.as_str());
    titles.zip(&all).map(|(title, r)| (title, diagram(title, r))).collect()
}

fn verdict(r: &Reliability) -> String {
    let count = r.detections;
    match (r.expected_calibration_error, r.error_by_chance) {
        (Some(error), Some(chance)) => {
            let few = if count < FEW { ": few" } else { "" };
            format!(
                "ECE {} ({} by chance), {}{few}",
                number(error, 2),
                number(chance, 2),
                spelling::count(count, "detection")
            )
        }
        _ => format!("no detection from confidence {RELIABILITY_FLOOR} up"),
    }
}

fn diagram(title: &str, r: &Reliability) -> Drawing {
    let marks = html! {
        (SQUARE.grid(-5.0, Some(24.0)))
        @for bin in &r.bins { (bar(bin)) }
        line x1="0" y1=(SIDE) x2=(SIDE) y2="0" stroke="#1b1f24" stroke-dasharray="4 3" {}
        text x=(SIDE / 2.0) y=(SIDE + 38.0) font-size="10" text-anchor="middle" { "confidence" }
        (SQUARE.upright_title(-21.0, "share correct"))
    };
    Drawing {
        area: [-30.0, -8.0, 222.0, 232.0],
        label: format!("Share correct by confidence, {title}"),
        marks,
    }
}

fn bar(bin: &ConfidenceBin) -> Markup {
    let (x, y) = (|v: f64| SQUARE.x(v), |v: f64| SQUARE.y(v));
    let middle = x((bin.low + bin.high) / 2.0);
    html! {
        @if let (Some(confidence), Some(rate)) = (bin.mean_confidence, bin.correct) {
            g.reliability {
                title {
                    (format!("confidence {:.1} to {:.1}: {} of {} correct ({:.3}), mean confidence {confidence:.3}",
                        bin.low, bin.high, rate.count, bin.detections, rate.rate))
                }
                rect x=(x(bin.low) + 1.0) width=(x(bin.high) - x(bin.low) - 2.0) y=(y(rate.rate)) height=(y(0.0) - y(rate.rate))
                    fill="#9ec5e8" stroke="#30628f" stroke-width="0.8" {}
                path d=(whisker(middle, y(rate.low), y(rate.high))) stroke="#1b1f24" stroke-width="0.9" fill="none" {}
                circle cx=(x(confidence)) cy=(y(rate.rate)) r="2.6" fill="#1b1f24" {}
            }
        }
        text x=(middle) y=(y(0.0) + 11.0) font-size="7.5" text-anchor="middle" fill="#5b6573" { (bin.detections) }
    }
}

/// An upright line with a bar at each end.
fn whisker(x: f64, from: f64, to: f64) -> String {
    format!("M{x} {from}V{to}M{} {from}h6M{} {to}h6", x - 3.0, x - 3.0)
}
