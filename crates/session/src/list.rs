//! The list of a session's photos, as `session.json` has it, and its checks.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::conditions::{self, Conditions};
use scaleproof_core::files::FileError;
use scaleproof_core::geometry::BoxPx;
use scaleproof_pose::scene::Viewpoint;

/// Photo of a session, as listed in `session.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhotoEntry {
    /// Path from the session's folder, as `a.jpg` or `../photos/a.jpg`.
    pub file: String,
    /// Texture on the model; `normal` is the unpatterned one.
    pub variant: String,
    /// Place where the photo was taken; photos of one place are not independent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// RFC 3339 time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taken: Option<String>,
    /// Known ground truth box (of a simulator, say), instead of one from the pose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box_xyxy_px: Option<BoxPx>,
    /// Known viewpoint, instead of a pose from the tags.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viewpoint: Option<Viewpoint>,
    /// Weather, light and other conditions for grouping.
    #[serde(
        default,
        skip_serializing_if = "Conditions::is_empty",
        deserialize_with = "conditions::read"
    )]
    pub conditions: Conditions,
    /// Frame of a video that the photo is, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<VideoFrame>,
}

/// Frame of a video that a photo was taken from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VideoFrame {
    /// Name of the video.
    pub video: String,
    /// SHA-256 of the video, hex.
    pub sha256: String,
    /// Number of the frame in display order, from 0.
    pub number: u64,
    /// Display time, s since the start of the video.
    pub time_s: f64,
}

/// Content of a `session.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SessionFile {
    pub scene: PathBuf,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<PathBuf>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rendered: bool,
    pub photos: Vec<PhotoEntry>,
}

impl SessionFile {
    pub(crate) fn to_json(&self, path: &Path) -> Result<String, FileError> {
        Ok(serde_json::to_string_pretty(self).map_err(|e| syntax(path, &e))? + "\n")
    }
}

/// Returns the error of a `session.json` that cannot be parsed.
pub(crate) fn syntax(path: &Path, e: &serde_json::Error) -> FileError {
    FileError::syntax(path, e.line(), parse_message(e, "a session"))
}

/// Returns the message of a parser without its place.
pub(crate) fn parse_message(e: &serde_json::Error, what: &str) -> String {
    let text = e.to_string();
    match text.split(" at line ").next().unwrap_or(&text) {
        // serde's own message for a list in place of an object.
        inside if inside.contains("expected struct") => {
            format!("an object {{…}} with the keys of {what} belongs here")
        }
        message => message.to_owned(),
    }
}

/// Checks the list of photos, and that each can get a viewpoint.
pub(crate) fn check(photos: &[PhotoEntry], has_camera: bool) -> Result<(), String> {
    if photos.is_empty() {
        return Err("it lists no photos".into());
    }
    let mut files = HashSet::new();
    for photo in photos {
        if !files.insert(&photo.file) {
            return Err(format!("{} is listed twice: each photo counts once", photo.file));
        }
        check_photo(photo)?;
    }
    let needs_camera = |p: &&PhotoEntry| p.box_xyxy_px.is_none() || p.viewpoint.is_none();
    match photos.iter().find(needs_camera).filter(|_| !has_camera) {
        Some(photo) => Err(format!(
            "it names no camera, and {} has not both box_xyxy_px and viewpoint: name the camera file (--camera), or give both for every photo",
            photo.file
        )),
        None => Ok(()),
    }
}

/// Checks one photo of a list.
pub(crate) fn check_photo(photo: &PhotoEntry) -> Result<(), String> {
    let (file, variant) = (&photo.file, &photo.variant);
    if !leads_from_folder(file) {
        return Err(format!(
            "{file:?} is no path from the session's folder: write it as photos/a.jpg or ../photos/a.jpg"
        ));
    }
    if variant.trim().is_empty() {
        return Err(format!(
            "{file} has no variant: name the texture on the model, e.g. normal"
        ));
    }
    for (what, name) in [("variant", Some(variant)), ("place", photo.place.as_ref())] {
        let is_wrong = |name: &&String| name.trim() != *name || name.chars().any(char::is_control);
        if let Some(name) = name.filter(is_wrong) {
            return Err(format!(
                "the {what} {name:?} of {file} has blanks around it or control characters: remove them"
            ));
        }
    }
    if let Some(name) = photo.conditions.keys().find(|name| !conditions::is_name(name)) {
        return Err(format!(
            "the condition {name:?} of {file} has a name that cannot be used: write letters, digits, blanks, `_`, `-` and `.`"
        ));
    }
    if photo.box_xyxy_px.is_some_and(|b| !b.is_solid()) {
        return Err(format!(
            "box_xyxy_px of {file} is empty: give [x1, y1, x2, y2] in pixels"
        ));
    }
    BoxPx::check_counts_pixels(photo.box_xyxy_px).map_err(|why| format!("the box of {file}: {why}"))?;
    match photo.viewpoint {
        Some(v) if !v.is_possible() => Err(format!(
            "the viewpoint of {file} is impossible: azimuth_deg is in [0, 360), pitch_deg in [-90, 90], distance_mm above 0"
        )),
        _ => Ok(()),
    }
}

/// Returns true for a path that goes up, if at all, and then down to a file. Photos are only read, so they may be anywhere; written files go into the
/// session's folder under names of their own.
fn leads_from_folder(file: &str) -> bool {
    let parts = Path::new(file).components();
    let mut down = parts.skip_while(|part| *part == Component::ParentDir).peekable();
    down.peek().is_some() && down.all(|part| matches!(part, Component::Normal(_)))
}
