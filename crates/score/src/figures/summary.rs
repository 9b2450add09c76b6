//! Figures per detector and variant, from per-photo values: over all photos, per azimuth, per cell, per place.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::evaluated::EvaluatedDetector;
use crate::figures::grouping::in_order;
use crate::figures::{DetectorView, GroupBy, MATCH_IOU, PhotoOutcome, ScoredPhoto, variants};
use scaleproof_core::ap::{ApDefinition, average_precision_as, over_ious};
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
    /// Returns the rate of `count` photos among `all`; `None` among none.
    pub(crate) fn new(count: usize, all: usize) -> Option<Rate> {
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

/// Choices that summaries depend on besides photos and detectors.
#[derive(Clone, Copy)]
pub(crate) struct Basis<'a> {
    pub bins: &'a Bins,
    pub ap: ApDefinition,
    /// The variant that drops are measured from.
    pub base: &'a str,
    pub groups: &'a [GroupBy],
}

/// Returns the figures of every detector on every variant, the base variant first, the others by name.
pub(crate) fn summaries(photos: &[ScoredPhoto], detectors: &[EvaluatedDetector], basis: Basis) -> Vec<Summary> {
    let mut summaries = Vec::new();
    for (side, detector) in DetectorView::each(detectors) {
        let name = &detector.manifest.name;
        let variants = variants(photos, basis.base).into_iter();
        let mut own: Vec<Summary> = variants
            .filter_map(|v| Summary::new(name, v, photos, side, basis))
            .collect();
        // The base comes first where there is one.
        if let Some((base, others)) = own.split_first_mut().filter(|(first, _)| first.variant == basis.base) {
            others.iter_mut().for_each(|other| other.drop_from(base));
        }
        summaries.append(&mut own);
    }
    summaries
}

/// Detector whose figures are computed, and definition of AP.
type ViewAndAp<'a> = (DetectorView<'a>, ApDefinition);

impl Summary {
    /// Computes the figures alone, without drops; `None` without a photo of the variant.
    fn new(
        detector: &str,
        variant: String,
        photos: &[ScoredPhoto],
        side: DetectorView,
        basis: Basis,
    ) -> Option<Summary> {
        let photos: Vec<&ScoredPhoto> = photos.iter().filter(|p| p.variant == variant).collect();
        let view_and_ap = (side, basis.ap);
        let by_azimuth = figures_by(&photos, view_and_ap, |p| p.bin.map(|b| thousandths(b.azimuth_deg)));
        let azimuth_bins = basis.bins.azimuth_centres().into_iter().map(|azimuth_deg| BinFigures {
            azimuth_deg,
            figures: by_azimuth.get(&thousandths(azimuth_deg)).copied(),
            drop: None,
        });
        let (cells, places) = (
            figures_by(&photos, view_and_ap, |p| p.bin),
            figures_by(&photos, view_and_ap, |p| Some(p.place.clone())),
        );
        let cell = |(bin, figures)| CellFigures {
            bin,
            figures,
            drop: None,
        };
        let place = |(place, figures)| PlaceFigures {
            place,
            figures,
            drop: None,
        };
        Some(Summary {
            overall: figures(&photos, view_and_ap)?,
            drop: None,
            asr: None,
            azimuth_bins: azimuth_bins.collect(),
            cells: cells.into_iter().map(cell).collect(),
            places: places.into_iter().map(place).collect(),
            conditions: basis
                .groups
                .iter()
                .flat_map(|g| by_condition(&photos, view_and_ap, g))
                .collect(),
            detector: detector.to_owned(),
            variant,
        })
    }

    /// Fills in the drops from the base's figures.
    fn drop_from(&mut self, base: &Summary) {
        self.drop = Some(drop(&base.overall, &self.overall));
        self.asr = Some(asr(&base.overall, &self.overall));
        for (own, base) in self.azimuth_bins.iter_mut().zip(&base.azimuth_bins) {
            own.drop = base.figures.zip(own.figures).map(|(base, own)| drop(&base, &own));
        }
        for own in &mut self.cells {
            let base = base.cells.iter().find(|base| base.bin == own.bin);
            own.drop = base.map(|base| drop(&base.figures, &own.figures));
        }
        for own in &mut self.places {
            let base = base.places.iter().find(|base| base.place == own.place);
            own.drop = base.map(|base| drop(&base.figures, &own.figures));
        }
        for own in &mut self.conditions {
            let is_own = |base: &&ConditionFigures| (&base.condition, &base.value) == (&own.condition, &own.value);
            let base = base.conditions.iter().find(is_own);
            own.drop = base.map(|base| drop(&base.figures, &own.figures));
            own.asr = base.map(|base| asr(&base.figures, &own.figures));
        }
    }
}

/// Returns an azimuth as a key that can be compared, in thousandths of a degree.
pub(crate) fn thousandths(azimuth_deg: f64) -> i64 {
    (azimuth_deg * 1000.0).round() as i64
}

/// Returns the figures of each group of photos; a photo without a key is in none.
fn figures_by<K: Ord>(
    photos: &[&ScoredPhoto],
    side: ViewAndAp,
    key: impl Fn(&ScoredPhoto) -> Option<K>,
) -> BTreeMap<K, Figures> {
    let mut groups: BTreeMap<K, Vec<&ScoredPhoto>> = BTreeMap::new();
    for (photo, key) in photos.iter().filter_map(|p| Some((p, key(p)?))) {
        groups.entry(key).or_default().push(photo);
    }
    let figures = |(key, group): (K, Vec<_>)| Some((key, figures(&group, side)?));
    groups.into_iter().filter_map(figures).collect()
}

fn by_condition(photos: &[&ScoredPhoto], side: ViewAndAp, group: &GroupBy) -> Vec<ConditionFigures> {
    let figures = figures_by(photos, side, |p| group.group_of(p));
    let values = in_order(figures.keys().cloned().collect()).into_iter();
    let of_value = |value: String| ConditionFigures {
        condition: group.condition.clone(),
        figures: figures[&value],
        drop: None,
        asr: None,
        value,
    };
    values.map(of_value).collect()
}

/// Computes the figures of one detector on a group of photos; `None` for an empty group.
fn figures(photos: &[&ScoredPhoto], (side, ap): ViewAndAp) -> Option<Figures> {
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
