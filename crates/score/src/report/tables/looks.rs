//! Table of a sequential comparison.

use crate::figures::{Course, Decision, Scores, Sequential};
use crate::report::table::{Cell, Column, Table};
use crate::report::words::looks::{finding_words, p_of, repeats, rounds};
use crate::report::words::{briefly, figures, unit};

/// Returns two rows for each detector and texture: the findings on the confidence and on the hits so far, and the look after which they were shown.
pub(crate) fn looks(scores: &Scores, sequential: &Sequential) -> Table {
    let unit = unit(sequential);
    let caption =
        format!("Looked at after each {unit}, in the order of the photos; what is said holds however often one looks");
    let mut table = Table::new(
        &caption,
        vec![
            Column::words("detector"),
            Column::words("texture"),
            Column::words("effect"),
            Column::words("figure"),
            Column::words("finding"),
            Column::words("p"),
            Column::numbers("mean drop").in_unit("95 %"),
        ],
    );
    for detector in &scores.detectors {
        let own = sequential
            .results
            .iter()
            .filter(|course| course.detector == detector.manifest.name);
        table.add_block(own.flat_map(|course| {
            figures(course).map(|(name, decision)| row(scores, sequential, course, name, decision))
        }));
    }
    table
}

fn row(scores: &Scores, sequential: &Sequential, course: &Course, name: &str, decision: &Decision) -> Vec<Cell> {
    let unit = unit(sequential);
    let interval = match decision.interval_95 {
        Some(_) => rounds(decision, unit),
        None if decision.rounds == 0 => format!(
            "no interval: no {}",
            if unit == "place" { "place" } else { "whole round" }
        ),
        None => format!("no interval: {} contradict each other", rounds(decision, unit)),
    };
    vec![
        Cell::text(scores.title(&course.detector)),
        Cell::text(&course.variant),
        Cell::text(briefly(course.effect)).strong(course.effect.is_shown()),
        Cell::text(name),
        Cell::text(finding_words(decision, sequential, course.looks) + &repeats(course)),
        Cell::text(p_of(decision).replace("= ", "")),
        Cell::number(decision.drop, 2)
            .with_interval(decision.interval_95)
            .with_remark(Some(interval)),
    ]
}
