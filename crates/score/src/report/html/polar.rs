//! Polar charts with their legend.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::charts::polar::{MARKS, charts};
use crate::report::html::parts::colour_names;

/// Renders one chart per detector, with a legend.
pub(crate) fn row(scores: &Scores) -> Markup {
    html! {
        ul.legend {
            (colour_names(&scores.variants()))
            li.note { (MARKS) }
        }
        div.small-charts.polars {
            @for (title, chart) in charts(scores) { figure { (chart.inline(None)) figcaption { (title) } } }
        }
    }
}
