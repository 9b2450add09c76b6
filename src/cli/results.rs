//! `--results NAME=FILE`: detectors whose detections another program wrote into files.

use std::error::Error;
use std::path::{Path, PathBuf};

use crate::detect::{Manifest, OutsideError, OutsideResults, PhotoName, ResultsRequest};
use crate::score::{EvaluatedDetector, EvaluatedDetectorError};
use crate::session::Session;

/// Detections from outside.
#[derive(clap::Args)]
pub(super) struct Results {
    /// Detections of another program, under a name of your choice: a COCO results list (.json), or a folder with YOLO's text files, one a
    /// photo; see `scaleproof session export` for what to run it on. Once for each detector.
    #[arg(long = "results", value_name = "NAME=FILE")]
    results: Vec<String>,
    /// With --results: the COCO file whose images the results number.
    #[arg(long, value_name = "JSON", requires = "results")]
    images: Option<PathBuf>,
    /// With --results: what the numbers of its classes mean: a COCO file with `categories`, or a text file of names, one a line; COCO's own
    /// when left out.
    #[arg(long, value_name = "FILE", requires = "results")]
    categories: Option<PathBuf>,
}

impl Results {
    /// Whether nothing else is scored.
    pub(super) fn stand_alone(&self, names: &[String], is_recorded: bool) -> bool {
        !self.results.is_empty() && names.is_empty() && !is_recorded
    }

    /// Reads all of them, for the photos of some sessions.
    pub(super) fn open(&self, sessions: &[Session]) -> Result<Vec<EvaluatedDetector>, Box<dyn Error>> {
        let Some(class) = sessions.first().map(|s| &s.scene.model.class) else {
            return Ok(Vec::new());
        };
        if self.results.is_empty() {
            return Ok(Vec::new());
        }
        let names = |s: &Session| -> Vec<PhotoName> {
            let folder = s.folder.canonicalize().unwrap_or_else(|_| s.folder.clone());
            s.photos
                .iter()
                .map(|photo| PhotoName::new(&folder, &photo.file))
                .collect()
        };
        let photos: Vec<PhotoName> = sessions.iter().flat_map(names).collect();
        let mut evaluated = Vec::new();
        for given in &self.results {
            let (name, path) = name_and_path(given)?;
            let results = OutsideResults::open(&ResultsRequest {
                name,
                path,
                images: self.images.as_deref(),
                categories: self.categories.as_deref(),
                photos: &photos,
            })?;
            evaluated.push(EvaluatedDetector::outside(results, class)?);
        }
        Ok(evaluated)
    }
}

fn name_and_path(given: &str) -> Result<(&str, &Path), String> {
    let wrong = |what: &str| format!("--results {given} {what}: write NAME=FILE, as in mine=results.json");
    let (name, path) = given.split_once('=').ok_or_else(|| wrong("names no detector"))?;
    match (Manifest::is_name(name), path) {
        (_, "") => Err(wrong("names no file")),
        (false, _) => Err(wrong("has a name that is not of letters, digits, `_`, `-` and `.`")),
        (true, path) => Ok((name, Path::new(path))),
    }
}

/// What to do about an error of the library.
pub(super) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(EvaluatedDetectorError::Outside(e)) = error.downcast_ref() {
        return advice(e);
    }
    match error.downcast_ref()? {
        OutsideError::NumberedImages { .. } => Some("name the COCO file of its images by --images".into()),
        OutsideError::UnknownCategory { .. } => Some("say what its categories are called by --categories".into()),
        OutsideError::WhoseCategories { images, .. } => {
            Some(format!("say by --categories, which may be {} too", images.display()))
        }
        OutsideError::NotListed { .. } => {
            Some("run the other program on it too (see `scaleproof session export`)".into())
        }
        _ => None,
    }
}
