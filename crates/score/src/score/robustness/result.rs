//! What is left of the differences when photos get worse.

use serde::Serialize;

use crate::score::{Compared, Difference, Finding};

/// Every comparison at every severity.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Robustness {
    /// By corruption, severity (from 0), then base, variant and detector.
    pub rows: Vec<CorruptedRow>,
    /// How far the drop of AP goes, for each corruption, base, variant and detector.
    pub survival: Vec<Survival>,
    /// What a reader must know besides, as sentences.
    pub cautions: Vec<String>,
}

impl Robustness {
    /// Their names, in the order in which they were asked for.
    pub fn corruptions(&self) -> Vec<&'static str> {
        let mut names: Vec<&str> = self.rows.iter().map(|row| row.corruption).collect();
        names.dedup();
        names
    }
}

/// A variant against its base on photos of one severity.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CorruptedRow {
    /// What makes the photos worse (scoring.md lists it).
    pub corruption: &'static str,
    /// 0 to 5; 0 is the photo reduced to 640 px like the others, no worse.
    pub severity: u8,
    /// What the severity means; empty for severity 0.
    pub amount: String,
    #[serde(flatten)]
    pub held: Held,
}

/// A variant against its base, on photos of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Held {
    pub base: String,
    pub variant: String,
    pub detector: String,
    /// Pairs of photos.
    pub pairs: usize,
    pub ap50: Difference,
    pub hit_rate: Difference,
    pub mean_confidence: Difference,
}

impl Held {
    pub(super) fn new(base: &str, compared: Compared) -> Self {
        Self {
            base: base.to_owned(),
            variant: compared.variant,
            detector: compared.detector,
            pairs: compared.pairs,
            ap50: compared.ap50,
            hit_rate: compared.hit_rate.rate,
            mean_confidence: compared.mean_confidence,
        }
    }

    /// Whether it compares the same variants by the same detector.
    pub(super) fn is_as(&self, other: &Self) -> bool {
        [&self.base, &self.variant, &self.detector] == [&other.base, &other.variant, &other.detector]
    }

    /// Takes back what is shown where it is not among the comparisons of the photos as they are, of which fewer things are asked.
    pub(super) fn gate(&mut self, clean: &[Held]) {
        if !clean
            .iter()
            .any(|other| other.is_as(self) && other.ap50.finding.is_shown())
        {
            let figures = [&mut self.ap50, &mut self.hit_rate, &mut self.mean_confidence];
            figures.into_iter().for_each(|d| d.finding = d.finding.undone());
        }
    }
}

/// How far a drop of AP goes.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Survival {
    pub corruption: &'static str,
    pub base: String,
    pub variant: String,
    pub detector: String,
    /// The severities at which a drop of AP is shown.
    pub shown_at: Vec<u8>,
    /// The severities at which the base itself has an AP below 0.2, which leaves hardly anything to drop.
    pub base_lost_at: Vec<u8>,
    /// The severities at which the pairs are too few to tell.
    pub too_few_at: Vec<u8>,
}

/// An AP of the base that leaves no room for a drop.
pub const BASE_LOST: f64 = 0.2;

impl Survival {
    /// Of the rows of one corruption and comparison, in the order of severities.
    pub(super) fn of<'a>(first: &CorruptedRow, own: impl Iterator<Item = &'a CorruptedRow> + Clone) -> Self {
        let at =
            |is: &dyn Fn(&CorruptedRow) -> bool| own.clone().filter(|row| is(row)).map(|row| row.severity).collect();
        Self {
            corruption: first.corruption,
            base: first.held.base.clone(),
            variant: first.held.variant.clone(),
            detector: first.held.detector.clone(),
            shown_at: at(&|row| row.held.ap50.finding == Finding::Drop),
            base_lost_at: at(&|row| row.held.ap50.base < BASE_LOST),
            too_few_at: at(&|row| row.held.ap50.finding == Finding::TooFewPhotosToTell),
        }
    }
}
