//! Creation of a session on disk: `session.json` with copies of the scene and the camera, for photos that stay in place or are copied too.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use crate::error::SessionError;
use crate::folders::{Gathered, joined, text_path};
use crate::list::{PhotoEntry, SessionFile, syntax};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{bail, message};
use scaleproof_pose::scene::Scene;

/// Sources and folder of a new session.
#[derive(Debug, Clone, Copy)]
pub struct NewSession<'a> {
    pub folder: &'a Path,
    /// Photos by [`super::folders::gather`], with the scene and the camera below.
    pub photos: &'a Gathered,
    pub scene: &'a Path,
    pub camera: &'a Path,
    /// True to copy the photos into the session instead of referring to them.
    pub copy: bool,
}

enum Content {
    Bytes(Vec<u8>),
    CopyOf(PathBuf),
}

type Files = Vec<(PathBuf, Content)>;

impl NewSession<'_> {
    /// Writes the session, completely or not at all, and returns the path of its `session.json` and its photos. An existing folder keeps its files,
    /// and an existing session gets the photos in addition to its own.
    ///
    /// # Errors
    /// Files in the way, photos that the session has already, a file that cannot be read or written.
    pub fn write(&self) -> Result<(PathBuf, Vec<PhotoEntry>), SessionError> {
        let path = self.folder.join("session.json");
        if path.exists() {
            return Ok((path.clone(), self.add_to(&path)?));
        }
        let is_new = is_free(self.folder)?;
        if self.copy && !is_new {
            bail!("{} has files already", self.folder.display(); hint: "with ‹copy› name a new folder");
        }
        let home = real_place(self.folder)?;
        let mut files = Files::new();
        let (scene, camera) = (self.scene(&home, &mut files)?, self.camera(&home, &mut files)?);
        let photos = self.photos(&home, &mut files)?;
        let camera = Some(camera);
        let list = SessionFile {
            scene,
            camera,
            rendered: false,
            photos,
        };
        files.push(("session.json".into(), Content::Bytes(list.to_json(&path)?.into_bytes())));
        if is_new {
            let write =
                |(name, content): &(PathBuf, Content), folder: &Path| write(folder, &folder.join(name), content);
            files::make_folder(&home, |folder| files.iter().try_for_each(|file| write(file, folder)))?
        } else {
            self.write_beside(files)?
        }
        Ok((path, list.photos))
    }

    /// Adds the photos to the session of a `session.json`, with their copies in new folders; returns all of its photos.
    fn add_to(&self, path: &Path) -> Result<Vec<PhotoEntry>, SessionError> {
        let (home, mut files) = (real_place(self.folder)?, Files::new());
        let text = files::read_text(path)?;
        let mut list: SessionFile = serde_json::from_str(&text).map_err(|e| syntax(path, &e))?;
        let new = self.photos(&home, &mut files)?;
        if let Some(twice) = new
            .iter()
            .find(|photo| list.photos.iter().any(|old| old.file == photo.file))
        {
            let folder = self.folder.display();
            bail!("{folder} has {} already: each photo counts once", twice.file);
        }
        list.photos.extend(new);
        let in_folder = |(name, _): &(PathBuf, Content)| name.parent().map(Path::to_owned).unwrap_or_default();
        let text = list.to_json(path)?;
        let mut made = Vec::new();
        let mut write_all = || {
            for copies in files.chunk_by(|a, b| in_folder(a) == in_folder(b)) {
                let folder = home.join(in_folder(&copies[0]));
                files::chosen::check_folder(&home, &folder)?;
                files::make_folder(&folder, |inside| {
                    let to = |name: &Path| inside.join(name.file_name().unwrap_or_default());
                    copies
                        .iter()
                        .try_for_each(|(name, content)| write(inside, &to(name), content))
                })?;
                made.push(folder);
            }
            files::replace_atomically(self.folder, path, text.as_bytes())
        };
        if let Err(e) = write_all() {
            // Copies that no list names would be unidentifiable.
            made.iter()
                .for_each(|folder| drop(files::chosen::remove_folder(&home, folder)));
            return Err(e.into());
        }
        Ok(list.photos)
    }

    /// Writes files into a folder that has files already.
    fn write_beside(&self, files: Files) -> Result<(), SessionError> {
        let mut contents = Vec::new();
        for (name, content) in files {
            let path = self.folder.join(name);
            let Content::Bytes(bytes) = content else { continue };
            if !path.exists() {
                contents.push((path, bytes));
            } else if files::read(&path)? != bytes {
                let path = path.display();
                bail!("{path} is there already and another file: name a new folder for the session");
            }
        }
        Ok(files::replace_all_atomically(self.folder, &contents)?)
    }

    /// Returns the path of the scene in the session: its own if it is inside, else a copy with its mesh.
    fn scene(&self, home: &Path, files: &mut Files) -> Result<PathBuf, SessionError> {
        if let Some(inside) = inside(self.scene, home) {
            return Ok(inside);
        }
        files.push(("scene.toml".into(), Content::Bytes(files::read(self.scene)?)));
        let below = files_below(&self.photos.session.scene).map_err(|mesh| {
            message!(
                "the scene's mesh {} does not lie below the scene's folder, so that it cannot be copied into the session: put it there",
                mesh.display()
            )
        })?;
        for file in below {
            let read = files::read(&self.scene.with_file_name(&file))?;
            files.push((file, Content::Bytes(read)));
        }
        Ok("scene.toml".into())
    }

    fn camera(&self, home: &Path, files: &mut Files) -> Result<PathBuf, SessionError> {
        if let Some(inside) = inside(self.camera, home) {
            return Ok(inside);
        }
        let ending = self.camera.extension().map_or("yaml".into(), |e| e.to_string_lossy());
        let name = PathBuf::from(format!("camera.{ending}"));
        files.push((name.clone(), Content::Bytes(files::read(self.camera)?)));
        Ok(name)
    }

    /// Returns the photos with paths relative to the session; or copies in one folder per source folder, with its name.
    fn photos(&self, home: &Path, files: &mut Files) -> Result<Vec<PhotoEntry>, SessionError> {
        let there = std::fs::read_dir(home).into_iter().flatten().flatten();
        let mut taken: BTreeSet<String> = there.map(|e| e.file_name().to_string_lossy().to_lowercase()).collect();
        let mut photos = Vec::new();
        let mut gathered = self.photos.session.photos.iter();
        for found in &self.photos.folders {
            let names = &found.listing.photos;
            let folder = if self.copy {
                let name = text_path(Path::new(found.real.file_name().unwrap_or("photos".as_ref())))?;
                let name = free_name(&name, &mut taken);
                let copies = names
                    .iter()
                    .map(|photo| (Path::new(&name).join(photo), found.real.join(photo)));
                files.extend(copies.map(|(to, from)| (to, Content::CopyOf(from))));
                name
            } else {
                text_path(&path_between(home, &found.real))?
            };
            photos.extend(names.iter().map(|name| PhotoEntry {
                file: joined(&folder, name),
                variant: found.given.variant.clone(),
                ..gathered.next().cloned().unwrap_or_default()
            }));
        }
        Ok(photos)
    }
}

/// Returns the paths, relative to the scene's folder, of a scene's mesh and of the list of its painted triangles; absolute paths, which stay valid,
/// are left out.
///
/// # Errors
/// A file beside or above the scene's folder, which a copy of the scene would not find.
pub fn files_below(scene: &Scene) -> Result<Vec<PathBuf>, PathBuf> {
    let named = scene.model.files().filter(|file| !file.is_absolute());
    let below = |file: &Path| {
        let is_below = file.components().all(|part| matches!(part, Component::Normal(_)));
        is_below.then(|| file.to_owned()).ok_or_else(|| file.to_owned())
    };
    named.map(below).collect()
}

/// Returns true if the path does not exist, or is an empty folder.
fn is_free(folder: &Path) -> Result<bool, FileError> {
    match std::fs::read_dir(folder) {
        Ok(mut entries) => Ok(entries.next().is_none()),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(true),
        Err(e) => Err(FileError::write(folder, &e)),
    }
}

/// Returns the absolute path, without links, of a folder that need not exist yet.
fn real_place(folder: &Path) -> Result<PathBuf, FileError> {
    let failed = |reason: String| FileError::cannot_write(folder, reason);
    let whole = std::path::absolute(folder).map_err(|e| failed(files::plain(&e)))?;
    for there in whole.ancestors() {
        let Ok(real) = there.canonicalize() else { continue };
        let rest = whole.strip_prefix(there).unwrap_or(Path::new(""));
        return if rest.components().all(|part| matches!(part, Component::Normal(_))) {
            Ok(real.components().chain(rest.components()).collect())
        } else {
            Err(failed("a folder on its path does not exist".into()))
        };
    }
    Err(failed("no part of the path exists".into()))
}

fn inside(file: &Path, home: &Path) -> Option<PathBuf> {
    let real = file.canonicalize().ok()?;
    real.strip_prefix(home).ok().map(Path::to_owned)
}

/// Returns the relative path from one folder to another: up, then down. Both paths are absolute and without links.
pub fn path_between(from: &Path, to: &Path) -> PathBuf {
    let both = from.components().zip(to.components());
    let same = both.take_while(|(a, b)| a == b).count();
    let up = from.components().skip(same).map(|_| Component::ParentDir);
    up.chain(to.components().skip(same)).collect()
}

/// Returns a name that is not taken, ignoring case: `photos`, `photos_2`, …
pub fn free_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| taken.insert(name.to_lowercase())).unwrap_or_default()
}

fn write(home: &Path, path: &Path, content: &Content) -> Result<(), FileError> {
    match content {
        Content::Bytes(bytes) => files::replace_atomically(home, path, bytes),
        Content::CopyOf(original) => files::copy(original, path),
    }
}
