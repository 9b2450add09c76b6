//! Files of another program, and what they are about.

use std::path::Path;

use super::photo_names::PhotoName;

/// Files of another program, and the photos they are about.
#[derive(Debug, Clone, Copy)]
pub struct ResultsRequest<'a> {
    pub name: &'a str,
    /// A COCO results list, or a folder of YOLO's text files.
    pub path: &'a Path,
    /// The COCO file whose `images` the results number.
    pub images: Option<&'a Path>,
    /// Names of the labels; COCO's when absent.
    pub categories: Option<&'a Path>,
    /// The number of the first label, where labels are counted; as the format has it when absent.
    pub first_label: Option<u64>,
    /// The photos of the run, in its order.
    pub photos: &'a [PhotoName],
}
