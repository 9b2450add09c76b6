//! COCO annotation files (cocodataset.org, "Data format", object detection), as far as they are read; other keys are passed over.

use serde::Deserialize;
use serde::de::IgnoredAny;

/// A file of images `I`, whose annotations have attributes `A` and, where it is read, the mark `C` of a crowd.
#[derive(Debug, Deserialize)]
pub struct File<I, A, C: Default = IgnoredAny> {
    pub images: Vec<I>,
    pub annotations: Vec<Annotation<A, C>>,
    pub categories: Vec<Category>,
}

/// A box in an image.
#[derive(Debug, Deserialize)]
pub struct Annotation<A, C: Default = IgnoredAny> {
    pub image_id: u64,
    pub category_id: u64,
    /// x, y, width, height in px.
    pub bbox: [f64; 4],
    /// 1 for a box around many objects.
    #[serde(default)]
    pub iscrowd: C,
    pub attributes: Option<A>,
}

/// What some boxes are called.
#[derive(Debug, Clone, Deserialize)]
pub struct Category {
    pub id: u64,
    pub name: String,
}
