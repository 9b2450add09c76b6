//! Average precision as pycocotools computes it, on plain boxes.
//!
//! Source: `cocoeval.py` of pycocotools 2.0. Divergence: none known; a truth is never "crowd" or "ignored" here.

use crate::geometry::BoxPx;

/// Detections looked at per image, the best first.
const MAX_DETECTIONS: usize = 100;

/// The boxes of one image and one class.
#[derive(Debug, Clone, Default)]
pub struct ImageBoxes {
    pub truths: Vec<BoxPx>,
    /// (score, box), in the detector's order: equal scores keep it.
    pub detections: Vec<(f64, BoxPx)>,
}

/// AP and the recall reached over all images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AveragePrecision {
    /// Mean precision at the recalls 0, 0.01, …, 1.
    pub ap: f64,
    pub recall: f64,
}

/// AP over 101 recall points at one IoU threshold; `None` without any truth.
pub fn average_precision(images: &[ImageBoxes], iou: f64) -> Option<AveragePrecision> {
    let truths: usize = images.iter().map(|image| image.truths.len()).sum();
    if truths == 0 {
        return None;
    }
    let mut judged: Vec<(f64, bool)> = images.iter().flat_map(|image| judge(image, iou)).collect();
    judged.sort_by(|a, b| b.0.total_cmp(&a.0)); // stable, as pycocotools' merge sort
    let curve = precision_recall(&judged, truths);
    let recall = curve.last().map_or(0.0, |(_, recall)| *recall);
    Some(AveragePrecision {
        ap: interpolated(&curve),
        recall,
    })
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
        .map(|(score, b)| {
            let mut best = (iou.min(1.0 - 1e-10), None);
            for (i, truth) in image.truths.iter().enumerate() {
                let overlap = b.iou(truth);
                if !taken[i] && overlap >= best.0 {
                    best = (overlap, Some(i));
                }
            }
            if let Some(i) = best.1 {
                taken[i] = true;
            }
            (*score, best.1.is_some())
        })
        .collect()
}

/// (precision, recall) after each detection.
fn precision_recall(judged: &[(f64, bool)], truths: usize) -> Vec<(f64, f64)> {
    let mut right = 0;
    judged
        .iter()
        .enumerate()
        .map(|(i, (_, is_right))| {
            right += usize::from(*is_right);
            (right as f64 / (i + 1) as f64, right as f64 / truths as f64)
        })
        .collect()
}

/// Mean over the 101 recalls of the best precision at that recall or a higher one.
fn interpolated(curve: &[(f64, f64)]) -> f64 {
    let mut precision: Vec<f64> = curve.iter().map(|(p, _)| *p).collect();
    for i in (1..precision.len()).rev() {
        precision[i - 1] = precision[i - 1].max(precision[i]);
    }
    let at = |recall: f64| {
        let first = curve.partition_point(|(_, r)| *r < recall);
        precision.get(first).copied().unwrap_or(0.0)
    };
    // As numpy's linspace makes them: i times the step, which is not always the double nearest to i / 100.
    (0..=100)
        .map(|i| at(if i == 100 { 1.0 } else { f64::from(i) * 0.01 }))
        .sum::<f64>()
        / 101.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `k` of eight photos found, no false positive: the table of `notes/print_capture_score.md`.
    #[test]
    fn half_and_five_eighths_found() {
        let unit = BoxPx::new(0.0, 0.0, 10.0, 10.0);
        let ap = |found: usize| {
            let image = |i: usize| ImageBoxes {
                truths: vec![unit],
                detections: if i < found { vec![(0.9, unit)] } else { Vec::new() },
            };
            average_precision(&(0..8).map(image).collect::<Vec<_>>(), 0.5).unwrap()
        };
        assert!((ap(4).ap - 51.0 / 101.0).abs() < 1e-12);
        assert!((ap(5).ap - 63.0 / 101.0).abs() < 1e-12);
        assert_eq!((ap(8).ap, ap(0).ap, ap(0).recall), (1.0, 0.0, 0.0));
    }

    #[test]
    fn no_truth_is_no_number() {
        assert_eq!(average_precision(&[ImageBoxes::default()], 0.5), None);
    }
}
