//! `coco_truth.json`: the truth boxes as a COCO annotation file, to be scored again by pycocotools or others.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::evaluated::EvaluatedDetector;
use crate::figures::{ScoredPhoto, Scores};
use crate::report::words::counted;
use scaleproof_pose::scene::Viewpoint;

#[derive(Serialize)]
struct Truth<'a> {
    info: Info,
    images: Vec<Image<'a>>,
    annotations: Vec<Annotation>,
    categories: Vec<Category>,
}

#[derive(Serialize)]
struct Info {
    description: String,
    version: &'static str,
}

#[derive(Serialize)]
struct Image<'a> {
    id: u64,
    file_name: String,
    width: u32,
    height: u32,
    variant: &'a str,
    session: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<&'a str>,
    /// Azimuth, elevation and distance, where they are known.
    #[serde(flatten)]
    viewpoint: Option<Viewpoint>,
    /// Weather, light and others, which `session import` keeps.
    #[serde(flatten)]
    conditions: BTreeMap<&'a str, &'a str>,
}

/// Names that a condition must not have: COCO or the fields above use them. Such conditions are left out.
const KEYS: [&str; 10] = [
    "place",
    "id",
    "file_name",
    "width",
    "height",
    "variant",
    "session",
    "azimuth_deg",
    "pitch_deg",
    "distance_mm",
];

#[derive(Serialize)]
struct Annotation {
    /// Number from 1 on: pycocotools takes id 0 for "unmatched".
    id: u64,
    image_id: u64,
    category_id: u32,
    bbox: [f64; 4],
    area: f64,
    iscrowd: u8,
}

#[derive(Serialize)]
struct Category {
    id: u32,
    name: String,
}

/// Categories that the report's COCO files share, whichever numbers each detector has. All labels that count as the model are one category, named as
/// in `car+truck`, so that tools that compare category with category give the figures of the report.
pub(crate) struct Categories {
    /// Category names by id.
    names: BTreeMap<u32, String>,
    /// Id of the category that counts as the model.
    model: u32,
}

impl Categories {
    pub(crate) fn from_scores(scores: &Scores) -> Categories {
        let first = scores.detectors.first();
        let model = first.and_then(|c| c.labels().category_id(*c.counted.first()?));
        let model = model.unwrap_or(1);
        let names = BTreeMap::from([(model, counted::classes(scores).joined())]);
        let mut categories = Categories { names, model };
        for detector in &scores.detectors {
            // The labels that do not count as the model.
            let others = (0..detector.labels().count()).filter(|label| !detector.counted.contains(label));
            others.for_each(|label| categories.add(detector, label));
        }
        categories
    }

    /// Adds a label under its own id where that is free, else behind all others.
    fn add(&mut self, detector: &EvaluatedDetector, label: usize) {
        let labels = detector.labels();
        let (Some(name), Some(own)) = (labels.name(label), labels.category_id(label)) else {
            return;
        };
        if self.other(name).is_none() {
            let last = self.names.keys().next_back().copied().unwrap_or_default();
            let id = if self.names.contains_key(&own) { last + 1 } else { own };
            self.names.insert(id, name.to_owned());
        }
    }

    fn other(&self, name: &str) -> Option<u32> {
        let mut others = self.names.iter().filter(|(id, _)| **id != self.model);
        others.find(|(_, known)| *known == name).map(|(id, _)| *id)
    }

    pub(crate) fn id(&self, detector: &EvaluatedDetector, label: usize) -> Option<u32> {
        let is_model = detector.counted.contains(&label);
        is_model
            .then_some(self.model)
            .or_else(|| self.other(detector.labels().name(label)?))
    }
}

pub(crate) fn truth(scores: &Scores) -> serde_json::Result<String> {
    let Categories { names, model } = Categories::from_scores(scores);
    annotations(scores, |photo| photo.file.clone(), names, model)
}

/// Returns a COCO annotation file whose images have these names, with boxes of the category `model`.
pub(crate) fn annotations(
    scores: &Scores,
    file_name: impl Fn(&ScoredPhoto) -> String,
    categories: impl IntoIterator<Item = (u32, String)>,
    model: u32,
) -> serde_json::Result<String> {
    let categories = categories.into_iter().map(|(id, name)| Category { id, name });
    let page = Truth {
        info: Info {
            description: format!(
                "truth boxes of scale-model photos: {}; counts as the model: {}",
                crate::report::words::truth::truth_boxes(scores),
                counted::labels(scores)
            ),
            version: env!("CARGO_PKG_VERSION"),
        },
        images: scores.photos.iter().map(|p| image(scores, p, file_name(p))).collect(),
        annotations: scores.photos.iter().map(|p| annotation(p, model)).collect(),
        categories: categories.collect(),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}

fn image<'a>(scores: &Scores, p: &'a ScoredPhoto, file_name: String) -> Image<'a> {
    let conditions = p.conditions.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    Image {
        id: p.id,
        file_name,
        width: p.width,
        height: p.height,
        variant: &p.variant,
        session: scores.sessions[p.session].name.clone(),
        place: p.place.as_deref(),
        viewpoint: p.viewpoint,
        conditions: conditions.filter(|(name, _)| !KEYS.contains(name)).collect(),
    }
}

fn annotation(p: &ScoredPhoto, category_id: u32) -> Annotation {
    Annotation {
        id: p.id,
        image_id: p.id,
        category_id,
        bbox: p.truth.to_xywh(),
        area: p.truth.area(),
        iscrowd: 0,
    }
}
