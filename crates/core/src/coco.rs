//! COCO annotation files (cocodataset.org, "Data format", object detection), as far as they are read; other keys are passed over.

use serde::Deserialize;

/// A file of images `I`, whose annotations have attributes `A`.
#[derive(Debug, Deserialize)]
pub struct File<I, A> {
    pub images: Vec<I>,
    pub annotations: Vec<Annotation<A>>,
    pub categories: Vec<Category>,
}

/// A box in an image.
#[derive(Debug, Deserialize)]
pub struct Annotation<A> {
    pub image_id: u64,
    pub category_id: u64,
    /// x, y, width, height in px.
    pub bbox: [f64; 4],
    /// 1 for a box around many objects.
    #[serde(default)]
    pub iscrowd: u8,
    pub attributes: Option<A>,
}

/// What some boxes are called.
#[derive(Debug, Clone, Deserialize)]
pub struct Category {
    pub id: u64,
    pub name: String,
}
