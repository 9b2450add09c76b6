//! Panoramas that light the model, turned about the vertical.

use std::path::PathBuf;
use std::str::FromStr;

use scaleproof_core::message::{Message, ensure, message};

/// The panoramas that come with Blender 4.5.
const OWN: &str = "city courtyard forest interior night studio sunrise sunset";

/// Panorama that lights the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Panorama {
    /// `None` for one of Blender's own, which `name` names.
    pub file: Option<PathBuf>,
    pub name: String,
    /// Turn about the vertical, [0, 360).
    pub turn_deg: f64,
}

impl FromStr for Panorama {
    type Err = Message;

    /// `NAME` or `FILE`, and `@DEGREES`.
    fn from_str(text: &str) -> Result<Self, Message> {
        let bad = || {
            message!(
                "light '{text}' is not understood; write one of Blender's (city, courtyard, forest, interior, night, studio, sunrise, sunset) or an .exr \
                 or .hdr file, and a turn from 0 up to 360 degrees if you like, as in forest@90"
            )
        };
        let (source, turn) = text.rsplit_once('@').unwrap_or((text, "0"));
        let turn_deg: f64 = turn.parse().map_err(|_| bad())?;
        let path = PathBuf::from(source);
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let file = extension.is_some_and(|e| e == "exr" || e == "hdr");
        let stem = if file { path.file_stem() } else { Some(source.as_ref()) };
        let name = stem.ok_or_else(bad)?.to_string_lossy().into_owned();
        let is_known = file || OWN.split(' ').any(|own| own == source);
        if !is_known || !(0.0..360.0).contains(&turn_deg) {
            return Err(bad());
        }
        let is_plain = name.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c)) && !name.starts_with('.');
        ensure!(
            is_plain,
            "a light's file cannot be called {name:?}; rename it to letters, digits, '-', '_' and '.'"
        );
        Ok(Self {
            file: file.then_some(path),
            name,
            turn_deg,
        })
    }
}

impl Panorama {
    /// Returns the `place` of its frames: another turn is another place under the same light.
    pub fn place(&self) -> String {
        format!("{}@{}", self.name, self.turn_deg)
    }
}
