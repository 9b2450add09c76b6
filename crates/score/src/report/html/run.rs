//! `report.html`: the page of a scoring run.

use maud::{PreEscaped, html};

use crate::figures::Scores;
use crate::report::RunReport;
use crate::report::html::page::{SCRIPT, Section, lead, shell};
use crate::report::html::{
    contact, curves, defences, first, heat, misses, notes, patterns, polar, ranking, reliability, robustness, speed,
};
use crate::report::table::Table;
use scaleproof_detect::Speeds;

/// Renders the page of a scoring run; without `speeds` there is no chart of AP against time.
pub fn render(scores: &Scores, speeds: Option<&Speeds>) -> String {
    of_run(&RunReport::new(scores, speeds))
}

pub(crate) fn of_run(report: &RunReport) -> String {
    let RunReport {
        scores,
        findings,
        ref tables,
        ..
    } = *report;
    let library = first::library(findings, contact::shown(scores));
    let tail = html! { (library) script { (PreEscaped(SCRIPT)) } };
    let main = if findings.results.is_empty() {
        &tables.brief
    } else {
        &tables.effects
    };
    let first = first::screen(findings, main);
    shell(scores, &lead(scores), &first, &sections(report), tail)
}

fn sections(report: &RunReport) -> Vec<Section> {
    let RunReport { scores, ref tables, .. } = *report;
    let table = |table: &Table| html! { h3 { (table.caption) } (table.markup()) };
    let figures = html! { (table(&tables.figures)) (table(&tables.papers)) @for transfer in &tables.transferred { (table(transfer)) } };
    let outcomes = html! { (misses::outcomes(scores)) (table(&tables.taken)) };
    let directions = html! { (polar::row(scores)) (heat::maps(scores)) };
    let photos = html! { (contact::sheet(scores)) (notes::not_scored(scores)) };
    let conditions = &tables.conditions;
    let conditions = (!conditions.is_empty()).then(|| html! { @for condition in conditions { (table(condition)) } });
    let method = notes::method(report.findings);
    let chance = "the bootstrap behind the intervals of drops has its own seed";
    let open = [
        ("conditions", "By condition", conditions),
        (
            "robustness",
            "On photos made worse",
            robustness::section(scores, tables.survival.as_ref()),
        ),
        (
            "defences",
            "On defended photos",
            defences::section(scores, tables.defended.as_ref()),
        ),
        (
            "ranking",
            "Order of the textures in other sessions",
            ranking::section(scores, tables.order.as_ref()),
        ),
        ("directions", "By viewing direction", Some(directions)),
        ("photos", "Photos", Some(photos)),
    ];
    let folded = [
        ("protocol", "Protocol", tables.protocol.as_ref().map(table)),
        ("method", "How this was decided, and what to write", Some(method)),
        ("comparable", "All figures, for comparison with papers", Some(figures)),
        ("outcomes", "Hits and misses", Some(outcomes)),
        ("patterns", "Patterns", patterns::cards(scores)),
        ("curves", "Curves", Some(curves::section(scores))),
        (
            "reliability",
            "Reliability of the confidences",
            Some(reliability::diagrams(scores)),
        ),
        ("speed", "AP against time", Some(speed::chart(scores, report.speeds))),
        ("definitions", "Definitions", Some(notes::definitions(scores))),
        ("provenance", "Provenance", Some(notes::provenance(scores, chance))),
    ];
    let open = open
        .into_iter()
        .filter_map(|(id, title, content)| Some(Section::open(id, title, content?)));
    let folded = folded
        .into_iter()
        .filter_map(|(id, title, content)| Some(Section::folded(id, title, content?)));
    open.chain(folded).collect()
}
