//! Import of photos with known ground truth (of a simulator, an annotation tool, an old photo set) as a session: boxes and viewpoints from a COCO
//! annotation file or a CSV, into a `session.json` beside the photos.
//!
//! The photos stay unchanged in their place. A session has one model in each photo, so a photo with several boxes of its class is refused, and one
//! without any is left out and reported.

pub mod coco;
pub mod csv;
mod rows;

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::error::SessionError;
use crate::list::{PhotoEntry, SessionFile, check_photo};
use crate::opened::Session;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{bail, message};
use scaleproof_photo as photo;
use scaleproof_pose::scene::Scene;

pub use rows::{ImportFault, ImportedPhoto, ImportedRows};

/// Sources and destination of an import.
#[derive(Debug, Clone, Copy)]
pub struct ImportRequest<'a> {
    /// Annotation file: `.json` or `.csv`.
    pub file: &'a Path,
    /// Folder that contains the photos and gets the `session.json`.
    pub folder: &'a Path,
    pub scene: &'a Path,
    /// Camera file; needed only if photos lack a viewpoint.
    pub camera: Option<&'a Path>,
    /// Texture of photos for which the file names none.
    pub variant: Option<&'a str>,
}

#[derive(Debug)]
pub struct Imported {
    /// Path of the `session.json`; `text` is its content.
    pub path: PathBuf,
    pub text: String,
    pub session: Session,
    /// Names of photos that the file lists without a box of the model.
    pub without_box: Vec<String>,
}

/// Makes a session of an annotation file. Nothing is written yet.
pub fn import(request: &ImportRequest) -> Result<Imported, SessionError> {
    let path = request.folder.join("session.json");
    if path.exists() {
        let path = path.display();
        bail!("{path} is there already: move it away, or import into another folder");
    }
    let parse = match request.file.extension().and_then(|e| e.to_str()) {
        Some("json") => coco::parse,
        Some("csv") => csv::parse,
        _ => {
            let path = request.file.display();
            bail!("{path} is neither a COCO annotation file (.json) nor a table (.csv)");
        }
    };
    let class = Scene::open(request.scene)?.model.class;
    let text = files::read_text(request.file)?;
    let (rows, without_box) = parse(&text, &class).map_err(|fault| error(request.file, fault))?;
    if rows.is_empty() {
        let fault = ImportFault::of_file(format!("it has no photo with a box of {}", class.quoted()));
        return Err(error(request.file, fault));
    }
    let photos = checked(rows, request)?;
    let scene = seen_from(request.folder, request.scene)?;
    let camera = request
        .camera
        .map(|camera| seen_from(request.folder, camera))
        .transpose()?;
    let file = SessionFile {
        scene,
        camera,
        rendered: false,
        photos,
    };
    let text = file.to_json(&path)?;
    // The reader's checks apply.
    let session = Session::parse(&text, &path)?;
    Ok(Imported {
        path,
        text,
        session,
        without_box,
    })
}

fn error(path: &Path, fault: ImportFault) -> SessionError {
    match fault.place {
        Some(place) => message!("{}, {place}: {}", path.display(), fault.message).into(),
        None => FileError::content(path, fault.message).into(),
    }
}

/// Checks each row's photo against its file.
fn checked(rows: Vec<ImportedPhoto>, request: &ImportRequest) -> Result<Vec<PhotoEntry>, SessionError> {
    let mut seen = HashSet::new();
    let mut photos = Vec::new();
    for ImportedPhoto { place, mut entry, size } in rows {
        let refuse = |message: String| error(request.file, ImportFault::at(place.as_str(), message));
        if entry.variant.is_empty() {
            let missing = || {
                let (path, file) = (request.file.display(), &entry.file);
                message!("{path}, {place}: {file} has no variant: add one").hint("give ‹variant› for all")
            };
            entry.variant = request.variant.ok_or_else(missing)?.to_owned();
        }
        check_photo(&entry).map_err(refuse)?;
        let file = &entry.file;
        if Path::new(file).starts_with("..") {
            return Err(refuse(format!(
                "{file} is not a path below the folder with the photos: copy the photo there"
            )));
        }
        if !seen.insert(file.clone()) {
            return Err(refuse(format!("{file} is listed twice: each photo counts once")));
        }
        check_against_photo(&entry, size, request.folder).map_err(refuse)?;
        photos.push(entry);
    }
    Ok(photos)
}

/// Checks that the photo exists, has the size that the file states, and contains the box.
fn check_against_photo(entry: &PhotoEntry, size: Option<[u32; 2]>, folder: &Path) -> Result<(), String> {
    let file = &entry.file;
    let photo = photo::Photo::open(&folder.join(file)).map_err(|e| e.to_string())?;
    let (width, height) = (photo.width, photo.height);
    if let Some([w, h]) = size.filter(|size| *size != [width, height]) {
        return Err(format!(
            "{file} is {width}×{height} px upright and not {w}×{h}: the boxes are another photo's"
        ));
    }
    let Some(b) = entry.box_xyxy_px else { return Ok(()) };
    if !b.clipped(width.into(), height.into()).is_solid() {
        Err(format!("the box of {file} lies outside its {width}×{height} px"))
    } else if reaches_out(b, width, height) {
        Err(format!(
            "the box of {file} reaches out of its {width}×{height} px: is it another photo's? If not, cut it at the border"
        ))
    } else {
        Ok(())
    }
}

/// Returns true if a box exceeds the photo by more than its rounding to whole pixels.
fn reaches_out(b: BoxPx, width: u32, height: u32) -> bool {
    const ROUNDING_PX: f64 = 1.0;
    b.x1.min(b.y1) < -ROUNDING_PX || b.x2 > f64::from(width) + ROUNDING_PX || b.y2 > f64::from(height) + ROUNDING_PX
}

/// Returns a path as a file in `folder` may name it: relative if it lies below the folder, else absolute.
fn seen_from(folder: &Path, path: &Path) -> Result<PathBuf, FileError> {
    let (folder, path) = (files::whole_path(folder)?, files::whole_path(path)?);
    Ok(path.strip_prefix(&folder).map(Path::to_owned).unwrap_or(path))
}
