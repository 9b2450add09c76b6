//! Charts of a page, each with its legend and an explanation.

use maud::{Markup, html};

use crate::figures::{self, Comparison, Course, RELIABILITY_FLOOR, Reliability, Scores};
use crate::report::charts::{curves, heat, intervals, looks, polar, ranking, reliability, robustness, shade, speed};
use crate::report::html::parts::{colour_names, small_charts};
use crate::report::table::Table;
use crate::report::words::number;
use crate::report::{Findings, tables, words};
use scaleproof_core::spelling;
use scaleproof_detect::Speeds;
use scaleproof_plot::markup;

/// Renders the chart of the drops of the mean confidence.
pub(crate) fn intervals(findings: Findings) -> Markup {
    let scores = findings.scores;
    let textures = intervals::textures(findings.results);
    html! {
        ul.legend {
            @for texture in &textures { li { i style=(format!("background:{}", intervals::colour_of(scores, texture))) {} (texture) } }
            li.note { (intervals::MARKS) "." }
        }
        div.scroll { (intervals::chart(findings).inline(Some("intervals"))) }
    }
}

/// Renders one polar chart per detector.
pub(crate) fn polar(scores: &Scores) -> Markup {
    html! {
        ul.legend {
            (colour_names(&scores.variants()))
            li.note { (polar::MARKS) }
        }
        div.small-charts.polars {
            @for (title, chart) in polar::charts(scores) { figure { (chart.inline(None)) figcaption { (title) } } }
        }
    }
}

/// Renders a heat map for each detector, its textures below each other.
pub(crate) fn heat_maps(scores: &Scores) -> Markup {
    let is_wide = scores.sessions[0].scene.bins.azimuth_centres().len() > 12;
    let maps = heat::charts(scores);
    html! {
        @if !maps.is_empty() {
            h3 { "Azimuth × pitch × distance" }
            div.scale {
                span { "mean confidence 0" }
                @for step in 0..=10 { i style=(format!("background:{}", shade::shade(f64::from(step) / 10.0))) {} }
                span { "1" }
            }
            div.maps {
                @for (title, map) in maps {
                    figure.wide[is_wide] { figcaption { (title) } div.scroll { (map.inline(None)) } }
                }
            }
            p.note {
                (heat::CELLS) ". Rows: pitch and distance at model scale, those that have "
                "photos. AP and intervals per cell are in figures.csv."
            }
        }
    }
}

pub(crate) fn curves(scores: &Scores) -> Markup {
    let both = curves::charts(scores).into_iter().flat_map(|(title, charts)| {
        let captions = ["found from a confidence", "precision over recall"];
        let captions = captions.map(|what| html! { (title) br; small { (what) } });
        captions.into_iter().zip(charts)
    });
    html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(both))
        p.note {
            "Found: share of photos that show the model at this confidence or more, with its 95 % Wilson interval; upright line: the confidence of a hit. "
            "Precision and recall of the detections of the class at IoU 0.5, from the most confident down to 0.001."
        }
    }
}

/// Number of detections below which the error says little.
const FEW: usize = 100;

pub(crate) fn reliability(scores: &Scores) -> Markup {
    let all = figures::reliability(&scores.photos, &scores.detectors);
    let captioned = reliability::charts(scores).into_iter().zip(&all);
    html! {
        (small_charts(captioned.map(|((title, chart), r)| (html! { (title) br; small { (calibration(r)) } }, chart))))
        p.note {
            "Bars: share of the detections of the class that are correct (the most confident one at IoU ≥ 0.5 in its photo), with its 95 % Wilson "
            "interval; dots at the mean confidence, on the dashed line when confidence is what it says. Below: how many detections. All textures "
            "together, from confidence " (RELIABILITY_FLOOR) " up. ECE: expected calibration error, the mean distance from the line over all "
            "detections; “by chance” is what a detector with true confidences would show with as many. Real objects of the class in the "
            "background count as wrong: only the model is known to be there."
        }
    }
}

fn calibration(r: &Reliability) -> String {
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

/// Renders the section; `None` for a run without corruptions.
pub(crate) fn robustness(scores: &Scores, survival: Option<&Table>) -> Option<Markup> {
    let (changed, survival) = scores.robustness.as_ref().zip(survival)?;
    Some(html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(robustness::charts(scores, changed).into_iter().map(|(title, chart)| (html! { (title) }, chart))))
        p.note { (robustness::MARKS) }
        h3 { "How far each drop goes" }
        p.note { (survival.caption) "." }
        (survival.markup())
        p.note {
            "Photos are reduced to 640 px, then made worse by the amounts of ImageNet-C (Hendrycks and Dietterich 2019); " code { "crop" }
            " cuts 10 to 50 % of the model's box off."
        }
        @for caution in &changed.cautions { p.note { (caution) } }
    })
}

/// Renders the section; `None` for a run without a ranking.
pub(crate) fn ranking(scores: &Scores, order: Option<&Table>) -> Option<Markup> {
    let (orders, order) = scores.ranking.as_ref().zip(order)?;
    let of_all = orders.rows.iter().filter(|row| row.photos == "all");
    Some(html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(of_all.map(|row| (html! { (scores.title(&row.detector)) }, ranking::chart(scores, row)))))
        (order.markup())
    })
}

/// Renders the section; `None` for a comparison without a sequential test.
pub(crate) fn looks(scores: &Scores, comparison: &Comparison) -> Option<Markup> {
    let sequential = comparison.sequential.as_ref()?;
    let captioned = |course: &Course| {
        let caption = html! { (scores.title(&course.detector)) ", " (course.variant) };
        (caption, looks::chart(scores, sequential, course))
    };
    Some(html! {
        (tables::looks(scores, sequential).markup())
        ul.legend { (colour_names(&["mean confidence", "hit rate"])) }
        (small_charts(sequential.results.iter().map(captioned)))
        p.note { (words::looks::note(scores, sequential)) " Charts: evidence for a drop; dashed: from a factor of 40 on one test alone would show it." }
    })
}

/// Renders the chart of the detectors whose times are known, and the source of the times.
pub(crate) fn speed(scores: &Scores, speeds: Option<&Speeds>) -> Markup {
    let Some(speeds) = speeds else {
        return html! {
            p.note {
                "Not in this report: no times were given. " code { "scaleproof detectors speed" } " measures them and writes a file for "
                code { "score --speed FILE" } "."
            }
        };
    };
    let untimed = scores.detectors.len() - speed::timed(scores, speeds).len();
    html! {
        ul.legend {
            @for (i, variant) in scores.variants().iter().enumerate() {
                li { svg.mark viewBox="-7 -7 14 14" { (markup(&[speed::mark([0.0; 2], i)])) } (variant) }
            }
        }
        div.scroll { (speed::plot(scores, speeds).inline(Some("speed"))) }
        p.note {
            "Median of " (spelling::count(speeds.photos, "photo")) " of " (speeds.megapixels) " megapixels, the fastest of " (speeds.rounds) " rounds each, from "
            "decoded photo to boxes; " (speeds.threads) " thread, " (speeds.machine) "; " (speeds.onnx_runtime) "."
            @if untimed > 0 { " Without times, and not in the chart: " (spelling::count(untimed, "detector")) "." }
        }
    }
}
