//! Tables that a run has only on request.

use crate::figures::Scores;
use crate::report::table::Table;
use crate::report::tables::{conditions, defended, order, protocol, survival};

/// Returns the tables that a run has only on request.
pub(crate) fn asked_for(scores: &Scores) -> Vec<Table> {
    let mut tables = conditions(scores);
    tables.extend(protocol(scores));
    tables.extend(scores.robustness.as_ref().map(survival));
    tables.extend(scores.defences.iter().flat_map(defended));
    tables.extend(scores.ranking.as_ref().map(|ranking| order(scores, ranking)));
    tables
}
