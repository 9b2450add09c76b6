//! APRICOT's targeted AP, as Armory computes it: AP of one label at the places of the pattern.

use crate::figures::protocol_table::armory::eleven_recalls;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;

/// Computes AP of one label at patches that all have it for their target: one detection a patch is right, the others of the label there are ignored,
/// and those elsewhere do not count.
pub fn targeted_ap(images: &[(BoxPx, &[Detection])], label: usize, iou: f64) -> f64 {
    let best = images.iter().filter_map(|(patch, detections)| {
        let there = detections
            .iter()
            .filter(|d| d.label == label && d.box_px.iou(patch) > iou);
        there.map(|d| d.score).max_by(f64::total_cmp)
    });
    // Every detection that counts is right, so that precision is 1 up to the recall reached.
    let found = best.count();
    let curve: Vec<(f64, f64)> = (1..=found).map(|n| (1.0, n as f64 / images.len() as f64)).collect();
    eleven_recalls(&curve)
}
