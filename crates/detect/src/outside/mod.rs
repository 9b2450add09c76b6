//! Detections that another program wrote into files: a COCO results list, or a folder of YOLO's text files.
//!
//! Photos are found by the names of their files. What such files may leave open (whose category ids, which photo, which scale) is refused with
//! a sentence, or said in a note; nothing is guessed.

mod boxes; // what a file says of a photo, as it stands there
mod categories; // numbers of a file as labels
mod coco; // COCO results lists
mod error;
mod photo_names; // names that other programs give photos
mod request;
mod text; // a file's text with its hash, and what is wrong with it
mod yolo; // YOLO's text files

use std::path::PathBuf;

use super::foreign::{check_score, placed, turned_hint};
use super::{Detection, ForeignCard, ForeignKind, MAX_DETECTIONS, SCORE_FLOOR};
use boxes::{PhotoBoxes, RawBox, ReadResults};
use categories::Categories;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::message;
use scaleproof_core::spelling;

pub use error::OutsideError;
pub use photo_names::{PhotoName, PhotoNames, flat_name};
pub use request::ResultsRequest;

#[derive(Debug)]
pub struct OutsideResults {
    card: ForeignCard,
    path: PathBuf,
    /// In the order of the run's photos.
    by_photo: Vec<PhotoBoxes>,
    /// True where boxes count shares of the photo's width and height, else pixels.
    are_shares: bool,
}

/// Results without any detection below were cut, which AP suffers from, unless a hundred boxes in each photo are above.
const CUT_FROM: f64 = 0.01;

impl OutsideResults {
    /// Reads the files of another program.
    ///
    /// # Errors
    /// A sentence on what cannot be read or is open to doubt.
    pub fn open(request: &ResultsRequest) -> Result<OutsideResults, OutsideError> {
        let categories = match request.categories {
            Some(path) => Categories::open(path, request.first_label)?,
            None => Categories::default().counted_from(request.first_label),
        };
        let is_folder = request.path.is_dir();
        if let (true, Some(images)) = (is_folder, request.images) {
            let message = "it says what the images of a COCO results list are, and a folder of text files has names";
            return Err(FileError::content(images, message).into());
        }
        let names = PhotoNames::new(request.photos);
        let mut read = if is_folder {
            yolo::read(request, &categories, &names)?
        } else {
            coco::read(request, &categories, &names)?
        };
        read.files.extend(request.categories.map(files::hashed).transpose()?);
        let path = request.path;
        // Nothing found in photos that the files list is an answer.
        let is_silent = |p: &PhotoBoxes| p.boxes.is_empty();
        if read.by_photo.iter().all(is_silent) && read.by_photo.iter().any(|p| !p.is_listed) {
            let has = read.unknown.first().map(|name| format!(" (it has {name})"));
            let message = format!(
                "it has no detection in any photo of this run{}, and does not list them all: a program that found nothing in any photo says so by a \
                 COCO file of the images it looked at, or by an empty text file for each",
                has.unwrap_or_default()
            );
            return Err(FileError::content(path, message).into());
        }
        for (photo, boxes) in request.photos.iter().zip(&read.by_photo) {
            let scores = boxes.boxes.iter().try_for_each(|b| check_score(b.score));
            let checked = scores.and_then(|()| check_copies(&boxes.boxes));
            checked.map_err(|message| FileError::content(path, format!("{}: {message}", photo.file)))?;
        }
        let mut notes = notes(request, &read);
        for photo in &mut read.by_photo {
            photo.boxes.retain(|b| b.score >= SCORE_FLOOR);
            photo.boxes.sort_by(|a, b| b.score.total_cmp(&a.score));
        }
        let full = read.by_photo.iter().filter(|p| p.boxes.len() > MAX_DETECTIONS).count();
        if full > 0 {
            read.by_photo.iter_mut().for_each(|p| p.boxes.truncate(MAX_DETECTIONS));
            notes.push(format!(
                "the results of {} have more than {MAX_DETECTIONS} detections in {}, of which the best {MAX_DETECTIONS} count",
                request.name,
                spelling::count(full, "photo")
            ));
        }
        Ok(OutsideResults {
            card: ForeignCard {
                kind: ForeignKind::Results,
                name: request.name.to_owned(),
                title: request.name.to_owned(),
                licence: "not stated".into(),
                origin: format!("{}, made by another program", files::name_of(path)),
                version: None,
                command: Vec::new(),
                labels: categories.labels,
                class_map: Default::default(),
                files: read.files,
                notes,
            },
            path: path.to_owned(),
            by_photo: read.by_photo,
            are_shares: is_folder,
        })
    }

    pub fn card(&self) -> &ForeignCard {
        &self.card
    }

    /// The detections of the photo with this index in the run and this size in px, best first; `file` is what messages call it.
    pub fn of_photo(
        &self,
        index: usize,
        file: &str,
        [width, height]: [u32; 2],
    ) -> Result<Vec<Detection>, OutsideError> {
        let Some(photo) = self.by_photo.get(index) else {
            return Ok(Vec::new());
        };
        let refuse = |fault: String| OutsideError::from(message!("{}, {file}: {fault}", self.path.display()));
        if let Some([w, h]) = photo.size.filter(|size| *size != [width, height]) {
            let hint = turned_hint("the other program", [w, h], [width, height]);
            return Err(refuse(format!(
                "the photo is {width}×{height} px upright, and its boxes are of an image of {w}×{h} px{hint}"
            )));
        }
        let [sx, sy] = if self.are_shares {
            [width, height].map(f64::from)
        } else {
            [1.0; 2]
        };
        let placed = photo.boxes.iter().map(|raw| {
            let [x, y, w, h] = raw.xywh;
            let b = BoxPx::new(x * sx, y * sy, x * sx + w * sx, y * sy + h * sy);
            placed(raw.label, raw.score, b, [width, height]).map_err(refuse)
        });
        placed.filter_map(Result::transpose).collect()
    }
}

/// Results that were put together twice count their false alarms twice.
fn check_copies(boxes: &[RawBox]) -> Result<(), String> {
    let key = |b: &RawBox| (b.label, b.score.to_bits(), b.xywh.map(f64::to_bits));
    let mut keys: Vec<_> = boxes.iter().filter(|b| b.score >= SCORE_FLOOR).map(key).collect();
    keys.sort_unstable();
    match keys.windows(2).filter(|pair| pair[0] == pair[1]).count() {
        0 => Ok(()),
        count => Err(format!(
            "{} there twice, with label, box and confidence: remove the {}",
            spelling::choose(count, "a detection is", &format!("{count} detections are")),
            spelling::choose(count, "copy", "copies")
        )),
    }
}

/// Returns cautions about the files for a reader of the figures.
fn notes(request: &ResultsRequest, read: &ReadResults) -> Vec<String> {
    let (name, mut notes) = (request.name, Vec::new());
    let photos = || request.photos.iter().zip(&read.by_photo);
    let all = spelling::count(request.photos.len(), "photo");
    let silent = || photos().filter(|(_, boxes)| !boxes.is_listed);
    if let Some((first, _)) = silent().next() {
        notes.push(format!(
            "the results of {name} do not mention {} of {all} (the first: {}): there they count as if nothing was found",
            silent().count(),
            first.file,
        ));
    }
    if read.by_photo.iter().all(|boxes| boxes.boxes.is_empty()) {
        notes.push(format!(
            "the results of {name} have no detection in any of {all}: AP is 0 if its program looked at them"
        ));
        return notes;
    }
    let bare = || photos().filter(|(_, boxes)| boxes.is_listed && boxes.boxes.is_empty());
    if let (false, Some((first, _))) = (request.path.is_dir(), bare().next()) {
        notes.push(format!(
            "the results of {name} have no detection in {} of {all} (the first: {}): there they count as if nothing was found, and a list of \
             results does not say whether its program looked at these",
            bare().count(),
            first.file,
        ));
    }
    if let Some(first) = read.unknown.first() {
        notes.push(format!(
            "the results of {name} are also of {} that this run does not have (the first: {first})",
            spelling::count(read.unknown.len(), "image"),
        ));
    }
    let boxes = || read.by_photo.iter().flat_map(|p| &p.boxes);
    let empty = boxes().filter(|b| b.xywh[2] == 0.0 || b.xywh[3] == 0.0).count();
    if empty > 0 {
        let boxes = spelling::choose(empty, "1 box has", &format!("{empty} boxes have")).to_owned();
        notes.push(format!("{boxes} no area in the results of {name} and are left out"));
    }
    let lowest = boxes().map(|b| b.score).fold(f64::INFINITY, f64::min);
    let is_full = |p: &PhotoBoxes| p.boxes.len() >= MAX_DETECTIONS;
    if lowest >= CUT_FROM && lowest.is_finite() && !read.by_photo.iter().all(is_full) {
        notes.push(format!(
            "the results of {name} have nothing below confidence {lowest}: AP counts detections from {SCORE_FLOOR} up, so that it may be too low"
        ));
    }
    notes
}
