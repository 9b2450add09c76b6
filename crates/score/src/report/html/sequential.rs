//! A comparison look by look: what was decided when, and the evidence as it grew.

use maud::{Markup, html};

use super::{colour, colour_names, heads, points, round, small_charts, table};
use crate::report::number;
use crate::report::paired::ends;
use crate::report::sequential::{SHOWN_FROM, figures, found, note, p_of, repeats, rounds, unit};
use crate::score::{Comparison, Course, Decision, Scores, Sequential};
use scaleproof_plot::Drawing;

const SIDE: [f64; 2] = [220.0, 120.0];
/// Base-10 logarithms of the evidence that a chart reaches from and to.
const EVIDENCE: [f64; 2] = [-2.0, 4.0];

/// `None` where it was not asked for.
pub(super) fn section(scores: &Scores, comparison: &Comparison) -> Option<Markup> {
    let sequential = comparison.sequential.as_ref()?;
    let rows = html! {
        @for course in &sequential.results {
            @for (name, decision) in figures(course) {
                tr {
                    td { (scores.title(&course.detector)) } td.text { (course.variant) } td.text { (name) }
                    td.text { (found(decision, sequential, course.looks)) (repeats(course)) } td.text { (p_of(decision).replace("= ", "")) }
                    td.text { (cell(decision, unit(sequential))) }
                }
            }
        }
    };
    let captioned = |course: &Course| {
        let caption = html! { (scores.title(&course.detector)) ", " (course.variant) };
        (caption, chart(scores, sequential, course))
    };
    Some(html! {
        (table(None, &heads("detector", &["texture", "figure", "finding", "p", "mean drop, 95 %"]), &rows))
        ul.legend { (colour_names(&["mean confidence", "hit rate"])) }
        (small_charts(sequential.results.iter().map(captioned)))
        p.note { (note(scores, sequential)) " Charts: evidence for a drop; dashed: from a factor of 40 on one test alone would show it." }
    })
}

/// `[0.31, 0.87], 3 whole rounds`
fn cell(decision: &Decision, unit: &str) -> String {
    let ends = decision.interval_95.map(|i| ends(i, |v| number(v, 2)));
    let ends = ends.unwrap_or_else(|| "none".to_owned());
    format!("{ends}, {}", rounds(decision, unit))
}

fn chart(scores: &Scores, sequential: &Sequential, course: &Course) -> Drawing {
    let last = course.looks.max(2) as f64;
    let x = |look: f64| round((look - 1.0) / (last - 1.0) * SIDE[0]);
    let y = |evidence: f64| {
        let share = (evidence.clamp(EVIDENCE[0], EVIDENCE[1]) - EVIDENCE[0]) / (EVIDENCE[1] - EVIDENCE[0]);
        round((1.0 - share) * SIDE[1])
    };
    let path = |evidence: &[f64]| {
        let places = evidence.iter().enumerate();
        points(places.map(|(i, evidence)| (x(1.0 + i as f64), y(*evidence))))
    };
    let marks = html! {
        @for (tick, name) in [(-2.0, "0.01"), (0.0, "1"), (2.0, "100"), (4.0, "10⁴")] {
            line x1="0" x2=(SIDE[0]) y1=(y(tick)) y2=(y(tick)) stroke="#d7dce2" {}
            text x="-5" y=(y(tick) + 3.0) font-size="9" text-anchor="end" fill="#5b6573" { (name) }
        }
        line x1="0" x2=(SIDE[0]) y1=(y(SHOWN_FROM)) y2=(y(SHOWN_FROM)) stroke="#1b1f24" stroke-dasharray="4 3" {}
        @for (i, (_, decision)) in figures(course).into_iter().enumerate() {
            polyline points=(path(&decision.log10_evidence)) fill="none" stroke=(colour(i)) stroke-width="2" {}
        }
        text x="0" y=(SIDE[1] + 13.0) font-size="9" text-anchor="middle" fill="#5b6573" { "1" }
        text x=(SIDE[0]) y=(SIDE[1] + 13.0) font-size="9" text-anchor="middle" fill="#5b6573" { (course.looks) }
        text x=(SIDE[0] / 2.0) y=(SIDE[1] + 15.0) font-size="10" text-anchor="middle" { (unit(sequential)) "s" }
    };
    Drawing {
        area: [-34.0, -8.0, 268.0, 148.0],
        label: format!(
            "Evidence for a drop after each {}, {}, {}",
            unit(sequential),
            scores.title(&course.detector),
            course.variant
        ),
        marks,
    }
}
