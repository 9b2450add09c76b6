//! What lights the model: a panorama, turned about the vertical.

use std::path::PathBuf;
use std::str::FromStr;

use super::RenderError;
use crate::require;

/// The panoramas that come with Blender 4.5.
const OWN: &str = "city courtyard forest interior night studio sunrise sunset";

#[derive(Debug, Clone, PartialEq)]
pub struct Panorama {
    /// `None` for one of Blender's own, which `name` names.
    pub file: Option<PathBuf>,
    pub name: String,
    /// How far the panorama is turned about the vertical.
    pub turn_deg: f64,
}

impl FromStr for Panorama {
    type Err = RenderError;

    /// `NAME` or `FILE`, and `@DEGREES`.
    fn from_str(text: &str) -> Result<Self, RenderError> {
        let bad = || RenderError::BadLight { text: text.to_owned() };
        let (source, turn) = text.rsplit_once('@').unwrap_or((text, "0"));
        let turn_deg: f64 = turn.parse().map_err(|_| bad())?;
        let path = PathBuf::from(source);
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let file = extension.is_some_and(|e| e == "exr" || e == "hdr");
        let stem = if file { path.file_stem() } else { Some(source.as_ref()) };
        let name = stem.ok_or_else(bad)?.to_string_lossy().into_owned();
        let is_known = file || OWN.split(' ').any(|own| own == source);
        require(is_known && (0.0..360.0).contains(&turn_deg), bad)?;
        let is_plain = name.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c)) && !name.starts_with('.');
        if !is_plain {
            return Err(RenderError::BadLightName { name });
        }
        Ok(Self {
            file: file.then_some(path),
            name,
            turn_deg,
        })
    }
}

impl Panorama {
    /// How frames call it, as the light and as the place: another turn is another place under the same light.
    pub fn place(&self) -> String {
        format!("{}@{}", self.name, self.turn_deg)
    }
}
