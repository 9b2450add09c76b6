//! The paper's tables of an evaluation (DTA, tables 1 and 2), and the paired differences behind them.

use crate::evaluated::EvaluatedDetector;
use crate::figures::{BASE_VARIANT, Compared};
use crate::report::Evaluation;
use crate::report::evaluation::SCOPE;
use crate::report::table::{Cell, Column, Table};
use crate::report::words::paired;
use scaleproof_core::spelling;

/// Returns table 1, AP@0.5 and mean confidence of the detectors that the patterns were made against, and table 2, AP@0.5 of the others, where there
/// are any; each in several tables where it has more than `across` columns.
pub(crate) fn by_pattern(evaluation: &Evaluation, across: usize) -> Vec<Table> {
    let photos = evaluation.scores.photos.len() / evaluation.patterns.len().max(1);
    let ap = evaluation.scores.criteria.ap.name();
    let first = format!(
        "Table 1. AP@0.5 ({ap}) and mean confidence, {} a pattern",
        spelling::count(photos, "photo")
    );
    let second = "Table 2. Transfer to other detectors, AP@0.5";
    let (targets, others) = (evaluation.targets(), evaluation.others());
    let targets = targets.chunks(across.div_ceil(2));
    let others = others.chunks(across);
    let targets = targets.map(|some| pattern_table(evaluation, &first, some, true));
    let others = others.map(|some| pattern_table(evaluation, second, some, false));
    targets.chain(others).collect()
}

/// Returns a row for each pattern, a column or two for each detector.
fn pattern_table(
    evaluation: &Evaluation,
    caption: &str,
    detectors: &[&EvaluatedDetector],
    has_confidence: bool,
) -> Table {
    let columns = detectors.iter().flat_map(|detector| {
        let ap = Column::numbers(&detector.manifest.title);
        let confidence = has_confidence.then(|| Column::numbers("conf."));
        [Some(ap), confidence].into_iter().flatten()
    });
    let mut table = Table::new(
        caption,
        std::iter::once(Column::words("pattern")).chain(columns).collect(),
    );
    let row = |pattern: &String| {
        let cells = detectors.iter().flat_map(|detector| {
            let figures = evaluation.figures(pattern, detector);
            let ap = Cell::maybe(figures.map(|f| f.ap50), 2);
            let confidence = has_confidence.then(|| Cell::maybe(figures.map(|f| f.mean_confidence), 2));
            [Some(ap), confidence].into_iter().flatten()
        });
        std::iter::once(Cell::text(pattern)).chain(cells).collect()
    };
    table.blocks.push(evaluation.patterns.iter().map(row).collect());
    table
}

/// Returns the differences of AP@0.5: of each pattern from the plain model, with the effect on the mean confidence; then of patterns from each other,
/// by intervals alone.
pub(crate) fn differences(evaluation: &Evaluation) -> Table {
    let mut table = Table::new(
        "Difference of AP@0.5, paired; against the plain model also what is shown of the mean confidence",
        vec![
            Column::words("detector"),
            Column::words("base − pattern"),
            Column::numbers("difference").in_unit("95 %"),
            Column::words("effect"),
        ],
    );
    let (targets, others) = (evaluation.targets(), evaluation.others());
    let all: Vec<&EvaluatedDetector> = targets.iter().chain(&others).copied().collect();
    let patterns = evaluation.patterns.iter().filter(|pattern| *pattern != BASE_VARIANT);
    for detector in &all {
        let own = patterns
            .clone()
            .filter_map(|pattern| evaluation.compared(BASE_VARIANT, pattern, detector));
        table.add_block(own.map(|r| cells(evaluation, BASE_VARIANT, r)));
    }
    for comparison in evaluation.comparisons.iter().filter(|c| c.base != BASE_VARIANT) {
        let of_target = |r: &&Compared| targets.iter().any(|target| target.manifest.name == r.detector);
        let own = comparison.results.iter().filter(of_target);
        table.add_block(own.map(|r| cells(evaluation, &comparison.base, r)));
    }
    table.notes.push(SCOPE.to_owned());
    table
}

fn cells(evaluation: &Evaluation, base: &str, r: &Compared) -> Vec<Cell> {
    vec![
        Cell::text(evaluation.scores.title(&r.detector)),
        Cell::text(format!("{base} − {}", r.variant)),
        Cell::number(r.ap50.drop, 2).with_interval(r.ap50.interval_95),
        Cell::text(r.finding.map_or("", |finding| paired::briefly(finding.effect))),
    ]
}
