//! From per-photo values to figures per detector, variant and azimuth bin.

use serde::Serialize;

use super::{BASE_VARIANT, Contestant, ImageBoxes, MATCH_IOU, ScoredPhoto, average_precision, wilson_95};
use crate::scene::Bins;

/// A share of photos with its 95 % Wilson interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rate {
    pub hits: usize,
    pub rate: f64,
    pub low: f64,
    pub high: f64,
}

/// The three numbers of a group of photos, and how many photos they rest on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    pub photos: usize,
    pub ap50: f64,
    pub hit_rate: Rate,
    pub mean_confidence: f64,
}

/// Base figures minus these figures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Drop {
    pub ap50: f64,
    pub hit_rate: f64,
    pub mean_confidence: f64,
}

/// The figures of one azimuth bin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BinFigures {
    pub azimuth_deg: f64,
    /// Absent when the bin has no photo.
    pub figures: Option<Figures>,
    pub drop: Option<Drop>,
}

/// One detector on one variant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    pub detector: String,
    pub variant: String,
    pub overall: Figures,
    /// Absent for the base variant and when the run has none.
    pub drop: Option<Drop>,
    /// All azimuth bins of the scene, from the front counter-clockwise.
    pub azimuth_bins: Vec<BinFigures>,
}

/// Figures of every contestant on every variant, the base variant first, the others by name.
pub(super) fn summaries(photos: &[ScoredPhoto], contestants: &[Contestant], bins: &Bins) -> Vec<Summary> {
    let mut summaries = Vec::new();
    for (index, contestant) in contestants.iter().enumerate() {
        let groups: Vec<Group> = variants(photos)
            .into_iter()
            .filter_map(|v| Group::new(v, photos, index, contestant.class, bins))
            .collect();
        let base = groups.iter().find(|g| g.variant == BASE_VARIANT);
        summaries.extend(groups.iter().map(|group| {
            let base = base.filter(|base| base.variant != group.variant);
            group.summary(contestant.manifest.name.clone(), base)
        }));
    }
    summaries
}

/// The figures of one contestant on one variant.
struct Group {
    variant: String,
    overall: Figures,
    /// By azimuth bin, from the front on.
    by_azimuth: Vec<(f64, Option<Figures>)>,
}

impl Group {
    /// `None` without a photo of the variant.
    fn new(variant: String, photos: &[ScoredPhoto], index: usize, class: usize, bins: &Bins) -> Option<Group> {
        let photos: Vec<&ScoredPhoto> = photos.iter().filter(|p| p.variant == variant).collect();
        let in_bin = |azimuth_deg: f64| -> Vec<&ScoredPhoto> {
            photos
                .iter()
                .copied()
                .filter(|p| p.bin.is_some_and(|b| b.azimuth_deg == azimuth_deg))
                .collect()
        };
        let centres = bins.azimuth_centres().into_iter();
        let by_azimuth = centres
            .map(|azimuth_deg| (azimuth_deg, figures(&in_bin(azimuth_deg), index, class)))
            .collect();
        Some(Group {
            overall: figures(&photos, index, class)?,
            by_azimuth,
            variant,
        })
    }

    /// These figures, and their drop from the base's.
    fn summary(&self, detector: String, base: Option<&Group>) -> Summary {
        let azimuth_bins = self.by_azimuth.iter().enumerate().map(|(i, (azimuth_deg, figures))| {
            let base = base.and_then(|b| b.by_azimuth[i].1.as_ref());
            let drop = base.zip(figures.as_ref()).map(|(base, own)| drop(base, own));
            BinFigures {
                azimuth_deg: *azimuth_deg,
                figures: *figures,
                drop,
            }
        });
        Summary {
            detector,
            variant: self.variant.clone(),
            overall: self.overall,
            drop: base.map(|base| drop(&base.overall, &self.overall)),
            azimuth_bins: azimuth_bins.collect(),
        }
    }
}

/// The variants present, the base variant first.
pub(super) fn variants(photos: &[ScoredPhoto]) -> Vec<String> {
    let mut variants: Vec<String> = photos.iter().map(|p| p.variant.clone()).collect();
    variants.sort_by_key(|v| (v != BASE_VARIANT, v.clone()));
    variants.dedup();
    variants
}

/// Figures of one contestant on a group of photos; `None` for an empty group.
fn figures(photos: &[&ScoredPhoto], contestant: usize, class: usize) -> Option<Figures> {
    let images: Vec<ImageBoxes> = photos.iter().map(|p| boxes(p, contestant, class)).collect();
    let ap50 = average_precision(&images, MATCH_IOU)?.ap;
    let outcomes = || photos.iter().map(|p| &p.outcomes[contestant]);
    let hits = outcomes().filter(|o| o.is_hit()).count();
    let (low, high) = wilson_95(hits, photos.len())?;
    Some(Figures {
        photos: photos.len(),
        ap50,
        hit_rate: Rate {
            hits,
            rate: hits as f64 / photos.len() as f64,
            low,
            high,
        },
        mean_confidence: outcomes().map(|o| o.confidence).sum::<f64>() / photos.len() as f64,
    })
}

/// The boxes of the model's class in one photo, as AP takes them.
pub(super) fn boxes(photo: &ScoredPhoto, contestant: usize, class: usize) -> ImageBoxes {
    let detections = photo.detections[contestant].iter().filter(|d| d.label == class);
    ImageBoxes {
        truths: vec![photo.truth],
        detections: detections.map(|d| (d.score, d.box_px)).collect(),
    }
}

fn drop(base: &Figures, figures: &Figures) -> Drop {
    Drop {
        ap50: base.ap50 - figures.ap50,
        hit_rate: base.hit_rate.rate - figures.hit_rate.rate,
        mean_confidence: base.mean_confidence - figures.mean_confidence,
    }
}
