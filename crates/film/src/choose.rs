//! Choice of the frames that become photos. Plain numbers in, frames out.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::tracking::{FrameResult, NoPose, View};
use scaleproof_capture::{MAX_BLUR_PX, Tolerance};
use scaleproof_core::geometry::angle::turn;
use scaleproof_pose::scene::{Bin, Bins, Viewpoint};

/// A frame blurred by more than this, px (standard deviation), is not sharp.
const SHARP_PX: f64 = MAX_BLUR_PX;
/// Bounds of "nearby", in azimuth and in pitch.
const NEARBY_DEG: f64 = 5.0;
/// Frames whose blurs differ by less, as a share of the largest sharp blur, are equally sharp: among them the one in which the camera moves least is the best.
const ALIKE: f64 = 0.2;
/// Least probability of a bin that is relied on.
const SURE_BIN: f64 = 0.95;
/// Largest angle between the camera directions of a pair, seen from the model.
const MOST_APART_DEG: f64 = 5.0;

/// Reason why a frame was not fit to be chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Refusal {
    /// No tag was found.
    NoTags,
    /// Tags were found, and no pose that is beyond doubt.
    Unsure,
    /// The picture of the frame before once more, as films of fewer pictures than frames have it.
    Repeated,
    /// Part of the model's box is outside the image.
    ModelCut,
    /// Blurred beyond the limit, or too blurred to be located.
    Blurred,
    /// No whole tag is large enough to tell how sharp it is.
    BlurUnknown,
    /// The frame before or after has no pose, so that the camera's motion is not known.
    MotionUnknown,
    /// Too high or too low for the scene's bins.
    Pitch,
    /// Too near or too far for the scene's bins.
    Distance,
    /// So near to the edge of its bin that it may be in the next.
    BinEdge,
}

impl Refusal {
    /// All, in the order in which a frame is checked.
    pub const ALL: [Refusal; 10] = [
        Refusal::NoTags,
        Refusal::Unsure,
        Refusal::ModelCut,
        Refusal::Blurred,
        Refusal::BlurUnknown,
        Refusal::MotionUnknown,
        Refusal::Pitch,
        Refusal::Distance,
        Refusal::BinEdge,
        Refusal::Repeated,
    ];

    /// Returns the reason in words.
    pub fn name(self) -> &'static str {
        match self {
            Refusal::NoTags => "no tags",
            Refusal::Unsure => "no sure pose",
            Refusal::Repeated => "repeated",
            Refusal::ModelCut => "model cut off",
            Refusal::Blurred => "blurred",
            Refusal::BlurUnknown => "sharpness unknown",
            Refusal::MotionUnknown => "motion unknown",
            Refusal::Pitch => "wrong height",
            Refusal::Distance => "wrong distance",
            Refusal::BinEdge => "between two bins",
        }
    }
}

/// Criteria by which frames are chosen.
#[derive(Debug, Clone)]
pub struct SelectionCriteria<'a> {
    pub bins: &'a Bins,
    /// Largest blur, px (standard deviation).
    pub most_blur_px: f64,
    /// Frames of each bin.
    pub per_bin: usize,
    /// Least time between two frames of one bin, s.
    pub apart_s: f64,
}

/// Chosen frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// Index among the tracked frames.
    pub at: usize,
    pub bin: Bin,
    /// Index of the target viewpoint it was chosen for, and its angle to that, deg.
    pub pair: Option<(usize, f64)>,
}

impl SelectionCriteria<'_> {
    /// Returns the reason why a frame is not chosen.
    pub fn refusal(&self, look: &FrameResult) -> Option<Refusal> {
        let view = match &look.shows {
            Err(NoPose::NoTags) => return Some(Refusal::NoTags),
            Err(NoPose::Blurred) => return Some(Refusal::Blurred),
            Err(NoPose::Unsure) => return Some(Refusal::Unsure),
            Err(NoPose::Repeated) => return Some(Refusal::Repeated),
            Ok(view) => view,
        };
        let (v, bin) = (&view.viewpoint, self.bins.bin_of(&view.viewpoint));
        let tolerance = Tolerance::of_bins(self.bins, &self.bins.distance_mm);
        let checks = [
            (!view.is_model_whole, Refusal::ModelCut),
            (view.blur_px.is_some_and(|px| px > self.most_blur_px), Refusal::Blurred),
            (view.blur_px.is_none(), Refusal::BlurUnknown),
            (view.moved.is_none(), Refusal::MotionUnknown),
            (
                (v.pitch_deg - bin.pitch_deg).abs() > tolerance.pitch_deg,
                Refusal::Pitch,
            ),
            (
                (v.distance_mm - bin.distance_mm).abs() > tolerance.distance_mm,
                Refusal::Distance,
            ),
            (view.bin_probability < SURE_BIN, Refusal::BinEdge),
        ];
        checks.into_iter().find(|(is_so, _)| *is_so).map(|(_, refusal)| refusal)
    }

    /// Returns the frames that may be chosen: of those that are not sharp, those without a sharper one nearby.
    fn fit<'a>(&self, looks: &'a [FrameResult]) -> Vec<Fit<'a>> {
        let fit = looks
            .iter()
            .enumerate()
            .filter(|(_, look)| self.refusal(look).is_none());
        let fit = fit.filter_map(|(at, look)| {
            let view = look.shows.as_ref().ok()?;
            Some(Fit {
                at,
                time_s: look.time_s,
                view,
                relative_blur: view.blur_px? / SHARP_PX,
                moved_deg: view.moved?.azimuth_deg,
                bin: self.bins.bin_of(&view.viewpoint),
            })
        });
        let all: Vec<Fit> = fit.collect();
        let is_blurred_beside = |one: &Fit| {
            let beats = |other: &Fit| other.relative_blur < one.relative_blur && other.is_nearby(one);
            !one.is_sharp() && all.iter().any(beats)
        };
        all.iter().filter(|one| !is_blurred_beside(one)).copied().collect()
    }

    /// Chooses the sharpest frames of each bin, apart in time; among equally sharp ones those in which the camera moves least. A frame that is not
    /// sharp is chosen only if the bin has no better one.
    pub fn best(&self, looks: &[FrameResult]) -> Vec<Chosen> {
        let mut bins: BTreeMap<Bin, Vec<Fit>> = BTreeMap::new();
        for fit in self.fit(looks) {
            bins.entry(fit.bin).or_default().push(fit);
        }
        let mut chosen = Vec::new();
        for (bin, mut fits) in bins {
            fits.sort_by(|a, b| {
                let order = |fit: &Fit| ((fit.relative_blur / ALIKE).floor() as i64, fit.moved_deg);
                let (a, b) = (order(a), order(b));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
            });
            let sharp = fits.iter().filter(|fit| fit.is_sharp()).count();
            fits.truncate(sharp.max(1));
            let mut own: Vec<Fit> = Vec::new();
            for fit in fits {
                if own.len() < self.per_bin
                    && own
                        .iter()
                        .all(|other| (other.time_s - fit.time_s).abs() >= self.apart_s)
                {
                    own.push(fit);
                }
            }
            own.sort_by_key(|fit| fit.at);
            let taken = own.iter().map(|fit| Chosen {
                at: fit.at,
                bin,
                pair: None,
            });
            chosen.extend(taken);
        }
        chosen
    }

    /// Chooses for each viewpoint the nearest frame of the same bin; the nearest pairs are joined first, and no frame twice.
    pub fn nearest(&self, looks: &[FrameResult], wanted: &[Viewpoint]) -> Vec<Chosen> {
        let fits = self.fit(looks);
        let mut all = Vec::new();
        for (place, wanted) in wanted.iter().enumerate() {
            let bin = self.bins.bin_of(wanted);
            let same = fits.iter().filter(|fit| fit.bin == bin);
            let near = same.map(|fit| (apart_deg(&fit.view.viewpoint, wanted), fit.at, place, bin));
            all.extend(near.filter(|(apart, ..)| *apart <= MOST_APART_DEG));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut chosen: Vec<Chosen> = Vec::new();
        for (apart, at, place, bin) in all {
            let is_free = |other: &Chosen| other.at != at && other.pair.is_none_or(|(taken, _)| taken != place);
            if chosen.iter().all(is_free) {
                let pair = Some((place, apart));
                chosen.push(Chosen { at, bin, pair });
            }
        }
        chosen.sort_by_key(|one| one.at);
        chosen
    }
}

/// A frame that may be chosen.
#[derive(Debug, Clone, Copy)]
struct Fit<'a> {
    at: usize,
    time_s: f64,
    view: &'a View,
    /// Its blur as a share of the largest that is sharp.
    relative_blur: f64,
    moved_deg: f64,
    bin: Bin,
}

impl Fit<'_> {
    fn is_sharp(&self) -> bool {
        self.relative_blur <= 1.0
    }

    fn is_nearby(&self, other: &Fit) -> bool {
        let (a, b) = (&self.view.viewpoint, &other.view.viewpoint);
        turn(a.azimuth_deg, b.azimuth_deg).abs() <= NEARBY_DEG && (a.pitch_deg - b.pitch_deg).abs() <= NEARBY_DEG
    }
}

/// Returns the distance between two viewpoints: the way between the camera centres as an angle at the farther one's distance, degrees. Other distances count as
/// other directions do.
pub fn apart_deg(a: &Viewpoint, b: &Viewpoint) -> f64 {
    let [one, other] = [a, b].map(|v| v.camera_centre_mm(nalgebra::Point3::origin()));
    let far_mm = a.distance_mm.max(b.distance_mm);
    ((one - other).norm() / far_mm).to_degrees()
}

/// Counts refused frames by reason.
pub fn count_refusals(criteria: &SelectionCriteria, looks: &[FrameResult]) -> BTreeMap<Refusal, usize> {
    let mut counts = BTreeMap::new();
    for refusal in looks.iter().filter_map(|look| criteria.refusal(look)) {
        *counts.entry(refusal).or_default() += 1;
    }
    counts
}
