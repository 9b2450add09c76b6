//! `coco_truth.json`: the truth boxes as a COCO annotation file, to be scored again by pycocotools or others.

use serde::Serialize;

use crate::scene::Viewpoint;
use crate::score::{ScoredPhoto, Scores};

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
    file_name: &'a str,
    width: u32,
    height: u32,
    variant: &'a str,
    session: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<&'a str>,
    /// Azimuth, pitch and distance, where they are known.
    #[serde(flatten)]
    viewpoint: Option<Viewpoint>,
}

#[derive(Serialize)]
struct Annotation {
    /// From 1: pycocotools takes id 0 for "unmatched".
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
    name: &'static str,
}

pub(super) fn truth(scores: &Scores) -> serde_json::Result<String> {
    let Some(contestant) = scores.contestants.first() else {
        return Ok("{}\n".into());
    };
    let labels = contestant.labels();
    let categories: Vec<Category> = (0..labels.count())
        .filter_map(|label| {
            Some(Category {
                id: labels.category_id(label)?,
                name: labels.name(label)?,
            })
        })
        .collect();
    let class = labels.category_id(contestant.class).unwrap_or_default();
    let page = Truth {
        info: Info {
            description: format!("truth boxes of scale-model photos: {}", super::truth_boxes(scores)),
            version: env!("CARGO_PKG_VERSION"),
        },
        images: scores.photos.iter().map(|p| image(scores, p)).collect(),
        annotations: scores.photos.iter().map(|p| annotation(p, class)).collect(),
        categories,
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}

fn image<'a>(scores: &Scores, p: &'a ScoredPhoto) -> Image<'a> {
    Image {
        id: p.id,
        file_name: &p.file,
        width: p.width,
        height: p.height,
        variant: &p.variant,
        session: scores.sessions[p.session].name.clone(),
        place: p.place.as_deref(),
        viewpoint: p.viewpoint,
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
