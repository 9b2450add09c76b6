//! A session, opened with everything it refers to except the photos' pixels.

use std::path::{Path, PathBuf};

use crate::envelope::EnvelopeShape;
use crate::error::SessionError;
use crate::list::{PhotoEntry, SessionFile, check, syntax};
use scaleproof_core::files::{self, FileError};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;

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

impl Session {
    /// Opens the session in a folder (or its `session.json`) and checks all but the photos.
    pub fn open(place: &Path) -> Result<Session, SessionError> {
        let json = place.is_dir().then(|| place.join("session.json"));
        let path = json.unwrap_or_else(|| place.to_owned());
        Session::parse(&files::read_text(&path)?, &path)
    }

    /// Parses the text of the `session.json` at `path`, and checks all but the photos.
    pub(crate) fn parse(text: &str, path: &Path) -> Result<Session, SessionError> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let file: SessionFile = serde_json::from_str(text).map_err(|e| syntax(path, &e))?;
        let (scene, camera) = (folder.join(&file.scene), file.camera.map(|camera| folder.join(camera)));
        let hash = (files::name_of(path), files::sha256_hex(text.as_bytes()));
        let session = Session::assembled(path, &folder, &scene, camera.as_deref(), file.photos, vec![hash])?;
        let rendered = file.rendered;
        Ok(Session { rendered, ..session })
    }

    /// Assembles a session of these parts; `path` is named in messages about the list of photos, and `hashes` are those of its other sources.
    pub(crate) fn assembled(
        path: &Path,
        folder: &Path,
        scene_path: &Path,
        camera_path: Option<&Path>,
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
