//! Differences between variants on defended photos, and the changes by each defence.

use serde::Serialize;

use crate::figures::PairedDifference;

/// Name of the condition of photos that are no more than reduced.
pub const UNDEFENDED: &str = "none";

/// Every comparison under every defence.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Defences {
    /// In the order in which they were asked for.
    pub defences: Vec<DefenceCard>,
    /// Each variant against its base: by defence, `none` first, then base, variant and detector.
    pub rows: Vec<DefendedRow>,
    /// The photos of each variant with a defence (`other` in figures) against the same photos without (`base`): a negative drop is what the defence gives back.
    pub changes: Vec<DefendedRow>,
    /// Further cautions, as sentences.
    pub cautions: Vec<String>,
}

/// Description of a defence.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DefenceCard {
    pub name: String,
    /// Effect of the defence on the image.
    pub does: String,
    /// Source of the defence: authors and year; of a program, its own version and the SHA-256 of its files.
    pub source: String,
}

/// One comparison under a defence.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DefendedRow {
    /// `none`: the photo reduced to 640 px like the others, not defended.
    pub defence: String,
    #[serde(flatten)]
    pub difference: PairedDifference,
}
