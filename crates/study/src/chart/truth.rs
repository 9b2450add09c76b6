//! Exact truth of a session's photos: the parts of its `truth.json` that methods are measured against.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::message;
use scaleproof_pose::locate::Sigma;
use scaleproof_pose::scene::Viewpoint;

/// A truth file. Other keys are ignored: the files carry views, boxes and poses.
#[derive(Deserialize)]
struct TruthFile<T> {
    photos: Vec<AboutPhoto<T>>,
}

#[derive(Deserialize)]
struct AboutPhoto<T> {
    file: String,
    #[serde(flatten)]
    truth: T,
}

#[derive(Deserialize)]
struct TrueBox {
    box_xyxy_px: BoxPx,
}

/// The σ of an exact truth.
pub(super) const EXACT: Sigma = Sigma {
    azimuth_deg: 0.0,
    pitch_deg: 0.0,
    distance_mm: 0.0,
};

#[derive(Deserialize)]
struct TruthSigma {
    sigma: Option<Sigma>,
}

/// Reads the true viewpoints of some photos, in their order.
pub fn true_views(path: &Path, files: &[&str]) -> Result<Vec<Viewpoint>, FileError> {
    let keys = "\"azimuth_deg\": …, \"pitch_deg\": …, \"distance_mm\": …";
    about(path, files, keys, |view: &Viewpoint| *view)
}

/// Reads the standard deviations of the true viewpoints themselves, where the file states them as `sigma`; 0 otherwise.
pub(super) fn true_sigmas(path: &Path, files: &[&str]) -> Result<Vec<Sigma>, FileError> {
    let keys = "\"sigma\": {\"azimuth_deg\": …, \"pitch_deg\": …, \"distance_mm\": …}";
    about(path, files, keys, |truth: &TruthSigma| truth.sigma.unwrap_or(EXACT))
}

/// Reads the exact boxes around the model's outline in some photos, in their order, px.
pub fn true_boxes(path: &Path, files: &[&str]) -> Result<Vec<BoxPx>, FileError> {
    let keys = "\"box_xyxy_px\": [x1, y1, x2, y2]";
    about(path, files, keys, |truth: &TrueBox| truth.box_xyxy_px)
}

fn about<T: DeserializeOwned, R>(
    path: &Path,
    files: &[&str],
    keys: &'static str,
    read: impl Fn(&T) -> R,
) -> Result<Vec<R>, FileError> {
    let text = files::read_text(path)?;
    let truth: TruthFile<T> = serde_json::from_str(&text).map_err(|e| {
        let path = path.display();
        message!("{path} is no truth file ({e}); write {{\"photos\": [{{\"file\": …, {keys}}}]}}")
    })?;
    let of_photo = |file: &&str| {
        let about = truth.photos.iter().find(|about| about.file == *file);
        let missing = || {
            let path = path.display();
            message!("{path} says nothing about {file}; add it, or chart a session whose photos it knows").into()
        };
        about.map(|about| read(&about.truth)).ok_or_else(missing)
    };
    files.iter().map(of_photo).collect()
}
