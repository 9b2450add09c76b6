//! A COCO results list (cocodataset.org, "Results format", object detection), and the COCO file whose images it numbers.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use serde::Deserialize;

use super::categories::{Categories, Category};
use super::photo_names::{Found, PhotoNames};
use super::{OutsideError, PhotoBoxes, RawBox, ReadResults, ResultsRequest, name_of, syntax};
use scaleproof_core::files::{self, FileError};

/// A detection; other keys are passed over.
#[derive(Deserialize)]
struct Line {
    image_id: ImageId,
    category_id: u64,
    /// x, y, width, height in pixels.
    bbox: [f64; 4],
    score: Option<f64>,
}

/// What names an image: COCO's number, or some programs' file name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(untagged, expecting = "an image's id is a whole number or a name")]
enum ImageId {
    Number(u64),
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
    width: Option<u32>,
    height: Option<u32>,
}

pub(super) fn read(
    request: &ResultsRequest,
    categories: &Categories,
    names: &PhotoNames,
) -> Result<ReadResults, OutsideError> {
    let path = request.path;
    let text = files::read_text(path)?;
    let lines = lines(&text, path)?;
    let mut files = vec![(name_of(path), files::sha256_hex(text.as_bytes()))];
    drop(text);
    let mut photos = Photos::new(request.photos.len());
    if let Some(images) = request.images {
        files.push(photos.listed(request, images, names)?);
    }
    for (at, line) in lines.iter().enumerate() {
        let refuse = |message: String| {
            FileError::content(path, format!("detection {} (of {}): {message}", at + 1, line.image_id))
        };
        let found = raw_box(line, categories, path, &refuse)?;
        match photos
            .find(&line.image_id, request, names)
            .map_err(|e| e.at(path, &refuse))?
        {
            Some(photo) => photo.boxes.push(found),
            None => drop(photos.unknown.insert(line.image_id.to_string())),
        }
    }
    let read = ReadResults {
        by_photo: photos.by_photo,
        unknown: photos.unknown.into_iter().collect(),
        files,
    };
    check_unit(&read, path)?;
    Ok(read)
}

fn lines(text: &str, path: &Path) -> Result<Vec<Line>, OutsideError> {
    if text.trim_start().starts_with('{') {
        let message = "it is an object, and COCO results are a list [{\"image_id\": …, \"category_id\": …, \"bbox\": …, \"score\": …}, …]: name \
                       the results and not the annotations";
        return Err(FileError::content(path, message).into());
    }
    Ok(serde_json::from_str(text).map_err(|e| syntax(path, &e))?)
}

fn raw_box(
    line: &Line,
    categories: &Categories,
    path: &Path,
    refuse: &impl Fn(String) -> FileError,
) -> Result<RawBox, OutsideError> {
    let Some(score) = line.score else {
        return Err(
            refuse("it has no score: these may be annotations, or the confidences were left out".into()).into(),
        );
    };
    if line.bbox[2] < 0.0 || line.bbox[3] < 0.0 || !line.bbox.iter().all(|v| v.is_finite()) {
        let bbox = line.bbox;
        return Err(refuse(format!("bbox is {bbox:?}: give x, y, width and height in pixels")).into());
    }
    Ok(RawBox {
        label: categories.of_id(line.category_id, path)?,
        score,
        xywh: line.bbox,
    })
}

/// Why an image is no photo of the run.
enum NoPhoto {
    Several(String),
    NotAmongImages,
    Numbered(u64),
}

impl NoPhoto {
    fn at(self, path: &Path, refuse: &impl Fn(String) -> FileError) -> OutsideError {
        match self {
            NoPhoto::Several(message) => refuse(message).into(),
            NoPhoto::NotAmongImages => refuse("the file of its images has none of this id".into()).into(),
            NoPhoto::Numbered(id) => OutsideError::NumberedImages {
                path: path.to_owned(),
                id,
            },
        }
    }
}

/// The photos of the run as the results know them.
struct Photos {
    by_photo: Vec<PhotoBoxes>,
    /// The photo of each image, where there is one.
    by_id: BTreeMap<ImageId, Option<usize>>,
    /// What the results call a photo, where they name it themselves.
    called: BTreeMap<usize, String>,
    unknown: BTreeSet<String>,
}

impl Photos {
    fn new(count: usize) -> Photos {
        Photos {
            by_photo: (0..count).map(|_| PhotoBoxes::default()).collect(),
            by_id: BTreeMap::new(),
            called: BTreeMap::new(),
            unknown: BTreeSet::new(),
        }
    }

    /// Learns the images of a COCO file, which must list every photo of the run once; returns its name and hash.
    fn listed(
        &mut self,
        request: &ResultsRequest,
        images: &Path,
        names: &PhotoNames,
    ) -> Result<(String, String), OutsideError> {
        let text = files::read_text(images)?;
        let file: ImagesFile = serde_json::from_str(&text).map_err(|e| syntax(images, &e))?;
        let refuse = |message: String| FileError::content(images, message);
        if request.categories.is_none() {
            Categories::check_are_cocos(&file.categories, images)?;
        }
        let mut called: BTreeMap<usize, &Image> = BTreeMap::new();
        for image in &file.images {
            let index = match names.find(&image.file_name) {
                Found::Photo(index) => Some(index),
                Found::Nothing => None,
                Found::Several(a, b) => return Err(refuse(names.several(&image.file_name, a, b)).into()),
            };
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
        let lacking = request
            .photos
            .iter()
            .zip(&self.by_photo)
            .find(|(_, boxes)| !boxes.is_listed);
        if let Some((photo, _)) = lacking {
            return Err(OutsideError::NotListed {
                images: images.to_owned(),
                path: request.path.to_owned(),
                file: photo.file.clone(),
            });
        }
        Ok((name_of(images), files::sha256_hex(text.as_bytes())))
    }

    /// The photo of an image; `None` for one that the run does not have.
    fn find(
        &mut self,
        id: &ImageId,
        request: &ResultsRequest,
        names: &PhotoNames,
    ) -> Result<Option<&mut PhotoBoxes>, NoPhoto> {
        let index = match (self.by_id.get(id), id) {
            (Some(index), _) => *index,
            (None, _) if request.images.is_some() => return Err(NoPhoto::NotAmongImages),
            (None, ImageId::Number(id)) => return Err(NoPhoto::Numbered(*id)),
            (None, ImageId::Name(name)) => {
                let index = match names.find(name) {
                    Found::Photo(index) => Some(index),
                    Found::Nothing => None,
                    Found::Several(a, b) => return Err(NoPhoto::Several(names.several(name, a, b))),
                };
                self.by_id.insert(id.clone(), index);
                let other = index.and_then(|index| self.called.insert(index, name.clone()));
                if let Some((other, photo)) = other.zip(index.and_then(|index| request.photos.get(index))) {
                    return Err(NoPhoto::Several(one_photo(&other, name, &photo.file)));
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

/// Why two names of one photo are refused.
fn one_photo(a: &str, b: &str, file: &str) -> String {
    format!("{a} and {b} may both be the photo {file}")
}

/// Boxes that all lie in the first pixel are shares of the photo.
fn check_unit(read: &ReadResults, path: &Path) -> Result<(), FileError> {
    let mut boxes = read.by_photo.iter().flat_map(|p| &p.boxes).peekable();
    let is_share = |b: &RawBox| b.xywh.iter().all(|v| v.abs() <= 1.5);
    if boxes.peek().is_some() && boxes.all(is_share) {
        Err(FileError::content(
            path,
            "every box lies in the first pixels: COCO counts pixels, and these look like shares of the photo",
        ))
    } else {
        Ok(())
    }
}
