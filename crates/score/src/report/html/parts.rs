//! Tables, legends and small charts of a page.

use maud::{Markup, html};

use crate::evaluated::EvaluatedDetector;
use crate::figures::{Scores, Summary};
use crate::report::charts::colours::colour;
use scaleproof_plot::Drawing;

/// Renders a table that scrolls sideways where it is wider than the page.
pub(crate) fn table(class: Option<&str>, head: &Markup, rows: &Markup) -> Markup {
    html! { div.scroll { table class=[class] { thead { tr { (head) } } tbody { (rows) } } } }
}

/// Renders the heads of a table whose first column may be a number and whose others are text.
pub(crate) fn heads(first: &str, others: &[&str]) -> Markup {
    html! { th { (first) } @for name in others { th.text { (name) } } }
}

/// Renders the rows of a table of detectors and textures; a detector's name stands in the first of its rows alone.
pub(crate) fn rows_by_detector(
    scores: &Scores,
    name: impl Fn(&EvaluatedDetector) -> Markup,
    cells: impl Fn(&Summary) -> Markup,
) -> Markup {
    html! {
        @for c in &scores.detectors {
            @for (i, variant) in scores.variants().into_iter().enumerate() {
                @if let Some(s) = scores.summary(&c.manifest.name, variant) {
                    tr.first[i == 0] { td { @if i == 0 { (name(c)) } } td.text { (variant) } (cells(s)) }
                }
            }
        }
    }
}

pub(crate) fn title_of(detector: &EvaluatedDetector) -> Markup {
    html! { (detector.manifest.title) }
}

/// Renders the entries of a legend: names by the colours of the variants, in their order.
pub(crate) fn colour_names(names: &[&str]) -> Markup {
    html! { @for (i, name) in names.iter().enumerate() { li { i style=(format!("background:{}", colour(i))) {} (name) } } }
}

pub(crate) fn small_charts(charts: impl IntoIterator<Item = (Markup, Drawing)>) -> Markup {
    html! {
        div.small-charts {
            @for (caption, chart) in charts { figure { (chart.inline(None)) figcaption { (caption) } } }
        }
    }
}
