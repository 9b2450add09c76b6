//! Detectors that are no network of this program: another program runs them, or has run them. Only their boxes are seen here.

use serde::{Deserialize, Serialize};

use super::manifest::{Channels, Head, Input, Kernel, Layout, Resize, Values, Weights};
use super::{Labels, Manifest};
use crate::files;

/// How the boxes of such a detector come here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ForeignKind {
    /// In files that it wrote.
    Results,
}

impl ForeignKind {
    /// What reports call it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            ForeignKind::Results => "results",
        }
    }
}

/// What is known of such a detector: enough to judge its boxes where it is not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForeignCard {
    pub kind: ForeignKind,
    pub name: String,
    pub title: String,
    pub licence: String,
    pub origin: String,
    #[serde(with = "in_words")]
    pub labels: Labels,
    /// Name and SHA-256 of the files that its boxes depend on.
    pub files: Vec<(String, String)>,
    /// What to know before believing its figures, as sentences.
    pub notes: Vec<String>,
}

impl ForeignCard {
    /// SHA-256 of all that is known of it.
    pub(crate) fn sha256(&self) -> String {
        files::sha256_hex(format!("{self:?}").as_bytes())
    }
}

impl Manifest {
    /// What stands for a manifest where no network is fed: the photo goes in as it is, and boxes come out.
    pub(crate) fn of_foreign(card: &ForeignCard) -> Manifest {
        Manifest {
            name: card.name.clone(),
            title: card.title.clone(),
            licence: card.licence.clone(),
            origin: card.origin.clone(),
            labels: card.labels,
            weights: Weights {
                file: String::new(),
                url: String::new(),
                sha256: card.sha256(),
            },
            input: Input {
                size_px: [0, 0],
                layout: Layout::Nhwc,
                values: Values::U8,
                resize: Resize::Original,
                kernel: Kernel::OpencvLinear,
                pad: 0,
                channels: Channels::Rgb,
                mean: [0.0; 3],
                std: [1.0; 3],
            },
            head: Head::Foreign {},
            class_map: Default::default(),
            folder: None,
        }
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
