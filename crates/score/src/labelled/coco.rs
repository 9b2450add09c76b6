//! COCO annotations of whole photos (cocodataset.org, "Data format", object detection).

use std::collections::BTreeMap;
use std::path::{Component, Path};

use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::labelled::LabelledPhotos;
use crate::labelled::photos::{LabelledPhoto, Object};
use scaleproof_core::coco::{self, File, Whole};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Manifest;

#[derive(Deserialize)]
struct Image {
    #[serde(deserialize_with = "coco::whole")]
    id: u64,
    file_name: String,
}

/// Reads COCO annotations ("Data format", object detection) of photos in a folder, for a detector whose labels count as its manifest says.
pub fn labelled_photos(path: &Path, folder: &Path, detector: &Manifest) -> Result<LabelledPhotos, FileError> {
    let labels = || 0..detector.labels.count();
    let first_of = |name: &str| labels().find(|label| detector.counts_as(*label) == Some(name));
    let text = files::read_text(path)?;
    let refused = |message: String| FileError::content(path, message);
    let file: File<Image, IgnoredAny, Whole> =
        serde_json::from_str(&text).map_err(|e| refused(format!("line {}: {e}", e.line())))?;
    let (mut known, mut unknown) = (BTreeMap::new(), Vec::new());
    for category in &file.categories {
        match first_of(&category.name) {
            Some(label) => drop(known.insert(category.id, label)),
            None => unknown.push(category.name.clone()),
        }
    }
    if known.is_empty() {
        let first: Vec<String> = unknown.iter().take(5).map(|name| format!("{name:?}")).collect();
        return Err(refused(format!(
            "none of its categories ({}) is a label of the detector",
            first.join(", ")
        )));
    }
    let mut photos: BTreeMap<u64, LabelledPhoto> = BTreeMap::new();
    for image in &file.images {
        let name = Path::new(&image.file_name);
        let is_inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
        if !name.components().all(is_inside) {
            return Err(refused(format!(
                "image {}: the file name {:?} leaves the folder of photos",
                image.id, image.file_name
            )));
        }
        let photo = LabelledPhoto {
            path: folder.join(name),
            objects: Vec::new(),
        };
        if photos.insert(image.id, photo).is_some() {
            return Err(refused(format!("image {}: its id appears twice", image.id)));
        }
    }
    for annotation in &file.annotations {
        let [x, y, width, height] = annotation.bbox;
        let id = annotation.image_id;
        let unlisted = || refused(format!("an annotation names image {id}, which is not in `images`"));
        let photo = photos.get_mut(&id).ok_or_else(unlisted)?;
        if !annotation.bbox.iter().all(|v| v.is_finite()) || width < 0.0 || height < 0.0 {
            return Err(refused(format!(
                "image {id}: bbox is {:?}: give x, y, width and height in px",
                annotation.bbox
            )));
        }
        if let Some(label) = known.get(&annotation.category_id) {
            photo.objects.push(Object {
                label: *label,
                box_px: BoxPx::new(x, y, x + width, y + height),
                is_crowd: annotation.iscrowd.0 != 0,
            });
        }
    }
    let boxes = photos
        .values()
        .flat_map(|photo| &photo.objects)
        .map(|object| object.box_px);
    BoxPx::check_counts_pixels(boxes).map_err(|why| refused(why.to_owned()))?;
    if photos.values().all(|photo| photo.objects.is_empty()) {
        return Err(refused("it has no object with a label of the detector".to_owned()));
    }
    Ok(LabelledPhotos {
        photos: photos.into_values().collect(),
        unknown,
        counts_as: labels()
            .map(|label| detector.counts_as(label).and_then(first_of).unwrap_or(label))
            .collect(),
    })
}
