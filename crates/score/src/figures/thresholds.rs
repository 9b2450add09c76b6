//! Thresholds from which a detection counts.

/// Least IoU with the truth box at which a detection counts for the model.
pub const MATCH_IOU: f64 = 0.5;

/// Least confidence of the matching detection at which a photo counts as a hit, unless [`Criteria`](crate::Criteria) say otherwise.
pub const HIT_CONFIDENCE: f64 = 0.5;

/// Thresholds from which a detection counts.
#[derive(Debug, Clone, Copy)]
pub struct Thresholds {
    pub confidence: f64,
    pub iou: f64,
}
