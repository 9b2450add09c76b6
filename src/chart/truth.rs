//! Where the camera truly stood: the part of a session's `truth.json` that poses are measured against.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::files;
use crate::scene::Viewpoint;

/// Why there is no truth to measure against.
#[derive(Debug, thiserror::Error)]
pub enum TruthError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error(
        "{path} is no truth file ({reason}); write {{\"photos\": [{{\"file\": …, \"azimuth_deg\": …, \"pitch_deg\": …, \"distance_mm\": …}}]}}",
        path = path.display()
    )]
    Content { path: PathBuf, reason: String },
    #[error("{path} says nothing about {file}; add it, or chart a session whose photos it knows", path = path.display())]
    Missing { path: PathBuf, file: String },
}

/// Other keys are passed over: the files carry boxes and poses too.
#[derive(Deserialize)]
struct TruthFile {
    photos: Vec<TrueView>,
}

#[derive(Deserialize)]
struct TrueView {
    file: String,
    azimuth_deg: f64,
    pitch_deg: f64,
    distance_mm: f64,
}

/// The true viewpoints of some photos, in their order.
///
/// # Errors
/// An unreadable file, one that is no truth file, a photo it does not know.
pub fn true_views(path: &Path, files: &[&str]) -> Result<Vec<Viewpoint>, TruthError> {
    let text = files::read_text(path)?;
    let refuse = |reason: String| TruthError::Content {
        path: path.to_owned(),
        reason,
    };
    let truth: TruthFile = serde_json::from_str(&text).map_err(|e| refuse(e.to_string()))?;
    files
        .iter()
        .map(|file| {
            let view = truth.photos.iter().find(|view| view.file == *file);
            let view = view.ok_or_else(|| TruthError::Missing {
                path: path.to_owned(),
                file: (*file).to_owned(),
            })?;
            Ok(Viewpoint {
                azimuth_deg: view.azimuth_deg,
                pitch_deg: view.pitch_deg,
                distance_mm: view.distance_mm,
            })
        })
        .collect()
}
