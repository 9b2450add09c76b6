//! Detections: boxes with labels and scores, in the precision that files keep.

use serde::{Deserialize, Serialize};

use scaleproof_core::geometry::BoxPx;

/// Candidates below this score are dropped; AP needs them down to here.
pub const SCORE_FLOOR: f64 = 0.001;

/// Most candidates that are kept per photo, the best first: as many as COCO's evaluation looks at.
pub const MAX_DETECTIONS: usize = 100;

/// A sigmoid or softmax may round up a little. What it rounded up is kept as 1, the highest score that files may have.
pub(crate) const HIGHEST_SCORE: f64 = 1.001;

/// One box a detector found.
///
/// Coordinates are rounded to 0.01 px and scores to 1e-6, so that a run and its recording are the same numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Detection {
    /// Index into the detector's labels.
    pub label: usize,
    /// Confidence, 0 to 1.
    pub score: f64,
    /// In pixels of the photo.
    pub box_px: BoxPx,
}

impl Detection {
    /// A detection in the precision that files keep; `None` when the numbers are not finite or the box is empty.
    pub fn new(label: usize, score: f64, b: BoxPx) -> Option<Detection> {
        let hundredth = |v: f64| (v * 100.0).round() / 100.0;
        let (x1, y1) = (hundredth(b.x1), hundredth(b.y1));
        // Width and height are what COCO files keep, so they are rounded, and the far corner follows from them.
        let (x2, y2) = (
            hundredth(x1 + hundredth(b.x2 - b.x1)),
            hundredth(y1 + hundredth(b.y2 - b.y1)),
        );
        let box_px = BoxPx::new(x1, y1, x2, y2);
        let score = (score * 1e6).round() / 1e6;
        (score.is_finite() && box_px.is_solid()).then_some(Detection { label, score, box_px })
    }

    /// `[x, y, width, height]` in hundredths of a pixel.
    pub fn to_xywh(&self) -> [f64; 4] {
        self.box_px.to_xywh().map(|v| (v * 100.0).round() / 100.0)
    }
}
