//! From per-photo values to figures per detector and variant: over all photos, per azimuth, per cell, per place.

use std::collections::BTreeMap;

use serde::Serialize;

use super::grouping::{GroupBy, in_order};
use super::side::Side;
use super::{ApDefinition, EvaluatedDetector, MATCH_IOU, PhotoOutcome, ScoredPhoto, average_precision_as};
use scaleproof_core::ap::over_ious;
use scaleproof_core::statistics::{median, wilson_95};
use scaleproof_pose::scene::{Bin, Bins};

/// A share of photos with its 95 % Wilson interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Rate {
    /// Photos that count.
    pub count: usize,
    /// `count` divided by all photos of the group.
    pub rate: f64,
    /// Lower end of the 95 % Wilson interval of `rate`; `high` is the upper end.
    pub low: f64,
    pub high: f64,
}

impl Rate {
    /// So many of all; `None` of nothing.
    pub(super) fn new(count: usize, all: usize) -> Option<Rate> {
        let (low, high) = wilson_95(count, all)?;
        let rate = count as f64 / all as f64;
        Some(Rate { count, rate, low, high })
    }
}

/// The numbers of a group of photos, and how many photos they rest on; figures.md defines each one.
///
/// Every photo is in exactly one of `hit_rate`, `misclassification_rate` and `disappearance_rate`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Figures {
    pub photos: usize,
    /// Average precision at IoU 0.5, 0 to 1, by the run's definition of AP.
    pub ap50: f64,
    /// Mean of AP over IoU thresholds from 0.5 to 0.95.
    pub ap50_95: f64,
    /// Recall reached at IoU 0.5.
    pub mar50: f64,
    /// Mean of the recall reached over IoU thresholds from 0.5 to 0.95.
    pub mar: f64,
    /// Photos in which the model is found as its class.
    pub hit_rate: Rate,
    /// Photos in which the model is found as another class only.
    pub misclassification_rate: Rate,
    /// Photos in which nothing is found where the model is.
    pub disappearance_rate: Rate,
    /// Mean number of detections of the class where the model is not.
    pub hallucinations_per_image: f64,
    /// Mean number of detections of the class but for the one that finds the model: hallucinations and second boxes on the model.
    pub false_positives_per_image: f64,
    /// Mean over the photos of the highest confidence of the class on the model; a miss counts 0.
    pub mean_confidence: f64,
    /// Median over the photos of the highest confidence of the class on the model; a miss counts 0.
    pub median_confidence: f64,
}

/// Drops: figures of the base minus those of the variant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Drop {
    pub ap50: f64,
    pub hit_rate: f64,
    pub mean_confidence: f64,
    pub median_confidence: f64,
}

/// Attack success rates: 1 − figure of the variant ÷ figure of the base; `null` where that of the base is 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Asr {
    pub ap50: Option<f64>,
    pub mar50: Option<f64>,
    pub hit_rate: Option<f64>,
}

/// The figures of the photos of one value of a condition.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ConditionFigures {
    pub condition: String,
    pub value: String,
    pub figures: Figures,
    /// Drop from the base; `null` for the base, and when it has no photo of this value.
    pub drop: Option<Drop>,
    /// Attack success rates; `null` where `drop` is.
    pub asr: Option<Asr>,
}

/// The figures of one azimuth bin, over all its pitches and distances.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BinFigures {
    /// Azimuth of the bin's centre.
    pub azimuth_deg: f64,
    /// Figures of the bin; `null` when it has no photo.
    pub figures: Option<Figures>,
    /// Drop from the base; `null` for the base, and when the bin has no photo of one of the two.
    pub drop: Option<Drop>,
}

/// The figures of one bin of azimuth × pitch × distance.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CellFigures {
    #[serde(flatten)]
    pub bin: Bin,
    pub figures: Figures,
    /// Drop from the base; `null` for the base, and when it has no photo in this bin.
    pub drop: Option<Drop>,
}

/// The figures of the photos of one place.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PlaceFigures {
    /// Name of the place; `null` for the photos whose session names none.
    pub place: Option<String>,
    pub figures: Figures,
    /// Drop from the base; `null` for the base, and when it has no photo of this place.
    pub drop: Option<Drop>,
}

/// One detector on one variant.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Summary {
    pub detector: String,
    pub variant: String,
    /// Figures over all photos.
    pub overall: Figures,
    /// Drop from the base to this variant, over all photos; `null` for the base and when the run has none.
    pub drop: Option<Drop>,
    /// Attack success rates over all photos; `null` where `drop` is.
    pub asr: Option<Asr>,
    /// All azimuth bins of the scene, from the front counter-clockwise.
    pub azimuth_bins: Vec<BinFigures>,
    /// The bins that have photos of this variant, by azimuth, pitch and distance.
    pub cells: Vec<CellFigures>,
    /// The places that have photos of this variant, by name.
    pub places: Vec<PlaceFigures>,
    /// With `--group-by`: the values that have photos of this variant, in the order of the conditions asked for.
    pub conditions: Vec<ConditionFigures>,
}

/// What summaries depend on besides photos and detectors.
#[derive(Clone, Copy)]
pub(super) struct Basis<'a> {
    pub bins: &'a Bins,
    pub ap: ApDefinition,
    /// The variant that drops are measured from.
    pub base: &'a str,
    pub groups: &'a [GroupBy],
}

/// Figures of every detector on every variant, the base variant first, the others by name.
pub(super) fn summaries(photos: &[ScoredPhoto], detectors: &[EvaluatedDetector], basis: Basis) -> Vec<Summary> {
    let mut summaries = Vec::new();
    for (side, detector) in Side::each(detectors) {
        let variants = variants(photos, basis.base).into_iter();
        let groups = variants.filter_map(|v| Group::new(v, photos, (side, basis.ap), basis.groups));
        let groups: Vec<Group> = groups.collect();
        let base = groups.iter().find(|g| g.variant == basis.base);
        summaries.extend(groups.iter().map(|group| {
            let base = base.filter(|base| base.variant != group.variant);
            group.summary(detector.manifest.name.clone(), base, basis.bins)
        }));
    }
    summaries
}

/// Whose figures, and by which AP.
type By<'a> = (Side<'a>, ApDefinition);

/// The figures of one detector on one variant.
struct Group {
    variant: String,
    overall: Figures,
    /// By azimuth in thousandths of a degree.
    by_azimuth: BTreeMap<i64, Figures>,
    by_cell: BTreeMap<Bin, Figures>,
    by_place: BTreeMap<Option<String>, Figures>,
    /// By condition and value, in the order of the conditions and then of their values.
    by_condition: Vec<([String; 2], Figures)>,
}

impl Group {
    /// `None` without a photo of the variant.
    fn new(variant: String, photos: &[ScoredPhoto], side: By, groups: &[GroupBy]) -> Option<Group> {
        let photos: Vec<&ScoredPhoto> = photos.iter().filter(|p| p.variant == variant).collect();
        Some(Group {
            by_condition: groups.iter().flat_map(|g| by_condition(&photos, side, g)).collect(),
            overall: figures(&photos, side)?,
            by_azimuth: by(&photos, side, |p| p.bin.map(|b| thousandths(b.azimuth_deg))),
            by_cell: by(&photos, side, |p| p.bin),
            by_place: by(&photos, side, |p| Some(p.place.clone())),
            variant,
        })
    }

    /// These figures, and their drop from the base's.
    fn summary(&self, detector: String, base: Option<&Group>, bins: &Bins) -> Summary {
        let azimuth_bin = |azimuth_deg: f64| {
            let of = |group: &Group| group.by_azimuth.get(&thousandths(azimuth_deg)).copied();
            let figures = of(self);
            BinFigures {
                azimuth_deg,
                figures,
                drop: figures.and_then(|own| Some(drop(&base.and_then(of)?, &own))),
            }
        };
        let cell = |(bin, figures): (&Bin, &Figures)| CellFigures {
            bin: *bin,
            figures: *figures,
            drop: base.and_then(|b| Some(drop(b.by_cell.get(bin)?, figures))),
        };
        let place = |(place, figures): (&Option<String>, &Figures)| PlaceFigures {
            place: place.clone(),
            figures: *figures,
            drop: base.and_then(|b| Some(drop(b.by_place.get(place)?, figures))),
        };
        let condition = |([condition, value], figures): &([String; 2], Figures)| {
            let is_own = |other: &&([String; 2], Figures)| other.0 == [condition.as_str(), value];
            let base = base.and_then(|b| b.by_condition.iter().find(is_own));
            ConditionFigures {
                condition: condition.clone(),
                value: value.clone(),
                figures: *figures,
                drop: base.map(|(_, base)| drop(base, figures)),
                asr: base.map(|(_, base)| asr(base, figures)),
            }
        };
        Summary {
            detector,
            variant: self.variant.clone(),
            overall: self.overall,
            drop: base.map(|base| drop(&base.overall, &self.overall)),
            asr: base.map(|base| asr(&base.overall, &self.overall)),
            azimuth_bins: bins.azimuth_centres().into_iter().map(azimuth_bin).collect(),
            cells: self.by_cell.iter().map(cell).collect(),
            places: self.by_place.iter().map(place).collect(),
            conditions: self.by_condition.iter().map(condition).collect(),
        }
    }
}

/// A key that can be compared.
fn thousandths(azimuth_deg: f64) -> i64 {
    (azimuth_deg * 1000.0).round() as i64
}

/// The figures of each group of photos; a photo without a key is in none.
fn by<K: Ord>(photos: &[&ScoredPhoto], side: By, key: impl Fn(&ScoredPhoto) -> Option<K>) -> BTreeMap<K, Figures> {
    let mut groups: BTreeMap<K, Vec<&ScoredPhoto>> = BTreeMap::new();
    for (photo, key) in photos.iter().filter_map(|p| Some((p, key(p)?))) {
        groups.entry(key).or_default().push(photo);
    }
    let figures = |(key, group): (K, Vec<_>)| Some((key, figures(&group, side)?));
    groups.into_iter().filter_map(figures).collect()
}

/// The figures of each value of a condition.
fn by_condition(photos: &[&ScoredPhoto], side: By, group: &GroupBy) -> Vec<([String; 2], Figures)> {
    let mut figures = by(photos, side, |p| group.group_of(p));
    let values = in_order(figures.keys().cloned().collect()).into_iter();
    values
        .filter_map(|value| {
            figures
                .remove(&value)
                .map(|own| ([group.condition.clone(), value], own))
        })
        .collect()
}

/// The variants present, the base variant first.
pub(super) fn variants(photos: &[ScoredPhoto], base: &str) -> Vec<String> {
    let mut variants: Vec<String> = photos.iter().map(|p| p.variant.clone()).collect();
    variants.sort_by_key(|v| (v != base, v.clone()));
    variants.dedup();
    variants
}

/// Figures of one detector on a group of photos; `None` for an empty group.
fn figures(photos: &[&ScoredPhoto], (side, ap): By) -> Option<Figures> {
    let images = side.images(photos.iter().copied());
    let outcomes = || photos.iter().map(|p| side.outcome(p));
    let mean = |of: fn(&PhotoOutcome) -> f64| outcomes().map(of).sum::<f64>() / photos.len() as f64;
    let rate = |counts: fn(&PhotoOutcome) -> bool| Rate::new(outcomes().filter(|o| counts(o)).count(), photos.len());
    let at_half = average_precision_as(ap, &images, MATCH_IOU)?;
    let over = over_ious(ap, &images)?;
    Some(Figures {
        photos: photos.len(),
        ap50: at_half.ap,
        ap50_95: over.ap,
        mar50: at_half.recall,
        mar: over.recall,
        hit_rate: rate(PhotoOutcome::is_hit)?,
        misclassification_rate: rate(PhotoOutcome::is_misclassified)?,
        disappearance_rate: rate(PhotoOutcome::has_disappeared)?,
        hallucinations_per_image: mean(|o| o.hallucinations as f64),
        false_positives_per_image: mean(|o| o.false_positives as f64),
        mean_confidence: mean(|o| o.confidence),
        median_confidence: median(&outcomes().map(|o| o.confidence).collect::<Vec<_>>())?,
    })
}

fn asr(base: &Figures, figures: &Figures) -> Asr {
    let of = |base: f64, own: f64| (base > 0.0).then(|| 1.0 - own / base);
    Asr {
        ap50: of(base.ap50, figures.ap50),
        mar50: of(base.mar50, figures.mar50),
        hit_rate: of(base.hit_rate.rate, figures.hit_rate.rate),
    }
}

fn drop(base: &Figures, figures: &Figures) -> Drop {
    Drop {
        ap50: base.ap50 - figures.ap50,
        hit_rate: base.hit_rate.rate - figures.hit_rate.rate,
        mean_confidence: base.mean_confidence - figures.mean_confidence,
        median_confidence: base.median_confidence - figures.median_confidence,
    }
}
