//! Reliability diagrams: share of correct detections by their confidence.

use maud::{Markup, html};

use crate::figures::{RELIABILITY_FLOOR, Reliability, Scores, reliability};
use crate::report::charts::reliability::charts;
use crate::report::html::parts::small_charts;
use crate::report::words::number;
use scaleproof_core::spelling;

/// Number of detections below which the error says little.
const FEW: usize = 100;

pub(crate) fn diagrams(scores: &Scores) -> Markup {
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
