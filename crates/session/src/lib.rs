//! Stored photo sets, and the ground truth boxes of their photos by scene and pose ([`envelope`]).
//!
//! A session is a folder with `session.json`, which names the photos, the scene and the camera; or it is made of folders of photos as they are.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_session::Session;
//!
//! let session = Session::open(Path::new("../../captures/skyline"))?;
//! assert_eq!(session.photos.len(), 24);
//! # Ok::<(), scaleproof_session::SessionError>(())
//! ```

pub mod envelope;
pub mod overlay;

pub mod conditions;
pub mod contents;
pub mod filling;
pub mod folders;
pub mod import;
pub mod new;

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::envelope::{EnvelopeError, EnvelopeShape};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_pose::camera::{Camera, CameraError};
use scaleproof_pose::scene::{Scene, Viewpoint};

pub use conditions::Conditions;
pub use new::{NewSession, NewSessionError, files_below};

/// Reason why a session could not be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Envelope(#[from] EnvelopeError),
}

/// Session with everything it refers to, except the photos' pixels.
#[derive(Debug, Clone)]
pub struct Session {
    /// Name of the session's folder.
    pub name: String,
    /// Folder to which the photos' paths are relative.
    pub folder: PathBuf,
    /// Path of the mesh that the scene names, if any.
    pub mesh_path: Option<PathBuf>,
    /// Path of the scene file.
    pub scene_path: PathBuf,
    /// Path of the camera file.
    pub camera_path: Option<PathBuf>,
    /// Model, tags and bins.
    pub scene: Scene,
    /// Shape of the ground truth boxes, by the scene's envelope.
    pub outline: EnvelopeShape,
    /// Camera; absent only if every photo has its ground truth box and viewpoint.
    pub camera: Option<Camera>,
    /// True if a program rendered the photos, instead of a camera.
    pub rendered: bool,
    /// Photos in the order of the file.
    pub photos: Vec<PhotoEntry>,
    /// File name and SHA-256 of `session.json`, the scene, its mesh and the camera file, for provenance.
    pub hashes: Vec<(String, String)>,
}

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

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SessionFile {
    scene: PathBuf,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    camera: Option<PathBuf>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    rendered: bool,
    photos: Vec<PhotoEntry>,
}

impl SessionFile {
    fn to_json(&self, path: &Path) -> Result<String, SessionError> {
        Ok(serde_json::to_string_pretty(self).map_err(|e| syntax(path, &e))? + "\n")
    }
}

impl Session {
    /// Opens the session in a folder (or its `session.json`) and checks all but the photos.
    pub fn open(place: &Path) -> Result<Session, SessionError> {
        let json = place.is_dir().then(|| place.join("session.json"));
        let path = json.unwrap_or_else(|| place.to_owned());
        Session::parse(&files::read_text(&path)?, &path)
    }

    /// Parses the text of the `session.json` at `path`, and checks all but the photos.
    fn parse(text: &str, path: &Path) -> Result<Session, SessionError> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let file: SessionFile = serde_json::from_str(text).map_err(|e| syntax(path, &e))?;
        let (scene, camera) = (folder.join(&file.scene), file.camera.map(|camera| folder.join(camera)));
        let hash = (files::name_of(path), files::sha256_hex(text.as_bytes()));
        let session = Session::assembled(path, &folder, (&scene, camera.as_deref()), file.photos, vec![hash])?;
        let rendered = file.rendered;
        Ok(Session { rendered, ..session })
    }

    /// Assembles a session of these parts; `path` is named in messages about the list of photos, and `hashes` are those of its other sources.
    fn assembled(
        path: &Path,
        folder: &Path,
        (scene_path, camera_path): (&Path, Option<&Path>),
        photos: Vec<PhotoEntry>,
        mut hashes: Vec<(String, String)>,
    ) -> Result<Session, SessionError> {
        check(&photos, camera_path.is_some()).map_err(|message| FileError::content(path, message))?;
        let scene = Scene::open(scene_path)?;
        let camera = camera_path.map(Camera::open).transpose()?;
        let scene_folder = scene_path.parent().unwrap_or(Path::new("")).to_owned();
        let outline = EnvelopeShape::open(&scene.model, &scene_folder)?;
        let mesh_path = scene.model.envelope.mesh().map(|mesh| scene_folder.join(mesh));
        let read = [Some(scene_path), mesh_path.as_deref(), camera_path];
        for read in read.into_iter().flatten() {
            hashes.push(files::hashed(read)?);
        }
        photos
            .iter()
            .for_each(|photo| files::inputs::note(&folder.join(&photo.file)));
        let real = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        Ok(Session {
            name: real.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            folder: folder.to_owned(),
            mesh_path,
            scene_path: scene_path.to_owned(),
            camera_path: camera_path.map(Path::to_owned),
            scene,
            outline,
            camera,
            rendered: false,
            photos,
            hashes,
        })
    }

    /// Returns the camera, for locating photos.
    ///
    /// # Errors
    /// The session names none.
    pub fn known_camera(&self) -> Result<&Camera, SessionError> {
        let lack = "this session names no camera, so its photos cannot be located: name one in its session.json";
        let camera = self.camera.as_ref();
        Ok(camera.ok_or_else(|| FileError::content(&self.folder, lack))?)
    }

    /// Returns the path of a photo.
    pub fn photo_path(&self, entry: &PhotoEntry) -> PathBuf {
        self.folder.join(&entry.file)
    }
}

/// Returns the text of a `session.json` at a path, with scene and camera files relative to its folder. It is read back as a check.
pub fn text(
    path: &Path,
    scene: &str,
    camera: Option<&str>,
    photos: Vec<PhotoEntry>,
    rendered: bool,
) -> Result<String, SessionError> {
    let file = SessionFile {
        scene: scene.into(),
        camera: camera.map(Into::into),
        rendered,
        photos,
    };
    let text = file.to_json(path)?;
    Session::parse(&text, path)?;
    Ok(text)
}

fn syntax(path: &Path, e: &serde_json::Error) -> FileError {
    FileError::syntax(path, e.line(), words(e, "a session"))
}

fn words(e: &serde_json::Error, what: &str) -> String {
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
fn check(photos: &[PhotoEntry], has_camera: bool) -> Result<(), String> {
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

fn check_photo(photo: &PhotoEntry) -> Result<(), String> {
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
