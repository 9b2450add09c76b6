//! AP against the severity of corruptions, and how far each drop goes.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::charts::robustness::{MARKS, charts};
use crate::report::html::parts::{colour_names, small_charts};
use crate::report::table::Table;

/// Renders the section; `None` for a run without corruptions.
pub(crate) fn section(scores: &Scores, survival: Option<&Table>) -> Option<Markup> {
    let (robustness, survival) = scores.robustness.as_ref().zip(survival)?;
    Some(html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(charts(scores, robustness).into_iter().map(|(title, chart)| (html! { (title) }, chart))))
        p.note { (MARKS) }
        h3 { "How far each drop goes" }
        p.note { (survival.caption) "." }
        (survival.markup())
        p.note {
            "Photos are reduced to 640 px, then made worse by the amounts of ImageNet-C (Hendrycks and Dietterich 2019); " code { "crop" }
            " cuts 10 to 50 % of the model's box off."
        }
        @for caution in &robustness.cautions { p.note { (caution) } }
    })
}
