//! All tables of a run's report.

use crate::report::Findings;
use crate::report::table::Table;
use crate::report::tables::{
    conditions, defended, effects, figures, figures_of_screen, order, outcomes, papers, protocol, survival, taken,
    transferred,
};

/// Largest number of columns of detectors or patterns that a laptop shows without scrolling.
pub const ACROSS: usize = 8;

/// The tables of a run's report; those of options are there on request.
pub struct RunTables {
    pub effects: Table,
    /// Figures that a screen has room for where nothing is compared.
    pub brief: Table,
    pub figures: Table,
    pub papers: Table,
    pub outcomes: Table,
    pub taken: Table,
    pub transferred: Vec<Table>,
    pub conditions: Vec<Table>,
    pub protocol: Option<Table>,
    pub survival: Option<Table>,
    pub defended: Option<[Table; 2]>,
    pub order: Option<Table>,
}

impl RunTables {
    pub fn new(findings: Findings) -> RunTables {
        let scores = findings.scores;
        RunTables {
            effects: effects(findings),
            brief: figures_of_screen(scores),
            figures: figures(findings),
            papers: papers(findings),
            outcomes: outcomes(scores),
            taken: taken(scores),
            transferred: transferred(findings, ACROSS),
            conditions: conditions(scores),
            protocol: protocol(scores),
            survival: scores.robustness.as_ref().map(survival),
            defended: scores.defences.as_ref().map(defended),
            order: scores.ranking.as_ref().map(|ranking| order(scores, ranking)),
        }
    }

    /// Returns the effects; the brief figures where nothing is compared.
    pub fn main(&self, findings: Findings) -> &Table {
        if findings.results.is_empty() {
            &self.brief
        } else {
            &self.effects
        }
    }

    /// Returns the tables that a run has only on request.
    pub fn on_request(&self) -> impl Iterator<Item = &Table> {
        let first = self.conditions.iter().chain(&self.protocol).chain(&self.survival);
        first.chain(self.defended.iter().flatten()).chain(&self.order)
    }
}
