//! AP against milliseconds per photo.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::charts::speed::{mark, plot, timed};
use scaleproof_core::spelling;
use scaleproof_detect::Speeds;
use scaleproof_plot::markup;

/// Renders the chart of the detectors whose times are known, and the source of the times.
pub(crate) fn chart(scores: &Scores, speeds: Option<&Speeds>) -> Markup {
    let Some(speeds) = speeds else {
        return html! {
            p.note {
                "Not in this report: no times were given. " code { "scaleproof detectors speed" } " measures them and writes a file for "
                code { "score --speed FILE" } "."
            }
        };
    };
    let untimed = scores.detectors.len() - timed(scores, speeds).len();
    html! {
        ul.legend {
            @for (i, variant) in scores.variants().iter().enumerate() {
                li { svg.mark viewBox="-7 -7 14 14" { (markup(&[mark([0.0; 2], i)])) } (variant) }
            }
        }
        div.scroll { (plot(scores, speeds).inline(Some("speed"))) }
        p.note {
            "Median of " (spelling::count(speeds.photos, "photo")) " of " (speeds.megapixels) " megapixels, the fastest of " (speeds.rounds) " rounds each, from "
            "decoded photo to boxes; " (speeds.threads) " thread, " (speeds.machine) "; " (speeds.onnx_runtime) "."
            @if untimed > 0 { " Without times, and not in the chart: " (spelling::count(untimed, "detector")) "." }
        }
    }
}
