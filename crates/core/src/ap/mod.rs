//! Average precision on plain boxes: matching as pycocotools does it, and the number by a named definition.
//!
//! Source: `cocoeval.py` of pycocotools 2.0. Divergence: none known; a truth is never "ignored" here for its size.

mod averages;
mod definition;

pub use averages::{ious, over_ious};
pub use definition::ApDefinition;

use crate::geometry::BoxPx;

/// Detections looked at per image, the best first.
const MAX_DETECTIONS: usize = 100;

/// The boxes of one image and one class.
#[derive(Debug, Clone, Default)]
pub struct ImageBoxes {
    pub truths: Vec<BoxPx>,
    /// Regions of many that are not told apart: what lies in one counts neither for nor against.
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

/// AP as COCO defines it, over 101 recall points, at one IoU threshold; `None` without any truth.
pub fn average_precision(images: &[ImageBoxes], iou: f64) -> Option<AveragePrecision> {
    average_precision_as(ApDefinition::Coco101, images, iou)
}

/// AP by the definition named, at one IoU threshold; `None` without any truth. Matching is COCO's in all of them.
pub fn average_precision_as(definition: ApDefinition, images: &[ImageBoxes], iou: f64) -> Option<AveragePrecision> {
    let curve = Ranked::new(images, iou).curve(|_| 1)?;
    Some(AveragePrecision {
        ap: definition.of_curve(&curve),
        recall: curve.last().map_or(0.0, |(_, recall)| *recall),
    })
}

/// The detections of all images, judged once, from which curves of any resampling of the images follow.
pub struct Ranked {
    /// (image, found a truth), the most confident first.
    judged: Vec<(usize, bool)>,
    /// Truths of each image.
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

    /// (precision, recall) after each detection, each image taken `times` over; `None` without any truth.
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

/// Each detection of an image, best first: its score, and whether it found a truth.
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
            match best.1 {
                Some(i) => taken[i] = true,
                None if image.crowds.iter().any(|crowd| share_inside(b, crowd) >= best.0) => return None,
                None => {}
            }
            Some((*score, best.1.is_some()))
        })
        .collect()
}

/// Which share of a box lies in another: the overlap with a crowd.
fn share_inside(b: &BoxPx, other: &BoxPx) -> f64 {
    let width = (b.x2.min(other.x2) - b.x1.max(other.x1)).max(0.0);
    let height = (b.y2.min(other.y2) - b.y1.max(other.y1)).max(0.0);
    width * height / ((b.x2 - b.x1) * (b.y2 - b.y1)).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `k` of eight photos found, no false positive: what each definition makes of it.
    #[test]
    fn half_and_five_eighths_found() {
        let unit = BoxPx::new(0.0, 0.0, 10.0, 10.0);
        let found = |k: usize| {
            let image = |i: usize| ImageBoxes {
                truths: vec![unit],
                detections: if i < k { vec![(0.9, unit)] } else { Vec::new() },
                ..ImageBoxes::default()
            };
            (0..8).map(image).collect::<Vec<_>>()
        };
        let ap = |k, definition| average_precision_as(definition, &found(k), 0.5).unwrap().ap;
        let wanted = [
            [51.0 / 101.0, 0.5, 6.0 / 11.0, 0.75],
            [63.0 / 101.0, 0.625, 7.0 / 11.0, 0.8125],
        ];
        for (k, wanted) in [4, 5].into_iter().zip(wanted) {
            for (definition, wanted) in ApDefinition::ALL.into_iter().zip(wanted) {
                // The ramp's bend lies between two of its 101 recalls.
                let allowed = if definition == ApDefinition::Yolov5Ramp {
                    5e-5
                } else {
                    1e-12
                };
                assert!(
                    (ap(k, definition) - wanted).abs() < allowed,
                    "{k} {definition:?}: {}",
                    ap(k, definition)
                );
            }
        }
        for definition in ApDefinition::ALL {
            // Even a perfect curve falls to 0 at recall 1 in YOLOv5's: its best AP is 0.995.
            let best = if definition == ApDefinition::Yolov5Ramp {
                0.995
            } else {
                1.0
            };
            assert!((ap(8, definition) - best).abs() < 1e-12, "{definition:?}");
            assert_eq!(ap(0, definition), 0.0, "{definition:?}");
        }
    }

    #[test]
    fn no_truth_is_no_number() {
        assert_eq!(average_precision(&[ImageBoxes::default()], 0.5), None);
    }
}
