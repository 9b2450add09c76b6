//! The card of a pattern: a JSON file beside its PNG, of the same name, that says how large a repeat is meant to be and
//! where the pattern comes from.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Pattern;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::length::{is_size, shown};

/// Content of every card; makers add what they know.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Card {
    pub pattern_sha256: String,
    /// Width of one repeat on the model.
    pub tile_mm: f64,
    /// True if the patterns of the model's sides lie below each other: a texture of that model, and no pattern that is repeated.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sides: bool,
    /// Further entries by its maker.
    #[serde(flatten)]
    pub about: serde_json::Map<String, serde_json::Value>,
}

/// Reason why a pattern has no tile size.
#[derive(Debug, thiserror::Error)]
pub enum CardError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{path} is no card of a pattern ({reason})", path = path.display())]
    Content { path: PathBuf, reason: String },
    #[error("{path} is the card of another pattern than {pattern}", path = path.display(), pattern = pattern.display())]
    OtherPattern { path: PathBuf, pattern: PathBuf },
    #[error("{pattern} has no card that says how wide a repeat is", pattern = pattern.display())]
    None { pattern: PathBuf },
    #[error("{pattern} is a pattern for each side of the model (so says its card), and none that is repeated", pattern = pattern.display())]
    OfSides { pattern: PathBuf },
}

impl Card {
    pub fn path(pattern: &Path) -> PathBuf {
        pattern.with_extension("json")
    }

    /// Returns path and content of the card's file.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn to_file(&self, pattern: &Path) -> Result<(PathBuf, Vec<u8>), serde_json::Error> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        Ok((Self::path(pattern), text.into_bytes()))
    }
}

/// Returns the width of a repeat: as given, else as the pattern's card says.
pub fn tile_mm(given: Option<f64>, path: &Path, pattern: &Pattern) -> Result<f64, CardError> {
    match (card(path, pattern), given) {
        (Ok(Card { sides: true, .. }), _) => Err(CardError::OfSides {
            pattern: path.to_owned(),
        }),
        (_, Some(tile_mm)) => Ok(tile_mm),
        (found, None) => Ok(found?.tile_mm),
    }
}

/// Returns true if the card beside a PNG says that it is of sides, be it this PNG's or another one's.
pub fn says_sides(path: &Path) -> bool {
    let text = files::read_text(&Card::path(path)).ok();
    let card = text.and_then(|text| serde_json::from_str::<Card>(&text).ok());
    card.is_some_and(|card| card.sides)
}

/// Reads the card of a pattern.
pub fn card(path: &Path, pattern: &Pattern) -> Result<Card, CardError> {
    let card = Card::path(path);
    if !card.is_file() {
        return Err(CardError::None {
            pattern: path.to_owned(),
        });
    }
    let bad = |reason: String| CardError::Content {
        path: card.clone(),
        reason,
    };
    let found: Card = serde_json::from_str(&files::read_text(&card)?).map_err(|e| bad(e.to_string()))?;
    if found.pattern_sha256 != pattern.sha256() {
        return Err(CardError::OtherPattern {
            path: card,
            pattern: path.to_owned(),
        });
    }
    if is_size(found.tile_mm) {
        Ok(found)
    } else {
        Err(bad(format!("its tile_mm is {}", shown(found.tile_mm))))
    }
}
