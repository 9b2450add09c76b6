//! Averages over IoU thresholds, as COCO's evaluation prints them: AP@[.5:.95] and average recall.

use super::{ApDefinition, AveragePrecision, ImageBoxes, average_precision_as};

/// COCO's thresholds are 0.5, 0.55, …, 0.95.
const THRESHOLDS: u32 = 10;

/// The means of AP and of the recall reached over COCO's ten IoU thresholds; `None` without any truth.
pub fn over_ious(definition: ApDefinition, images: &[ImageBoxes]) -> Option<AveragePrecision> {
    let mut sum = AveragePrecision { ap: 0.0, recall: 0.0 };
    for iou in ious() {
        let own = average_precision_as(definition, images, iou)?;
        sum.ap += own.ap;
        sum.recall += own.recall;
    }
    let count = f64::from(THRESHOLDS);
    Some(AveragePrecision {
        ap: sum.ap / count,
        recall: sum.recall / count,
    })
}

/// IoU 0.5 to 0.95, as numpy's linspace makes them.
pub fn ious() -> impl Iterator<Item = f64> {
    (0..THRESHOLDS).map(|i| 0.5 + f64::from(i) * (0.45 / 9.0))
}
