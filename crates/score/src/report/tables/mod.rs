//! Tables of the reports, one file each.

mod azimuth;
mod conditions;
mod defended;
mod effects;
mod figures;
mod looks;
mod order;
mod outcomes;
mod papers;
mod patterns;
mod protocol;
mod survival;
mod taken;
mod transfer;

use crate::figures::{Scores, Summary};
use crate::report::table::Table;
use crate::report::table::cell::Cell;

pub(super) use crate::report::tables::azimuth::by_azimuth;
pub(super) use crate::report::tables::conditions::conditions;
pub(super) use crate::report::tables::defended::defended;
pub(super) use crate::report::tables::effects::effects;
pub(super) use crate::report::tables::figures::figures;
pub(super) use crate::report::tables::figures::figures_of_screen;
pub(super) use crate::report::tables::looks::looks;
pub(super) use crate::report::tables::order::order;
pub(super) use crate::report::tables::outcomes::outcomes;
pub(super) use crate::report::tables::papers::papers;
pub(super) use crate::report::tables::patterns::by_pattern;
pub(super) use crate::report::tables::patterns::differences;
pub(super) use crate::report::tables::protocol::protocol;
pub(super) use crate::report::tables::survival::survival;
pub(super) use crate::report::tables::taken::taken;
pub(super) use crate::report::tables::transfer::transferred;

/// Returns the tables that a run has only on request.
pub(super) fn asked_for(scores: &Scores) -> Vec<Table> {
    let mut tables = conditions(scores);
    tables.extend(protocol(scores));
    tables.extend(scores.robustness.as_ref().map(survival));
    tables.extend(scores.defences.iter().flat_map(defended));
    tables.extend(scores.ranking.as_ref().map(|ranking| order(scores, ranking)));
    tables
}

/// Returns a block of rows for each detector, a row for each of its variants, with these cells behind the two names.
fn by_detector<'a>(
    scores: &'a Scores,
    cells: impl Fn(&'a Summary) -> Vec<Cell> + 'a,
) -> impl Iterator<Item = Vec<Vec<Cell>>> + 'a {
    let detectors = scores.summaries.chunk_by(|a, b| a.detector == b.detector);
    detectors.map(move |own| {
        let names = |s: &Summary| vec![Cell::text(scores.title(&s.detector)), Cell::text(&s.variant)];
        own.iter().map(|s| [names(s), cells(s)].concat()).collect()
    })
}
