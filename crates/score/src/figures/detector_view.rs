//! A detector's side of the photos of a run: its outcomes, and its boxes as average precision takes them.

use crate::evaluated::EvaluatedDetector;
use crate::figures::{MATCH_IOU, PhotoOutcome, ScoredPhoto};
use scaleproof_core::ap::{ApDefinition, ImageBoxes, Ranked};

/// A detector of a run: its index, and its labels that count as the model.
#[derive(Clone, Copy)]
pub(crate) struct DetectorView<'a> {
    pub detector: usize,
    pub counted: &'a [usize],
}

impl<'a> DetectorView<'a> {
    pub(crate) fn each(
        detectors: &'a [EvaluatedDetector],
    ) -> impl Iterator<Item = (DetectorView<'a>, &'a EvaluatedDetector)> {
        let side = |(detector, evaluated): (usize, &'a EvaluatedDetector)| {
            let counted = &evaluated.counted;
            (DetectorView { detector, counted }, evaluated)
        };
        detectors.iter().enumerate().map(side)
    }

    /// Returns the detector of that name.
    pub(crate) fn named(detectors: &'a [EvaluatedDetector], name: &str) -> Option<DetectorView<'a>> {
        let mut all = DetectorView::each(detectors);
        all.find(|(_, d)| d.manifest.name == name).map(|(side, _)| side)
    }

    pub(crate) fn outcome(self, photo: &ScoredPhoto) -> &PhotoOutcome {
        &photo.outcomes[self.detector]
    }

    /// Returns 1 for a hit, 0 for a miss.
    pub(crate) fn hit(self, photo: &ScoredPhoto) -> f64 {
        f64::from(u8::from(self.outcome(photo).is_hit()))
    }

    /// Returns the boxes of the model's class in one photo.
    pub(crate) fn boxes(self, photo: &ScoredPhoto) -> ImageBoxes {
        let found = photo.detections[self.detector].iter();
        let counted = found.filter(|d| self.counted.contains(&d.label));
        ImageBoxes {
            truths: vec![photo.truth],
            detections: counted.map(|d| (d.score, d.box_px)).collect(),
            ..ImageBoxes::default()
        }
    }

    /// Returns the boxes of the model's class in some photos.
    pub(crate) fn images<'p>(self, photos: impl IntoIterator<Item = &'p ScoredPhoto>) -> Vec<ImageBoxes> {
        photos.into_iter().map(|photo| self.boxes(photo)).collect()
    }

    /// Returns the ranking behind the AP of some photos, each with its cluster.
    pub(crate) fn clustered<'p>(self, photos: impl Iterator<Item = (&'p ScoredPhoto, usize)>) -> ClusteredAp {
        let (images, cluster_of): (Vec<_>, Vec<_>) =
            photos.map(|(photo, cluster)| (self.boxes(photo), cluster)).unzip();
        ClusteredAp {
            ranked: Ranked::new(&images, MATCH_IOU),
            cluster_of,
        }
    }
}

/// AP at IoU 0.5 of photos whose clusters are drawn.
pub(crate) struct ClusteredAp {
    ranked: Ranked,
    /// The cluster of each photo.
    cluster_of: Vec<usize>,
}

impl ClusteredAp {
    /// Computes AP when each cluster counts as often as `drawn` says. Every photo has its truth, so that every draw has a curve.
    pub(crate) fn of_draw(&self, drawn: &[u32], definition: ApDefinition) -> f64 {
        let curve = self.ranked.curve(|image| drawn[self.cluster_of[image]]);
        curve.map_or(0.0, |curve| definition.of_curve(&curve))
    }
}
