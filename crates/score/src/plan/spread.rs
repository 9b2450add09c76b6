//! Scatter of the differences of the confidence from view to view: of given photos, or as in the stored ones.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::compare::{Cell, LEAST_SEEN, pair, view};
use crate::figures::{DetectorView, ScoredPhoto, Scores, variants};
use scaleproof_core::statistics::FEWEST_CLUSTERS;

/// Scatter of the differences of the confidence between two photos of a view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// Standard deviation from view to view, of one detector.
    pub deviation: f64,
    /// Correlation between two detectors.
    pub correlation: f64,
    pub from: SpreadFrom,
}

/// Source of a spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpreadFrom {
    /// The stored photos: session and films (`captures/skyline`, `captures/walk`), five detectors, plain against random.
    StoredPhotos,
    /// Plain photos alone: the differences are assumed to vary from view to view as the plain confidence does. Pooled over the detectors that was so in the stored
    /// photos (0.203 and 0.213 in the session, 0.198 and 0.201 in the films). Their correlation cannot be known from plain photos, and is that of the stored ones.
    PlainPhotos,
    /// Photos of two textures or more, paired by view.
    PairedPhotos,
}

impl Spread {
    /// Spread of the stored photos: the means over session (0.213, correlated by 0.37) and films (0.201, correlated by 0.21).
    pub const STORED: Spread = Spread {
        deviation: 0.21,
        correlation: 0.29,
        from: SpreadFrom::StoredPhotos,
    };
}

/// Properties of given photos from which further ones can be planned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed {
    pub spread: Spread,
    pub views: usize,
    pub detectors: usize,
    /// Number of textures besides the base; 0 where all photos are plain.
    pub textures: usize,
    /// The largest mean confidence of the base, of all detectors: no drop is larger.
    pub most_drop: f64,
}

/// Too few photos to know how anything varies from view to view.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the spread from view to view takes {FEWEST_CLUSTERS} views of `{base}` that a detector sees, and there are {views}"
)]
pub struct FewViews {
    pub base: String,
    pub views: usize,
}

/// A detector's figures by view.
type ByView = Vec<f64>;

impl Observed {
    pub fn of(scores: &Scores) -> Result<Observed, FewViews> {
        let sides: Vec<DetectorView> = DetectorView::each(&scores.detectors).map(|(side, _)| side).collect();
        let plain: Vec<ByView> = sides.iter().map(|side| plain(scores, *side)).collect();
        let seen: Vec<usize> = (0..sides.len()).filter(|k| mean(&plain[*k]) >= LEAST_SEEN).collect();
        let own = |all: &dyn Fn(usize) -> ByView| -> Vec<ByView> { seen.iter().map(|k| all(*k)).collect() };
        let others: Vec<String> = variants(&scores.photos, &scores.base)
            .into_iter()
            .filter(|v| *v != scores.base)
            .collect();
        let of_texture = |texture: &String| {
            let (cells, _) = pair(scores.set(), &scores.base, texture);
            own(&|k| differences(&cells, sides[k]))
        };
        let paired: Vec<Vec<ByView>> = others.iter().map(of_texture).filter(|rows| are_enough(rows)).collect();
        let plain_seen = own(&|k| plain[k].clone());
        let spread = if !paired.is_empty() {
            Spread {
                deviation: deviation(paired.iter().flatten()),
                correlation: correlation(&paired),
                from: SpreadFrom::PairedPhotos,
            }
        } else if are_enough(&plain_seen) {
            Spread {
                deviation: deviation(plain_seen.iter()),
                from: SpreadFrom::PlainPhotos,
                ..Spread::STORED
            }
        } else {
            return Err(FewViews {
                base: scores.base.clone(),
                views: plain_seen.first().map_or(0, Vec::len),
            });
        };
        let rows = paired.first().unwrap_or(&plain_seen);
        Ok(Observed {
            spread,
            views: rows.first().map_or(0, Vec::len),
            detectors: sides.len(),
            textures: others.len(),
            most_drop: plain.iter().map(|row| mean(row)).fold(0.0, f64::max),
        })
    }
}

fn are_enough(rows: &[ByView]) -> bool {
    rows.first().is_some_and(|row| row.len() >= FEWEST_CLUSTERS)
}

/// Returns the mean confidence of the base in each place and bin.
fn plain(scores: &Scores, side: DetectorView) -> ByView {
    let counts = |photo: &&ScoredPhoto| photo.variant == scores.base && photo.repeat_of.is_none();
    let mut views: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for photo in scores.photos.iter().filter(counts) {
        if let Some(bin) = photo.bin {
            let confidence = side.outcome(photo).confidence;
            views.entry((bin, &photo.place)).or_default().push(confidence);
        }
    }
    views.values().map(|row| mean(row)).collect()
}

fn differences(cells: &[Cell], side: DetectorView) -> ByView {
    let sums = cells
        .iter()
        .map(|cell| view(cell, side).once)
        .filter(|sums| sums.pairs > 0);
    sums.map(|sums| sums.confidence_lost / sums.pairs as f64).collect()
}

fn mean(row: &[f64]) -> f64 {
    row.iter().sum::<f64>() / row.len().max(1) as f64
}

fn squares(row: &[f64]) -> f64 {
    products(row, row)
}

/// Returns the sum of the products of the deviations from both means.
fn products(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum()
}

/// Returns the standard deviation within rows, pooled.
fn deviation<'a>(rows: impl Iterator<Item = &'a ByView>) -> f64 {
    let (mut sum, mut freedom) = (0.0, 0);
    for row in rows {
        sum += squares(row);
        freedom += row.len() - 1;
    }
    (sum / freedom as f64).sqrt()
}

/// Returns Pearson's correlation, the mean over all pairs of detectors of a texture; 0 where that is negative or nothing varies.
fn correlation(textures: &[Vec<ByView>]) -> f64 {
    let mut all = Vec::new();
    for rows in textures {
        for (k, a) in rows.iter().enumerate() {
            for b in &rows[..k] {
                let scale = (squares(a) * squares(b)).sqrt();
                if scale > 0.0 {
                    all.push(products(a, b) / scale);
                }
            }
        }
    }
    mean(&all).clamp(0.0, 1.0)
}
