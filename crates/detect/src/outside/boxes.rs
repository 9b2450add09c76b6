//! Boxes as files of another program have them, not checked yet.

/// The boxes of a photo.
#[derive(Debug, Default)]
pub(super) struct PhotoBoxes {
    pub boxes: Vec<RawBox>,
    /// Width and height of the photo in px, where the file states them.
    pub size: Option<[u32; 2]>,
    pub is_listed: bool,
}

/// A box as a file has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RawBox {
    pub label: usize,
    pub score: f64,
    /// x, y of the top-left corner, width, height.
    pub xywh: [f64; 4],
}

/// The contents of files of one format.
pub(super) struct ReadResults {
    pub by_photo: Vec<PhotoBoxes>,
    /// Images that are no photo of the run, as the file calls them.
    pub unknown: Vec<String>,
    pub files: Vec<(String, String)>,
}
