//! A COCO results list (cocodataset.org, "Results format", object detection), and the COCO file whose images it numbers.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use serde::Deserialize;

use super::boxes::{PhotoBoxes, RawBox, ReadResults};
use super::categories::Categories;
use super::error::OutsideError;
use super::photo_names::PhotoNames;
use super::request::ResultsRequest;
use super::text::{hashed_text, syntax};
use scaleproof_core::coco::{Category, whole, whole_if_any};
use scaleproof_core::files::FileError;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, bail};

/// A detection; other keys are passed over.
#[derive(Deserialize)]
struct Line {
    image_id: ImageId,
    #[serde(deserialize_with = "whole")]
    category_id: u64,
    /// x, y, width, height in pixels.
    bbox: [f64; 4],
    score: Option<f64>,
}

/// The id of an image: COCO's number, or some programs' file name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(untagged, expecting = "an image's id is a whole number from 0 up, or a name")]
enum ImageId {
    Number(#[serde(deserialize_with = "whole")] u64),
    Name(String),
}

impl fmt::Display for ImageId {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            ImageId::Number(id) => write!(f, "image {id}"),
            ImageId::Name(name) => f.write_str(name),
        }
    }
}

#[derive(Deserialize)]
struct ImagesFile {
    images: Vec<Image>,
    #[serde(default)]
    categories: Vec<Category>,
}

#[derive(Deserialize)]
struct Image {
    id: ImageId,
    file_name: String,
    #[serde(default, deserialize_with = "whole_if_any")]
    width: Option<u32>,
    #[serde(default, deserialize_with = "whole_if_any")]
    height: Option<u32>,
}

pub(super) fn read(
    request: &ResultsRequest,
    categories: &Categories,
    names: &PhotoNames,
) -> Result<ReadResults, OutsideError> {
    let path = request.path;
    let (text, hashed) = hashed_text(path)?;
    let (lines, mut files) = (lines(&text, path)?, vec![hashed]);
    drop(text);
    let mut photos = Photos {
        request,
        names,
        by_photo: request.photos.iter().map(|_| PhotoBoxes::default()).collect(),
        by_id: BTreeMap::new(),
        called: BTreeMap::new(),
        unknown: BTreeSet::new(),
    };
    if let Some(images) = request.images {
        files.push(photos.listed(images)?);
    }
    for (at, line) in lines.iter().enumerate() {
        let refuse = |message: String| {
            FileError::content(path, format!("detection {} (of {}): {message}", at + 1, line.image_id))
        };
        let found = raw_box(line, categories, path, &refuse)?;
        match photos.find(&line.image_id, &refuse)? {
            Some(photo) => photo.boxes.push(found),
            None => drop(photos.unknown.insert(line.image_id.to_string())),
        }
    }
    let boxes = photos.by_photo.iter().flat_map(|p| &p.boxes);
    let boxes = boxes.map(|RawBox { xywh: [x, y, w, h], .. }| BoxPx::new(*x, *y, x + w, y + h));
    BoxPx::check_counts_pixels(boxes).map_err(|why| FileError::content(path, why))?;
    Ok(ReadResults {
        by_photo: photos.by_photo,
        unknown: photos.unknown.into_iter().collect(),
        files,
    })
}

fn lines(text: &str, path: &Path) -> Result<Vec<Line>, FileError> {
    if text.trim_start().starts_with('{') {
        let message = "it is an object, and COCO results are a list [{\"image_id\": …, \"category_id\": …, \"bbox\": …, \"score\": …}, …]: name \
                       the results and not the annotations";
        return Err(FileError::content(path, message));
    }
    if text.trim_start().starts_with(|c: char| c.is_alphanumeric()) {
        let message = "it is no JSON: results are a COCO list [{\"image_id\": …, \"category_id\": …, \"bbox\": …, \"score\": …}, …], or a folder \
                       with YOLO's text files, one a photo";
        return Err(FileError::content(path, message));
    }
    serde_json::from_str(text).map_err(|e| syntax(path, &e))
}

fn raw_box(
    line: &Line,
    categories: &Categories,
    path: &Path,
    refuse: &impl Fn(String) -> FileError,
) -> Result<RawBox, OutsideError> {
    let score = line
        .score
        .ok_or_else(|| refuse("it has no score: these may be annotations, or the confidences were left out".into()))?;
    let xywh = line.bbox;
    if xywh[2] < 0.0 || xywh[3] < 0.0 || !xywh.iter().all(|v| v.is_finite()) {
        return Err(refuse(format!("bbox is {xywh:?}: give x, y, width and height in pixels")).into());
    }
    let label = categories.of_id(line.category_id, path)?;
    Ok(RawBox { label, score, xywh })
}

struct Photos<'a> {
    request: &'a ResultsRequest<'a>,
    names: &'a PhotoNames<'a>,
    by_photo: Vec<PhotoBoxes>,
    /// The photo of each image, where there is one.
    by_id: BTreeMap<ImageId, Option<usize>>,
    /// Names of photos in the results, where they name them themselves.
    called: BTreeMap<usize, String>,
    unknown: BTreeSet<String>,
}

impl Photos<'_> {
    /// Learns the images of a COCO file, which must list every photo of the run once; returns its name and hash.
    fn listed(&mut self, images: &Path) -> Result<(String, String), OutsideError> {
        let (request, names) = (self.request, self.names);
        let (text, hashed) = hashed_text(images)?;
        let file: ImagesFile = serde_json::from_str(&text).map_err(|e| syntax(images, &e))?;
        let refuse = |message: String| FileError::content(images, message);
        if request.categories.is_none() {
            Categories::check_are_cocos(&file.categories, images)?;
        }
        let mut called: BTreeMap<usize, &Image> = BTreeMap::new();
        for image in &file.images {
            let index = names.find(&image.file_name, &image.file_name).map_err(refuse)?;
            if self.by_id.insert(image.id.clone(), index).is_some() {
                return Err(refuse(format!("the id of {} appears twice", image.id)).into());
            }
            let Some((index, photo)) = index.and_then(|index| Some((index, self.by_photo.get_mut(index)?))) else {
                continue;
            };
            if let Some(other) = called.insert(index, image) {
                let file = &request.photos[index].file;
                return Err(refuse(one_photo(&other.file_name, &image.file_name, file)).into());
            }
            photo.is_listed = true;
            photo.size = image.width.zip(image.height).map(|(w, h)| [w, h]);
        }
        let mut photos = request.photos.iter().zip(&self.by_photo);
        match photos.find(|(_, boxes)| !boxes.is_listed) {
            None => Ok(hashed),
            Some((photo, _)) => bail!(
                "{} does not list the photo {}, so that {} says nothing of it", images.display(), photo.file, request.path.display();
                hint: "run the other program on it too (see `scaleproof session export`)"
            ),
        }
    }

    /// The photo of an image; `None` for one that the run does not have.
    fn find(
        &mut self,
        id: &ImageId,
        refuse: &impl Fn(String) -> FileError,
    ) -> Result<Option<&mut PhotoBoxes>, OutsideError> {
        let (request, names) = (self.request, self.names);
        let index = match (self.by_id.get(id), id) {
            (Some(index), _) => *index,
            (None, ImageId::Name(_)) if request.images.is_some() => {
                let fault = Message::from(refuse("the file of its images has none of this id".into()));
                return Err(fault.hint("where ids are the photos' names, leave ‹images› out").into());
            }
            (None, _) if request.images.is_some() => {
                return Err(refuse("the file of its images has none of this id".into()).into());
            }
            (None, ImageId::Number(id)) => bail!(
                "{} names its images by number ({id}), and nothing says which photos they are", request.path.display();
                hint: "name the COCO file of its images by ‹images›"
            ),
            (None, ImageId::Name(name)) => {
                let index = names.find(name, name).map_err(refuse)?;
                self.by_id.insert(id.clone(), index);
                let other = index.and_then(|index| self.called.insert(index, name.clone()));
                if let Some((other, photo)) = other.zip(index.and_then(|index| request.photos.get(index))) {
                    return Err(refuse(one_photo(&other, name, &photo.file)).into());
                }
                index
            }
        };
        let mut photo = index.and_then(|index| self.by_photo.get_mut(index));
        if let Some(photo) = &mut photo {
            photo.is_listed = true;
        }
        Ok(photo)
    }
}

fn one_photo(a: &str, b: &str, file: &str) -> String {
    format!("{a} and {b} may both be the photo {file}")
}
