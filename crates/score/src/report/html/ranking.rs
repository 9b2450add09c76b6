//! The order of the textures here and in other sessions: a table, and a chart for each detector.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::charts::ranking::chart;
use crate::report::html::parts::{colour_names, small_charts};
use crate::report::table::Table;

/// Renders the section; `None` for a run without a ranking.
pub(crate) fn section(scores: &Scores, order: Option<&Table>) -> Option<Markup> {
    let (ranking, order) = scores.ranking.as_ref().zip(order)?;
    let of_all = ranking.rows.iter().filter(|row| row.photos == "all");
    Some(html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(of_all.map(|row| (html! { (scores.title(&row.detector)) }, chart(scores, row)))))
        (order.markup())
    })
}
