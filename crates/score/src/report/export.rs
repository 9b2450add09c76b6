//! Photos of a session with their truth boxes, exported in the COCO or YOLO format for other programs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::figures::{ScoredPhoto, Scores};
use crate::report::json::coco;
use crate::report::words::counted;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail};
use scaleproof_detect::{Labels, flat_name};

/// Reason why photos could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("the annotations could not be put together: {0}")]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Message(#[from] Message),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// `annotations.json` with `images`, `annotations` and `categories`.
    Coco,
    /// `labels/NAME.txt` beside `images/NAME.jpg`, `images.txt` and `data.yaml`.
    Yolo,
}

/// Checks, before photos are searched, that a folder is new or empty and can be written.
pub fn check_export(folder: &Path) -> Result<(), ExportError> {
    if std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        bail!("{} has files already: name a new folder", folder.display());
    }
    Ok(files::check_writable(folder)?)
}

/// Writes the photos of one session, whose truth boxes are known, into a new or empty folder, whole or not at all, and returns its main file
/// (`annotations.json` or `data.yaml`). Needs no detectors; links the photos, or copies them if `copy` is true.
pub fn export(scores: &Scores, format: ExportFormat, folder: &Path, copy: bool) -> Result<PathBuf, ExportError> {
    check_export(folder)?;
    let names = names(&scores.photos)?;
    let (labels, model) = labels(scores);
    let name_of = |photo: &ScoredPhoto| names.get(&photo.id).cloned().unwrap_or_default();
    let texts = match format {
        ExportFormat::Coco => vec![(
            "annotations.json".to_owned(),
            coco::annotations(
                scores,
                name_of,
                labels.clone(),
                labels.get(model).map_or(1, |(id, _)| *id),
            )?,
        )],
        ExportFormat::Yolo => yolo(scores, &name_of, &labels, model),
    };
    let main = texts.first().map_or(folder.to_owned(), |(name, _)| folder.join(name));
    files::make_folder(folder, |inside| {
        for (name, text) in &texts {
            files::replace_atomically(inside, &inside.join(name), text.as_bytes())?;
        }
        scores.photos.iter().try_for_each(|photo| {
            let from = scores.sessions[photo.session].folder.join(&photo.file);
            let to = inside.join("images").join(name_of(photo));
            if copy {
                files::copy(&from, &to)
            } else {
                files::link(&from, &to)
            }
        })
    })?;
    Ok(main)
}

/// Returns a file name for each photo, by its id: its own where all are unique without their endings, else its path in one word.
fn names(photos: &[ScoredPhoto]) -> Result<BTreeMap<u64, String>, ExportError> {
    let own = |photo: &ScoredPhoto| files::name_of(Path::new(&photo.file));
    let stem = |name: &str| Path::new(name).with_extension("").display().to_string();
    let stems: BTreeSet<String> = photos.iter().map(|photo| stem(&own(photo))).collect();
    let is_plain = stems.len() == photos.len();
    let (mut names, mut taken) = (BTreeMap::new(), BTreeMap::new());
    for photo in photos {
        let name = if is_plain { own(photo) } else { flat_name(&photo.file) };
        if let Some(other) = taken.insert(stem(&name), &photo.file) {
            let file = &photo.file;
            bail!("{other} and {file} would have one name: rename one of the photos");
        }
        names.insert(photo.id, name);
    }
    Ok(names)
}

/// Returns the labels that the truth is written in, with their category ids: COCO's if it has all of the scene's, else the scene's own; and the index
/// of the label of the model, the first of the scene's.
fn labels(scores: &Scores) -> (Vec<(u32, String)>, usize) {
    let own = counted::classes(scores).labels();
    let coco = Labels::Coco80;
    let named = |label: usize| Some((coco.category_id(label)?, coco.name(label)?.to_owned()));
    let model = own.first().and_then(|first| coco.find(first));
    match model.filter(|_| own.iter().all(|label| coco.find(label).is_some())) {
        Some(model) => ((0..coco.count()).filter_map(named).collect(), model),
        None => ((1..).zip(own.iter().cloned()).collect(), 0),
    }
}

/// Returns the files of a YOLO data set: `data.yaml` for Ultralytics, the list of images, and a label file for each photo.
fn yolo(
    scores: &Scores,
    name_of: &dyn Fn(&ScoredPhoto) -> String,
    labels: &[(u32, String)],
    model: usize,
) -> Vec<(String, String)> {
    let photos = scores.photos.iter();
    let list = photos.map(|photo| format!("./images/{}\n", name_of(photo)));
    let names = labels.iter().enumerate();
    // A string of JSON is one of YAML.
    let names = names.map(|(index, (_, name))| format!("  {index}: {}\n", serde_json::Value::from(name.as_str())));
    let data = format!("train: images\nval: images\nnames:\n{}", names.collect::<String>());
    let mut texts = vec![
        ("data.yaml".to_owned(), data),
        ("images.txt".to_owned(), list.collect()),
    ];
    for photo in &scores.photos {
        let (width, height, b) = (f64::from(photo.width), f64::from(photo.height), &photo.truth);
        let shares = [
            (b.x1 + b.x2) / 2.0 / width,
            (b.y1 + b.y2) / 2.0 / height,
            b.width() / width,
            b.height() / height,
        ];
        let shares = shares.map(|share| format!(" {share:.8}")).concat();
        let name = Path::new(&name_of(photo)).with_extension("txt");
        let name = format!("labels/{}", name.display());
        texts.push((name, format!("{model}{shares}\n")));
    }
    texts
}
