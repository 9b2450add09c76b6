//! Result of the advice on a session.

use serde::Serialize;

use super::figures::FigureAdvice;
use super::method::Question;
use scaleproof_core::statistics::Interval;
use scaleproof_pose::scene::Viewpoint;

/// One way of a step, and what it does on the session. The usual way is the program's own.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Choice {
    /// The step that is chosen; `name` is one way of it.
    pub question: Question,
    pub name: String,
    /// Coefficients of the lens model that a smaller camera model keeps; `null` for other ways.
    pub lens_terms: Option<usize>,
    pub is_usual: bool,
    /// Mean time for a photo, measured here on one core.
    pub ms: f64,
    /// Photos that get a pose.
    pub located: usize,
    /// Photos that the usual way locates and this one does not.
    pub lost: usize,
    /// Photos in which a left-out tag could be predicted.
    pub held_out_photos: usize,
    /// Mean held-out error over the photos that both this way and the most accurate one predict; `null` without any.
    pub held_out_deg: Option<f64>,
    /// This way's held-out error minus that of the most accurate one, on the same photos; `null` without any.
    pub worse_by_deg: Option<f64>,
    /// 95 % interval of `worse_by_deg`; `null` with too few photos, and when all resamples agree.
    pub worse_by_95: Option<Interval>,
    /// Angle between the direction and that of the usual way, in the middle photo; `null` without one.
    pub moved_deg: Option<f64>,
    /// Difference of the distance from that of the usual way, in the middle photo; `null` without one.
    pub moved_mm: Option<f64>,
    /// Photos that are in another bin than by the usual way.
    pub other_bin: usize,
    /// Photos whose direction is more than five standard deviations of the usual pose from the usual one.
    pub other_pose: usize,
    /// For numbers of tags: by what share the standard deviation of directions grows against all tags; else `null`.
    pub less_certain_by: Option<f64>,
    pub verdict: Verdict,
    /// Of each photo, where it was located.
    #[serde(skip)]
    pub viewpoints: Vec<Option<Viewpoint>>,
}

/// Verdict on a way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The smallest of the ways that nothing speaks against.
    Advised,
    /// Nothing speaks against it, but a smaller way is enough.
    Enough,
    /// It does not locate every photo that the usual way locates.
    LosesPhotos,
    /// It moves photos into other bins.
    OtherBins,
    /// It moves some photo's direction by more than five standard deviations of the usual pose.
    OtherPoses,
    /// Its held-out error is larger than that of the most accurate, at the level of 5 %.
    Worse,
    /// Its held-out error is larger by more than a twentieth, but that is not shown.
    Larger,
    /// Its poses are less certain by more than a twentieth, which is too little for left-out tags to show.
    LessCertain,
    /// The photos are too few to tell.
    CannotTell,
}

/// Everything that is advised about a session.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Advice {
    /// Name of its folder.
    pub session: String,
    /// Photos that could not be read, which nothing here is of.
    pub unreadable: usize,
    pub poses: PoseAdvice,
    /// Advice on figures, by detectors; `null` where none looked.
    pub figures: Option<FigureAdvice>,
}

/// Advice on the ways to locate the photos of a session.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PoseAdvice {
    /// Photos that could be read.
    pub photos: usize,
    /// Photos that the usual way locates.
    pub located: usize,
    /// Photos in which a left-out tag can be predicted by the usual way.
    pub held_out_photos: usize,
    /// Photos whose tags disagree with scene and camera: refused therefore, or fitted poorly.
    pub disagreeing: usize,
    /// Check of the camera file against these photos; `null` where they cannot tell.
    pub camera_check: Option<CameraCheck>,
    /// Ways to locate photos, step by step; empty where the session cannot tell.
    pub choices: Vec<Choice>,
    /// Reason why there is no answer, and what photo or print would give one; `null` where there is one.
    pub abstention: Option<String>,
}

/// The camera file against cameras that are refitted to the tags of one half of the photos and judged on the other.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CameraCheck {
    /// Photos that both predict a left-out tag in.
    pub photos: usize,
    /// Held-out error by the file; `refitted_deg` is that by the camera refitted to the other half.
    pub held_out_deg: f64,
    pub refitted_deg: f64,
    /// Held-out error by the file minus that by the refitted cameras, on the same photos.
    pub better_by_deg: f64,
    /// 95 % interval of `better_by_deg`; `null` when all resamples agree.
    pub better_by_95: Option<Interval>,
    /// fx of the file, and of the two halves, px.
    pub focal_px: f64,
    pub refitted_focal_px: [f64; 2],
    /// Distances of the halves' image centres from that of the file, px.
    pub centre_moved_px: [f64; 2],
    /// First coefficient of the lens model, of the file; `refitted_k1` has those of the two halves.
    pub k1: f64,
    pub refitted_k1: [f64; 2],
    /// Change of the direction (`moved_deg`) and of the distance (`moved_mm`) with the refitted camera, middle photo.
    pub moved_deg: f64,
    pub moved_mm: f64,
    pub verdict: CameraVerdict,
}

/// Verdict of the photos on the camera file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CameraVerdict {
    /// The refitted camera is not shown better, or by no more than a twentieth.
    Fits,
    /// The refitted camera is shown better, by more than a twentieth.
    OtherCamera,
    /// No camera is shown better, but tags disagree in a quarter of the photos or more, and fit four times worse there.
    NoCameraFits,
}

impl PoseAdvice {
    pub fn choices_for(&self, question: Question) -> impl Iterator<Item = &Choice> {
        self.choices.iter().filter(move |choice| choice.question == question)
    }

    /// Returns the choice that is advised; `None` where the session cannot tell.
    pub fn advised(&self, question: Question) -> Option<&Choice> {
        self.choices_for(question)
            .find(|choice| choice.verdict == Verdict::Advised)
    }
}
