//! What other programs run on: the photos of a session with their truth boxes, as COCO or YOLO have them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::{coco, counted};
use crate::score::{ScoredPhoto, Scores};
use scaleproof_core::files::{self, FileError};
use scaleproof_detect::{Labels, flat_name};

/// Why nothing was exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("the annotations could not be put together: {0}")]
    Json(#[from] serde_json::Error),
    #[error("{folder} has files already: name a new folder", folder = folder.display())]
    NotEmpty { folder: PathBuf },
    #[error("{a} and {b} would have one name: rename one of the photos")]
    AlikeNames { a: String, b: String },
}

/// Formats that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// `annotations.json` with `images`, `annotations` and `categories`.
    Coco,
    /// `labels/NAME.txt` beside `images/NAME.jpg`, `images.txt` and `data.yaml`.
    Yolo,
}

/// What is exported, and where.
pub struct ExportRequest<'a> {
    /// Photos of one session, whose truth boxes are known; detectors are not needed.
    pub scores: &'a Scores,
    pub format: ExportFormat,
    /// A new folder, or an empty one.
    pub folder: &'a Path,
    /// Copies the photos instead of linking to them.
    pub copy: bool,
}

/// Finds out, before photos are searched, that a folder is new or empty.
pub fn check_export(folder: &Path) -> Result<(), ExportError> {
    if std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        let folder = folder.to_owned();
        return Err(ExportError::NotEmpty { folder });
    }
    Ok(files::check_writable(folder)?)
}

/// Writes the export, whole or not at all, and returns the file that names everything.
pub fn export(request: &ExportRequest) -> Result<PathBuf, ExportError> {
    let (scores, folder) = (request.scores, request.folder);
    check_export(folder)?;
    let names = names(&scores.photos)?;
    let classes = Classes::from_scores(scores);
    let name_of = |photo: &ScoredPhoto| names.get(&photo.id).cloned().unwrap_or_default();
    let texts = match request.format {
        ExportFormat::Coco => vec![(
            "annotations.json".to_owned(),
            coco::annotations(scores, name_of, classes.labels.clone(), classes.model_category())?,
        )],
        ExportFormat::Yolo => yolo(scores, &name_of, &classes),
    };
    let main = texts.first().map_or(folder.to_owned(), |(name, _)| folder.join(name));
    let photos = scores
        .photos
        .iter()
        .map(|photo| (path_of(scores, photo), name_of(photo)));
    let photos: Vec<(PathBuf, String)> = photos.collect();
    files::make_folder(folder, |inside| {
        for (name, text) in &texts {
            files::write_atomically(&inside.join(name), text.as_bytes())?;
        }
        photos.iter().try_for_each(|(photo, name)| {
            let to = inside.join("images").join(name);
            if request.copy {
                files::copy(photo, &to)
            } else {
                files::link(photo, &to)
            }
        })
    })?;
    Ok(main)
}

fn path_of(scores: &Scores, photo: &ScoredPhoto) -> PathBuf {
    let session = scores.sessions.get(photo.session);
    session
        .map_or(PathBuf::new(), |session| session.folder.clone())
        .join(&photo.file)
}

/// A name for each photo, by its id: its own, or its path in one word where two photos are called alike but for the ending.
fn names(photos: &[ScoredPhoto]) -> Result<BTreeMap<u64, String>, ExportError> {
    let own = |photo: &ScoredPhoto| {
        let name = Path::new(&photo.file).file_name();
        name.map_or_else(|| photo.file.clone(), |name| name.to_string_lossy().into_owned())
    };
    let stem = |name: &str| Path::new(name).with_extension("").display().to_string();
    let stems: BTreeSet<String> = photos.iter().map(|photo| stem(&own(photo))).collect();
    let is_plain = stems.len() == photos.len();
    let (mut names, mut taken) = (BTreeMap::new(), BTreeMap::new());
    for photo in photos {
        let name = if is_plain { own(photo) } else { flat_name(&photo.file) };
        if let Some(other) = taken.insert(stem(&name), &photo.file) {
            let (a, b) = (other.clone(), photo.file.clone());
            return Err(ExportError::AlikeNames { a, b });
        }
        names.insert(photo.id, name);
    }
    Ok(names)
}

/// The labels that the truth is written in: COCO's when it has those of the scene, else the scene's own.
struct Classes {
    labels: Vec<(u32, String)>,
    /// Index of what the model counts as: the first of the scene's labels.
    model: usize,
}

impl Classes {
    fn from_scores(scores: &Scores) -> Classes {
        let own = counted::classes(scores).labels();
        let coco = Labels::Coco80;
        let named = |label: usize| Some((coco.category_id(label)?, coco.name(label)?.to_owned()));
        let model = own.first().and_then(|first| coco.find(first));
        match model.filter(|_| own.iter().all(|label| coco.find(label).is_some())) {
            Some(model) => Classes {
                labels: (0..coco.count()).filter_map(named).collect(),
                model,
            },
            None => Classes {
                labels: (1..).zip(own.iter().cloned()).collect(),
                model: 0,
            },
        }
    }

    fn model_category(&self) -> u32 {
        self.labels.get(self.model).map_or(1, |(id, _)| *id)
    }
}

/// The list of images, a text for each, and what Ultralytics reads.
fn yolo(scores: &Scores, name_of: &dyn Fn(&ScoredPhoto) -> String, classes: &Classes) -> Vec<(String, String)> {
    let photos = scores.photos.iter();
    let list = photos.map(|photo| format!("./images/{}\n", name_of(photo)));
    let names = classes.labels.iter().enumerate();
    // A text of JSON is one of YAML.
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
        texts.push((name, format!("{}{shares}\n", classes.model)));
    }
    texts
}
