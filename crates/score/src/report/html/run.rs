//! `report.html`: the page of a scoring run.

use maud::{PreEscaped, html};

use crate::figures::Scores;
use crate::report::RunReport;
use crate::report::html::page::{SCRIPT, Section, lead, shell};
use crate::report::html::{charts, contact, defences, first, misses, notes, patterns};
use crate::report::table::Table;
use scaleproof_detect::Speeds;

/// Renders the page of a scoring run; without `speeds` there is no chart of AP against time.
pub fn render(scores: &Scores, speeds: Option<&Speeds>) -> String {
    of_run(&RunReport::new(scores, speeds))
}

pub(crate) fn of_run(report: &RunReport) -> String {
    let (scores, findings, tables) = (report.scores, report.findings, &report.tables);
    let library = first::library(findings, contact::shown(scores));
    let tail = html! { (library) script { (PreEscaped(SCRIPT)) } };
    let first = first::screen(findings, tables.main(findings));
    shell(scores, &lead(scores), &first, &sections(report), tail)
}

fn sections(report: &RunReport) -> Vec<Section> {
    let (scores, tables) = (report.scores, &report.tables);
    let table = |table: &Table| html! { h3 { (table.caption) } (table.markup()) };
    let figures = html! { (table(&tables.figures)) (table(&tables.papers)) @for transfer in &tables.transferred { (table(transfer)) } };
    let outcomes = html! { (misses::outcomes(scores)) (table(&tables.taken)) };
    let directions = html! { (charts::polar(scores)) (charts::heat_maps(scores)) };
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
            charts::robustness(scores, tables.survival.as_ref()),
        ),
        (
            "defences",
            "On defended photos",
            defences::section(scores, tables.defended.as_ref()),
        ),
        (
            "ranking",
            "Order of the textures in other sessions",
            charts::ranking(scores, tables.order.as_ref()),
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
        ("curves", "Curves", Some(charts::curves(scores))),
        (
            "reliability",
            "Reliability of the confidences",
            Some(charts::reliability(scores)),
        ),
        ("speed", "AP against time", Some(charts::speed(scores, report.speeds))),
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
