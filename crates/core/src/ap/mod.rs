//! Average precision on plain boxes: matching as pycocotools does it, and the number by a named definition.
//!
//! Source: `cocoeval.py` of pycocotools 2.0. Divergence: none known; a truth is never "ignored" here for its size.

mod definition;

pub use definition::ApDefinition;

use crate::geometry::BoxPx;

/// Detections looked at per image, the best first.
const MAX_DETECTIONS: usize = 100;
/// COCO's IoU thresholds are 0.5, 0.55, …, 0.95.
const THRESHOLDS: u32 = 10;

#[derive(Debug, Clone, Default)]
pub struct ImageBoxes {
    pub truths: Vec<BoxPx>,
    /// Crowd regions, whose objects are not labelled one by one: a detection in one counts neither for nor against.
    pub crowds: Vec<BoxPx>,
    /// (score, box), in the detector's order: equal scores keep it.
    pub detections: Vec<(f64, BoxPx)>,
}

/// AP and the recall reached over all images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AveragePrecision {
    pub ap: f64,
    pub recall: f64,
}

/// Computes AP as COCO defines it, over 101 recall points, at one IoU threshold; `None` without any truth.
pub fn average_precision(images: &[ImageBoxes], iou: f64) -> Option<AveragePrecision> {
    average_precision_as(ApDefinition::Coco101, images, iou)
}

/// Computes AP by a definition, at one IoU threshold; `None` without any truth. Matching is COCO's in all of them.
pub fn average_precision_as(definition: ApDefinition, images: &[ImageBoxes], iou: f64) -> Option<AveragePrecision> {
    let curve = Ranked::new(images, iou).curve(|_| 1)?;
    Some(AveragePrecision {
        ap: definition.of_curve(&curve),
        recall: curve.last().map_or(0.0, |(_, recall)| *recall),
    })
}

/// Returns the means of AP and of the recall reached over COCO's ten IoU thresholds; `None` without any truth.
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

/// Returns the IoUs 0.5 to 0.95, as numpy's linspace computes them.
pub fn ious() -> impl Iterator<Item = f64> {
    (0..THRESHOLDS).map(|i| 0.5 + f64::from(i) * (0.45 / 9.0))
}

/// The detections of all images, judged once, from which curves of any resampling of the images follow.
pub struct Ranked {
    /// (image, found a truth), the most confident first.
    judged: Vec<(usize, bool)>,
    truths: Vec<usize>,
}

impl Ranked {
    pub fn new(images: &[ImageBoxes], iou: f64) -> Ranked {
        let of_image = |(i, image)| {
            judge(image, iou)
                .into_iter()
                .map(move |(score, right)| (score, i, right))
        };
        let mut judged: Vec<(f64, usize, bool)> = images.iter().enumerate().flat_map(of_image).collect();
        judged.sort_by(|a, b| b.0.total_cmp(&a.0)); // stable, as pycocotools' merge sort
        Ranked {
            judged: judged.into_iter().map(|(_, image, right)| (image, right)).collect(),
            truths: images.iter().map(|image| image.truths.len()).collect(),
        }
    }

    /// Computes (precision, recall) after each detection, each image counted `times` times; `None` without any truth.
    pub fn curve(&self, times: impl Fn(usize) -> u32) -> Option<Vec<(f64, f64)>> {
        let truths: usize = self.truths.iter().enumerate().map(|(i, n)| n * times(i) as usize).sum();
        let (mut all, mut right) = (0_usize, 0_usize);
        let mut curve = Vec::with_capacity(self.judged.len());
        for (image, is_right) in &self.judged {
            for _ in 0..times(*image) {
                all += 1;
                right += usize::from(*is_right);
                curve.push((right as f64 / all as f64, right as f64 / truths as f64));
            }
        }
        (truths > 0).then_some(curve)
    }
}

/// Matches the detections of an image, best first; returns the score of each, and true if it found a truth.
///
/// A detection takes the truth it overlaps most among those not taken yet; of equal overlaps the later truth.
fn judge(image: &ImageBoxes, iou: f64) -> Vec<(f64, bool)> {
    let mut order: Vec<&(f64, BoxPx)> = image.detections.iter().collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut taken = vec![false; image.truths.len()];
    order
        .into_iter()
        .take(MAX_DETECTIONS)
        .filter_map(|(score, b)| {
            let mut best = (iou.min(1.0 - 1e-10), None);
            for (i, truth) in image.truths.iter().enumerate() {
                let overlap = b.iou(truth);
                if !taken[i] && overlap >= best.0 {
                    best = (overlap, Some(i));
                }
            }
            // Which share of the box lies in a crowd.
            let area = ((b.x2 - b.x1) * (b.y2 - b.y1)).max(f64::MIN_POSITIVE);
            let share_inside = |crowd: &BoxPx| b.overlap(crowd) / area;
            match best.1 {
                Some(i) => taken[i] = true,
                None if image.crowds.iter().any(|crowd| share_inside(crowd) >= best.0) => return None,
                None => {}
            }
            Some((*score, best.1.is_some()))
        })
        .collect()
}
