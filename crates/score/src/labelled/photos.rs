//! Labelled photos, and the averages of a detector on them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::labelled::LabelledError;
use scaleproof_core::ap::{ApDefinition, ImageBoxes, Ranked, average_precision_as, ious, over_ious};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::{statistics, workers};
use scaleproof_detect::{Detection, Detector, Manifest, Runtime};
use scaleproof_photo::Photo;

#[derive(Debug)]
pub struct LabelledPhotos {
    pub photos: Vec<LabelledPhoto>,
    /// Categories whose names are no label of the detector, and which are left out.
    pub unknown: Vec<String>,
    /// For each label of the detector, the first that counts as the same (`[class_map]`).
    pub(crate) counts_as: Vec<usize>,
}

#[derive(Debug, Clone)]
pub struct LabelledPhoto {
    pub(crate) path: PathBuf,
    pub(crate) objects: Vec<Object>,
}

#[derive(Debug, Clone)]
pub(crate) struct Object {
    pub label: usize,
    pub box_px: BoxPx,
    pub is_crowd: bool,
}

/// COCO's two averages over the categories that have an object, crowds not counted.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Averages {
    /// COCO's `AP@[.5:.95]`, the figure that papers and repositories state.
    pub ap_50_95: f64,
    /// AP at IoU 0.5.
    pub ap_50: f64,
}

/// The detections of each photo, in the photos' order.
pub type PhotoDetections = Vec<Vec<Detection>>;

impl LabelledPhotos {
    pub fn counts(&self) -> [usize; 2] {
        let objects = self.photos.iter().flat_map(|photo| &photo.objects);
        let labels = objects.filter(|object| !object.is_crowd).map(|object| object.label);
        let mut labels: Vec<usize> = labels.collect();
        let boxes = labels.len();
        labels.sort_unstable();
        labels.dedup();
        [boxes, labels.len()]
    }

    /// Returns `count` of the photos, spread evenly over the list.
    pub fn sample(&self, count: usize) -> LabelledPhotos {
        let all = self.photos.len();
        let count = count.min(all);
        let photos = (0..count).map(|i| self.photos[i * all / count].clone());
        LabelledPhotos {
            photos: photos.collect(),
            unknown: Vec::new(),
            counts_as: self.counts_as.clone(),
        }
    }

    /// Runs a detector on every photo.
    pub fn detect(
        &self,
        manifest: &Manifest,
        weights: &Path,
        on_photo: impl Fn() + Sync,
    ) -> Result<PhotoDetections, LabelledError> {
        let open = || -> Result<Detector, LabelledError> { Ok(Detector::open(Runtime::load()?, manifest, weights)?) };
        let detect = |detector: &mut Detector, labelled: &LabelledPhoto| {
            let photo = Photo::open(&labelled.path)?;
            let image = photo.rgb(photo.reduction(manifest.least_px(photo.width, photo.height)))?;
            Ok(detector.detect_reduced(&image, photo.width, photo.height)?)
        };
        workers::map(&self.photos, open, detect, on_photo)
    }

    /// Returns the averages of the detections `found`; with `shift`, of labels that many entries further down the list. `None` without any object.
    pub fn averages(&self, found: &PhotoDetections, shift: i64) -> Option<Averages> {
        let objects = self.photos.iter().flat_map(|photo| &photo.objects);
        let highest = objects.map(|object| object.label).max()?;
        let of_label = (0..=highest).filter_map(|label| {
            let images = self.images(found, label, shift);
            let ap_50 = average_precision_as(ApDefinition::Coco101, &images, 0.5)?.ap;
            let ap_50_95 = over_ious(ApDefinition::Coco101, &images)?.ap;
            Some([ap_50_95, ap_50])
        });
        let of_label: Vec<[f64; 2]> = of_label.collect();
        let mean = |i: usize| of_label.iter().map(|averages| averages[i]).sum::<f64>() / of_label.len() as f64;
        let (ap_50_95, ap_50) = (mean(0), mean(1));
        (!of_label.is_empty()).then_some(Averages { ap_50_95, ap_50 })
    }

    fn images(&self, found: &PhotoDetections, label: usize, shift: i64) -> Vec<ImageBoxes> {
        let boxes = |(photo, found): (&LabelledPhoto, &Vec<Detection>)| {
            let own = |is_crowd: bool| {
                let objects = photo.objects.iter();
                let kept = objects.filter(move |object| object.label == label && object.is_crowd == is_crowd);
                kept.map(|object| object.box_px).collect()
            };
            let counted = |d: &Detection| {
                let shifted = usize::try_from(d.label as i64 + shift).ok()?;
                self.counts_as.get(shifted).copied()
            };
            let detections = found.iter().filter(|d| counted(d) == Some(label));
            ImageBoxes {
                truths: own(false),
                crowds: own(true),
                detections: detections.map(|d| (d.score, d.box_px)).collect(),
            }
        };
        self.photos.iter().zip(found).map(boxes).collect()
    }

    /// Returns the lower end of the 95 % bootstrap interval, over photos, of the gain in AP@[.5:.95] from `before` to `after`, whose labels are `shift`
    /// entries further down the list. `None` with too few photos.
    pub fn least_gain(&self, before: &PhotoDetections, after: &PhotoDetections, shift: i64) -> Option<f64> {
        let objects = self.photos.iter().flat_map(|photo| &photo.objects);
        let labels: BTreeSet<usize> = objects.map(|o| o.label).collect();
        let ranked = |found: &PhotoDetections, label: usize, shift: i64| {
            let images = self.images(found, label, shift);
            ious().map(move |iou| Ranked::new(&images, iou))
        };
        let of_label = |label: &usize| ranked(before, *label, 0).zip(ranked(after, *label, shift));
        let sides: Vec<(Ranked, Ranked)> = labels.iter().flat_map(of_label).collect();
        let [interval] = statistics::intervals_95(self.photos.len(), |times| [gain(&sides, times)]);
        match interval {
            Some(interval) => Some(interval.low),
            // Every draw gained the same.
            None if self.photos.len() >= statistics::FEWEST_CLUSTERS => Some(gain(&sides, &vec![1; self.photos.len()])),
            None => None,
        }
    }
}

/// Returns the mean difference over the labels that have an object in the resample, and over the thresholds.
fn gain(sides: &[(Ranked, Ranked)], times: &[u32]) -> f64 {
    let ap = |ranked: &Ranked| Some(ApDefinition::Coco101.of_curve(&ranked.curve(|image| times[image])?));
    let gains = sides
        .iter()
        .filter_map(|(before, after)| Some(ap(after)? - ap(before)?));
    let gains: Vec<f64> = gains.collect();
    gains.iter().sum::<f64>() / gains.len().max(1) as f64
}
