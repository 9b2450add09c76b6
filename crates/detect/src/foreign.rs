//! Detectors that are no network of this program: another program runs them, or has run them. Only their boxes are seen here.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::manifest::{Input, Layout, Values, Weights};
use super::{Detection, HIGHEST_SCORE, Labels, Manifest};
use scaleproof_core::files;
use scaleproof_core::geometry::BoxPx;

/// The source of such a detector's boxes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ForeignKind {
    /// In files that it wrote.
    Results,
    /// From the running program.
    Program,
    /// From a function of the process that scores, such as a function of Python.
    Function,
}

impl ForeignKind {
    pub fn name(self) -> &'static str {
        match self {
            ForeignKind::Results => "results",
            ForeignKind::Program => "program",
            ForeignKind::Function => "function",
        }
    }
}

/// The description of such a detector: enough to judge its boxes where it is not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForeignCard {
    pub kind: ForeignKind,
    pub name: String,
    pub title: String,
    pub licence: String,
    pub origin: String,
    /// Version that a program states.
    pub version: Option<String>,
    /// Command line of a program; empty for others.
    pub command: Vec<String>,
    #[serde(with = "in_words")]
    pub labels: Labels,
    /// Labels that count as others: own label → label of the scene.
    pub class_map: BTreeMap<String, String>,
    /// Name and SHA-256 of the files that its boxes depend on.
    pub files: Vec<(String, String)>,
    /// Cautions about its figures, as sentences.
    pub notes: Vec<String>,
}

impl ForeignCard {
    /// SHA-256 of all that is known of it.
    pub fn sha256(&self) -> String {
        files::sha256_hex(format!("{self:?}").as_bytes())
    }
}

impl Manifest {
    /// Creates what stands for a manifest where no network is fed: the photo goes in as it is, and boxes come out.
    pub fn of_foreign(card: &ForeignCard) -> Manifest {
        let input = Input::unchanged(Layout::Nhwc, Values::U8);
        Manifest {
            title: card.title.clone(),
            licence: card.licence.clone(),
            origin: card.origin.clone(),
            weights: Weights {
                sha256: card.sha256(),
                ..Weights::default()
            },
            class_map: card.class_map.clone(),
            ..Manifest::unstated(&card.name, card.labels, input)
        }
    }
}

/// Rounding a box to whole pixels explains so much over the border.
const ROUNDING_PX: f64 = 1.0;
/// No detector is this sure of a box that reaches out of its photo by more than [`FAR_OUT`] of a side.
const SURE: f64 = 0.5;
const FAR_OUT: f64 = 0.1;

/// A detection of another program in the precision that files keep, cut at the border of its photo; `None` for a box without an area.
///
/// # Errors
/// Why it cannot be one of a photo of this size, in px.
pub(super) fn placed(label: usize, score: f64, b: BoxPx, size: [u32; 2]) -> Result<Option<Detection>, String> {
    check_score(score)?;
    let ([width, height], corners) = (size.map(f64::from), <[f64; 4]>::from(b));
    if !corners.iter().all(|v| v.is_finite()) {
        return Err(format!("the box {corners:?}, which is not finite"));
    }
    let reaches_out_px = (-b.x1).max(-b.y1).max(b.x2 - width).max(b.y2 - height);
    let clipped = b.clipped(width, height);
    let fault = if !clipped.is_solid() && b.is_solid() {
        Some("lies outside")
    } else {
        let is_far = reaches_out_px > FAR_OUT * width.max(height) && score >= SURE;
        is_far.then_some("reaches far out of")
    };
    if let Some(fault) = fault {
        let [x1, y1, x2, y2] = corners.map(|v| format!("{v:.1}"));
        return Err(format!(
            "a box of confidence {score} from x, y = {x1}, {y1} to {x2}, {y2} {fault} the photo of {width}×{height} px: was the image of another \
             size, or are these corners (x1, y1, x2, y2) where COCO has x, y, width, height?"
        ));
    }
    let inside = if reaches_out_px > ROUNDING_PX { clipped } else { b };
    Ok(Detection::new(label, score.min(1.0), inside))
}

/// Returns what follows a sentence on an image of another size than its photo: where the sides are swapped, that `who` did not turn it.
pub(super) fn turned_hint(who: &str, [w, h]: [u32; 2], photo: [u32; 2]) -> String {
    let hint = ([h, w] == photo).then(|| format!(": {who} did not turn it as its EXIF says"));
    hint.unwrap_or_default()
}

/// Refuses what is no confidence.
pub(super) fn check_score(score: f64) -> Result<(), String> {
    if (0.0..=HIGHEST_SCORE).contains(&score) {
        Ok(())
    } else if (1.0..=100.0).contains(&score) {
        Err(format!(
            "the confidence {score} is above 1: divide it by 100 if it counts per cent; confidences go from 0 to 1"
        ))
    } else {
        Err(format!("the confidence {score} is none: confidences go from 0 to 1"))
    }
}

/// Labels as the text that a manifest has: shards know no other way to tell a list's name from a list.
mod in_words {
    use serde::{Deserialize, Deserializer, Serializer, de, ser};

    use super::Labels;

    pub(super) fn serialize<S: Serializer>(labels: &Labels, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&serde_json::to_string(labels).map_err(ser::Error::custom)?)
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Labels, D::Error> {
        serde_json::from_str(&String::deserialize(from)?).map_err(de::Error::custom)
    }
}
