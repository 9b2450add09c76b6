//! `report.html`: the page of a scoring run.

use maud::{PreEscaped, html};

use crate::compare::paired as all_paired;
use crate::figures::Scores;
use crate::report::html::page::{ACROSS, SCRIPT, Section, lead, shell};
use crate::report::html::{
    contact, curves, defences, first, heat, misses, notes, patterns, polar, ranking, reliability, robustness, speed,
};
use crate::report::table::Table;
use crate::report::tables;
use crate::report::words::paper::Judged;
use scaleproof_detect::Speeds;

/// Renders the page of a scoring run; without `speeds` there is no chart of AP against time.
pub fn render(scores: &Scores, speeds: Option<&Speeds>) -> String {
    let (results, base) = (all_paired(scores), scores.base.as_str());
    let library = first::library(scores, results, base, contact::shown(scores));
    let tail = html! { (library) script { (PreEscaped(SCRIPT)) } };
    let first = first::screen(scores, results, base);
    shell(scores, &lead(scores), &first, &sections(scores, speeds), tail)
}

pub(crate) fn sections(scores: &Scores, speeds: Option<&Speeds>) -> Vec<Section> {
    let table = |table: Table| html! { h3 { (table.caption) } (table.markup()) };
    let figures = html! { (table(tables::figures(scores))) (table(tables::papers(scores))) @for transfer in tables::transferred(scores, ACROSS) { (table(transfer)) } };
    let outcomes = html! { (misses::outcomes(scores)) (table(tables::taken(scores))) };
    let directions = html! { (polar::row(scores)) (heat::maps(scores)) };
    let photos = html! { (contact::sheet(scores)) (notes::not_scored(scores)) };
    let conditions: Vec<Table> = tables::conditions(scores);
    let conditions = (!conditions.is_empty()).then(|| html! { @for condition in conditions { (table(condition)) } });
    let method = notes::method(scores, all_paired(scores), &scores.base, Judged::default());
    let chance = "the bootstrap behind the intervals of drops has its own seed";
    let open = [
        ("conditions", "By condition", conditions),
        ("robustness", "On photos made worse", robustness::section(scores)),
        ("defences", "On defended photos", defences::section(scores)),
        (
            "ranking",
            "Order of the textures in other sessions",
            ranking::section(scores),
        ),
        ("directions", "By viewing direction", Some(directions)),
        ("photos", "Photos", Some(photos)),
    ];
    let folded = [
        ("protocol", "Protocol", tables::protocol(scores).map(table)),
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
        ("speed", "AP against time", Some(speed::chart(scores, speeds))),
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
