//! A sequential comparison look by look.

use maud::{Markup, html};

use crate::figures::{Comparison, Course, Scores};
use crate::report::charts::looks::chart;
use crate::report::html::parts::{colour_names, small_charts};
use crate::report::tables;
use crate::report::words::looks::note;

/// Renders the section; `None` for a comparison without a sequential test.
pub(crate) fn section(scores: &Scores, comparison: &Comparison) -> Option<Markup> {
    let sequential = comparison.sequential.as_ref()?;
    let captioned = |course: &Course| {
        let caption = html! { (scores.title(&course.detector)) ", " (course.variant) };
        (caption, chart(scores, sequential, course))
    };
    Some(html! {
        (tables::looks(scores, sequential).markup())
        ul.legend { (colour_names(&["mean confidence", "hit rate"])) }
        (small_charts(sequential.results.iter().map(captioned)))
        p.note { (note(scores, sequential)) " Charts: evidence for a drop; dashed: from a factor of 40 on one test alone would show it." }
    })
}
