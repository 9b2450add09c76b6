//! Detections in several crops of one photo, joined to one list.

use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{Detection, MAX_DETECTIONS, SCORE_FLOOR};

/// Least IoU of boxes of one label that are of one object.
const SAME_IOU: f64 = 0.5;

/// Boxes of one object, at most one of each crop.
struct Object {
    surest: Detection,
    cuttings: Vec<usize>,
    sum: f64,
    /// Sums of the corners of the boxes, weighted by their scores.
    weighted: [f64; 4],
}

impl Object {
    fn takes(&self, found: &Detection, cutting: usize) -> bool {
        let is_same = self.surest.label == found.label && self.surest.box_px.iou(&found.box_px) >= SAME_IOU;
        is_same && !self.cuttings.contains(&cutting)
    }

    fn add(&mut self, found: &Detection, cutting: usize) {
        self.cuttings.push(cutting);
        self.sum += found.score;
        let corners = <[f64; 4]>::from(found.box_px);
        self.weighted = std::array::from_fn(|i| self.weighted[i] + found.score * corners[i]);
    }

    /// Returns its box, the mean weighted by the scores, and the mean score over all crops that show its middle, whether they found it or not.
    fn mean(&self, windows: &[BoxPx]) -> Option<Detection> {
        let b = BoxPx::from(self.weighted.map(|v| v / self.sum));
        let (x, y) = (0.5 * (b.x1 + b.x2), 0.5 * (b.y1 + b.y2));
        let shown = windows
            .iter()
            .filter(|w| w.x1 <= x && x <= w.x2 && w.y1 <= y && y <= w.y2);
        let of = shown.count().max(self.cuttings.len());
        Detection::new(self.surest.label, self.sum / of as f64, b)
    }
}

/// Joins the detections `found` in each crop, in the photo's pixels; `windows`: the crops. One list stays as it is.
///
/// Guo et al. (2018) average the answers of a classifier to random crops. For boxes that is a mean over those of one object, as Solovyev et al.
/// ("Weighted boxes fusion", 2021) average those of several detectors.
pub(crate) fn joined(mut found: Vec<Vec<Detection>>, windows: &[BoxPx]) -> Vec<Detection> {
    if found.len() == 1 {
        return found.pop().unwrap_or_default();
    }
    let cuttings = found.into_iter().enumerate();
    let mut all: Vec<(usize, Detection)> = cuttings
        .flat_map(|(i, own)| own.into_iter().map(move |d| (i, d)))
        .collect();
    all.sort_by(|(_, a), (_, b)| b.score.total_cmp(&a.score));
    let mut objects: Vec<Object> = Vec::new();
    for (cutting, found) in all {
        if let Some(object) = objects.iter_mut().find(|object| object.takes(&found, cutting)) {
            object.add(&found, cutting);
            continue;
        }
        let mut object = Object {
            surest: found.clone(),
            cuttings: Vec::new(),
            sum: 0.0,
            weighted: [0.0; 4],
        };
        object.add(&found, cutting);
        objects.push(object);
    }
    let mut means: Vec<Detection> = objects.iter().filter_map(|object| object.mean(windows)).collect();
    means.retain(|d| d.score >= SCORE_FLOOR);
    means.sort_by(|a, b| b.score.total_cmp(&a.score));
    means.truncate(MAX_DETECTIONS);
    means
}
