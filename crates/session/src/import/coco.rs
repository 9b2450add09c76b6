//! Import of COCO annotation files (cocodataset.org, "Data format", object detection): the boxes of the categories that count as the model.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use serde_json::Value;

use super::rows::{ImportFault, ImportedPhoto, ImportedRows, viewpoint};
use crate::conditions::{is_name, scalar};
use crate::list::{PhotoEntry, parse_message};
use scaleproof_core::coco::{self, Annotation, Category, File};
use scaleproof_core::geometry::BoxPx;
use scaleproof_pose::scene::Classes;

#[derive(Deserialize)]
struct Image {
    #[serde(deserialize_with = "coco::whole")]
    id: u64,
    file_name: String,
    #[serde(default, deserialize_with = "coco::whole_if_any")]
    width: Option<u32>,
    #[serde(default, deserialize_with = "coco::whole_if_any")]
    height: Option<u32>,
    #[serde(flatten)]
    about: About,
    #[serde(flatten)]
    other: BTreeMap<String, Value>,
}

#[derive(Deserialize, Default)]
struct Attributes {
    #[serde(flatten)]
    about: About,
    #[serde(flatten)]
    other: BTreeMap<String, Value>,
}

/// Keys of COCO's images, and of this program's exports, that are not conditions.
const NO_CONDITIONS: [&str; 5] = ["license", "flickr_url", "coco_url", "date_captured", "session"];

/// Fields of this program's own, beyond COCO.
#[derive(Deserialize, Default, Clone)]
struct About {
    variant: Option<String>,
    place: Option<String>,
    azimuth_deg: Option<f64>,
    pitch_deg: Option<f64>,
    distance_mm: Option<f64>,
}

/// Parses COCO's `images`, `annotations` and `categories`; a box of any label of `class` is the model's. An image or its annotation's `attributes`
/// may have `variant`, `place`, `azimuth_deg`, `pitch_deg` and `distance_mm`.
pub fn parse(text: &str, class: &Classes) -> Result<ImportedRows, ImportFault> {
    let fault =
        |e: serde_json::Error| ImportFault::at(format!("line {}", e.line()), parse_message(&e, "COCO annotations"));
    let file: File<Image, Attributes> = serde_json::from_str(text).map_err(fault)?;
    let boxes = boxes(&file, class)?;
    let mut ids = BTreeSet::new();
    let (mut rows, mut without_box) = (Vec::new(), Vec::new());
    for image in &file.images {
        let place = format!("image {}", image.id);
        if !ids.insert(image.id) {
            return Err(ImportFault::at(place, "its id appears twice: give every image its own"));
        }
        match boxes.get(&image.id).map(Vec::as_slice) {
            None | Some([]) => without_box.push(image.file_name.clone()),
            Some([annotation]) => rows.push(ImportedPhoto {
                entry: entry(image, annotation).map_err(|message| ImportFault::at(&place, message))?,
                size: image.width.zip(image.height).map(|(w, h)| [w, h]),
                place,
            }),
            Some(several) => {
                let message = format!(
                    "{} has {} boxes of {}, and a session one model in each photo: keep the model's box",
                    image.file_name,
                    several.len(),
                    class.quoted()
                );
                return Err(ImportFault::at(place, message));
            }
        }
    }
    match boxes.keys().find(|id| !ids.contains(id)) {
        Some(id) => Err(ImportFault::of_file(format!(
            "an annotation names image {id}, which is not in `images`"
        ))),
        None => Ok((rows, without_box)),
    }
}

type Boxes<'a> = BTreeMap<u64, Vec<&'a Annotation<Attributes>>>;

fn boxes<'a>(file: &'a File<Image, Attributes>, class: &Classes) -> Result<Boxes<'a>, ImportFault> {
    let is_own = |c: &&Category| c.name == class.joined() || class.labels().contains(&c.name);
    let own = file.categories.iter().filter(is_own);
    let wanted: Vec<u64> = own.map(|c| c.id).collect();
    if wanted.is_empty() {
        let known = file.categories.iter().take(8);
        let known: Vec<_> = known.map(|c| format!("`{}`", c.name)).collect();
        let more = if file.categories.len() > 8 { ", …" } else { "" };
        return Err(ImportFault::of_file(format!(
            "it has no category {}, the class of the scene's model; it has {}{more}",
            class.quoted(),
            known.join(", ")
        )));
    }
    let mut boxes = Boxes::new();
    for annotation in file.annotations.iter().filter(|a| wanted.contains(&a.category_id)) {
        boxes.entry(annotation.image_id).or_default().push(annotation);
    }
    Ok(boxes)
}

fn entry(image: &Image, annotation: &Annotation<Attributes>) -> Result<PhotoEntry, String> {
    let [x, y, width, height] = annotation.bbox;
    if !(width > 0.0 && height > 0.0) {
        return Err(format!(
            "bbox is {:?}: give x, y, width and height above 0, in px",
            annotation.bbox
        ));
    }
    let own = &image.about;
    let attributes = annotation.attributes.as_ref();
    let other = attributes.map(|a| a.about.clone()).unwrap_or_default();
    let kept = attributes.into_iter().flat_map(|a| &a.other).chain(&image.other);
    let kept = kept.filter(|(name, _)| is_name(name) && !NO_CONDITIONS.contains(&name.as_str()));
    Ok(PhotoEntry {
        file: image.file_name.clone(),
        variant: own.variant.clone().or(other.variant).unwrap_or_default(),
        place: own.place.clone().or(other.place),
        box_xyxy_px: Some(BoxPx::new(x, y, x + width, y + height)),
        viewpoint: viewpoint([
            own.azimuth_deg.or(other.azimuth_deg),
            own.pitch_deg.or(other.pitch_deg),
            own.distance_mm.or(other.distance_mm),
        ])?,
        conditions: kept
            .filter_map(|(name, value)| Some((name.clone(), scalar(value)?)))
            .collect(),
        ..PhotoEntry::default()
    })
}
