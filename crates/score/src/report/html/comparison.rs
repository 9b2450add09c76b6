//! `comparison.html`: the drops of each texture with their intervals, photos side by side, and the method.

use maud::{Markup, PreEscaped, html};

use crate::compare::comparison_definitions;
use crate::figures::{Compared, Comparison, PlanCheck, Scores};
use crate::report::charts::drops::{FIGURES, forest};
use crate::report::html::page::{SCRIPT, Section, lead, shell};
use crate::report::html::{charts, first, notes, pairs};
use crate::report::words::paired;
use crate::report::{Findings, tables};

pub fn render(scores: &Scores, comparison: &Comparison) -> String {
    let findings = Findings::of_comparison(scores, comparison);
    let chance = notes::bootstrap(comparison);
    let photos = pairs::photos(scores, comparison);
    let script = html! { @if !photos.is_empty() { script { (PreEscaped(SCRIPT)) } } };
    let tail = html! { (first::library(findings, photos)) (script) };
    let first = html! { @if let Some(check) = &comparison.plan { (plan(check)) } (first::screen(findings, &tables::effects(findings))) };
    let open = [
        ("looks", "However often one looks", charts::looks(scores, comparison)),
        ("pairs", "Photos side by side", pairs::section(scores, comparison)),
    ];
    let method = notes::method(findings);
    let folded = [
        ("method", "How this was decided, and what to write", method),
        ("drops", "Drops of the hit rate and of AP", drops(scores, comparison)),
        (
            "azimuth",
            "Drop of the hit rate by azimuth",
            tables::by_azimuth(findings).markup(),
        ),
        ("left-out", "Photos in no difference", left_out(scores, comparison)),
        ("definitions", "Definitions", definitions()),
        ("provenance", "Provenance", notes::provenance(scores, &chance)),
    ];
    let open = open
        .into_iter()
        .filter_map(|(id, title, content)| Some(Section::open(id, title, content?)));
    let folded = folded
        .into_iter()
        .map(|(id, title, content)| Section::folded(id, title, content));
    shell(
        scores,
        &lead(scores),
        &first,
        &open.chain(folded).collect::<Vec<_>>(),
        tail,
    )
}

/// Renders every deviation from the plan that was sealed before the photos.
fn plan(plan: &PlanCheck) -> Markup {
    html! {
        p { "Held against the plan " code { (plan.seal) } ": " (paired::deviations(plan)) "." }
        @for deviation in &plan.deviations { p.banner { "Deviation: " (deviation) "." } }
    }
}

pub(crate) fn drops(scores: &Scores, comparison: &Comparison) -> Markup {
    html! {
        @for figure in FIGURES {
            h3 { (figure.title) }
            div.scroll { (forest(scores, comparison, &figure).inline(Some("forest"))) }
        }
        @let open: Vec<(&Compared, String)> = comparison.results.iter().filter_map(|r| Some((r, paired::more_photos(r)?))).collect();
        @if !open.is_empty() {
            h3 { "How many more photos would tell" }
            ul { @for (r, sentence) in open { li { (scores.title(&r.detector)) ", " (r.variant) ": confidence, " (sentence) "." } } }
        }
        p.note {
            "Dot: the drop; line: its 95 % interval, absent with too few views or when all differ alike. Filled: a change is shown. "
            "Numbers: base → texture, drop [interval], attack success rate [interval]."
        }
    }
}

fn left_out(scores: &Scores, comparison: &Comparison) -> Markup {
    html! {
        @if comparison.unpaired.is_empty() { p { "Every scored photo has its partner." } } @else {
            (notes::photos_with_reasons(&comparison.unpaired))
        }
        (notes::not_scored(scores))
    }
}

fn definitions() -> Markup {
    html! { dl { @for (name, definition) in comparison_definitions() { dt { (name) } dd { (definition) "." } } } }
}
