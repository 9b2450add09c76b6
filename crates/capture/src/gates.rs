//! Gates that a frame must pass before it is taken: located, on target, sharp, well exposed, steady.

use image::GrayImage;
use serde::{Deserialize, Serialize};

use super::advice::Advice;
use super::guidance::Guidance;
use super::steady::{SteadyRun, Taking};
use scaleproof_core::geometry::{Rigid, distance, extent};
use scaleproof_core::statistics::upper_median;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Abstention, Located, LocatedPhoto, locate_luma};
use scaleproof_pose::scene::{Scene, Tag};
use scaleproof_pose::tags::{
    Appearance, HOPELESS_BLUR_PX, SeenTag, StartError, TagDetector, TagDetectorChoice, limit_scale, sharpest_edges_px,
};

/// Standard deviation of blur, px in an image 1280 px long, above which a photo is not sharp; in a larger one as many times more, since
/// detectors see it reduced. Table in `docs/lessons/capture.md`.
pub const MAX_BLUR_PX: f64 = 1.5;

/// Paper darker or lighter than this, of 255, is under- or overexposed: white paper is the lightest thing that must still have a tone.
pub const MIN_WHITE: f64 = 80.0;
pub const MAX_WHITE: f64 = 250.0;

/// Share of the image's part with the model that may have lost its tone to white.
pub const MAX_CLIPPED: f64 = 0.1;
const CLIPPED: u8 = 254;

/// Largest motion of tags from frame to frame, px in an image 1280 px long.
pub const MAX_MOVED_PX: f64 = 2.0;

/// Maximum number of frames in a row in which tags are searched near the last pose only.
const MOST_TRACKED: u32 = 10;

/// Interval of frames that are searched by every means while the fast search finds no pose: searching each so would keep somebody who points the
/// camera elsewhere waiting.
const UNANSWERED: u32 = 4;

/// Without any tag, an image of this mean grey level or less is dark, of that or more bright.
const DARK_MEAN: f64 = 25.0;
const BRIGHT_MEAN: f64 = 230.0;

/// Measurements of a frame, as stored in its sidecar.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Measures {
    /// Standard deviation of the blur on the tags' borders; `null` when none could be fitted.
    pub blur_px: Option<f64>,
    /// Level of the tags' white paper, 0 to 255; `null` where it could not be measured.
    pub white_level: Option<f64>,
    /// Share of the pixels about the model that lost their tone to white; `null` where it could not be measured.
    pub clipped_share: Option<f64>,
    /// Median distance that the tags' corners moved since the last frame, of what a browser films within 50 ms; `null` for photos taken one by one.
    pub moved_px: Option<f64>,
}

/// Findings in a frame, and the verdict on it.
#[derive(Debug, Clone)]
pub struct FrameJudgement {
    pub seen: Vec<SeenTag>,
    pub located: Option<Located>,
    pub measures: Measures,
    /// Cautions about the pose, as sentences.
    pub cautions: Vec<String>,
    /// Target at which the frame was taken, whatever its light, focus and steadiness, or the advice that leads to one.
    pub place: Result<usize, Advice>,
    /// Target that the frame may fill, or the advice on the first gate that it fails.
    pub verdict: Result<usize, Advice>,
}

/// Judges frames. Holds a tag detector, so each thread needs its own.
pub struct Judge {
    tags: Box<dyn TagDetector>,
    /// A faster search for the frames of a stream. Its result becomes advice; what is taken was found by `tags`.
    live: Option<Box<dyn TagDetector>>,
    scene: Scene,
    is_stream: bool,
    /// Tags of the frame that was judged last, and of the one before it.
    last: Vec<SeenTag>,
    before: Vec<SeenTag>,
    /// Width of the frame that was judged last, px: of a film, small frames come before one that is kept.
    last_width: u32,
    /// Time since the last frame, in intervals of 50 ms; 1 unless set by [`Judge::filmed_after`].
    intervals: f64,
    /// Pose of the frame before, and the number of frames tracked since the last whole search.
    pose: Option<Rigid>,
    tracked: u32,
    /// Frames of a stream without a pose since the last one that had one.
    unanswered: u32,
}

impl Judge {
    /// Creates a judge; `is_stream` as of [`super::FrameSource::is_stream`].
    ///
    /// # Errors
    /// The tag detector does not start.
    pub fn new(scene: &Scene, detector: TagDetectorChoice, is_stream: bool) -> Result<Judge, StartError> {
        let families = scene.families();
        Ok(Judge {
            tags: detector.open(&families)?,
            live: if is_stream {
                detector.open_live(&families)?
            } else {
                None
            },
            scene: scene.clone(),
            is_stream,
            last: Vec::new(),
            before: Vec::new(),
            last_width: 0,
            intervals: 1.0,
            pose: None,
            tracked: 0,
            unanswered: 0,
        })
    }

    /// Sets the time between the last frame and the next, ms. The limit of motion is one for a running camera, whose frames come every 50 ms;
    /// after five times that the distance no longer tells the speed.
    pub fn filmed_after(&mut self, ms: u32) {
        self.intervals = (f64::from(ms) / 50.0).clamp(1.0, 5.0);
    }

    /// Returns true if the frames are those of a stream.
    pub fn is_stream(&self) -> bool {
        self.is_stream
    }

    /// Judges upright luma, which EXIF turned by `turned_deg`; `camera` is the camera file's.
    ///
    /// A photo that somebody took on purpose gets first the advice about what would spoil it anywhere. Somebody who walks with a running
    /// camera gets the way first, as walking blurs.
    pub fn judge(&mut self, luma: &GrayImage, turned_deg: u32, camera: &Camera, guidance: &Guidance) -> FrameJudgement {
        if !self.is_stream {
            let photo = locate_luma(luma, turned_deg, None, &self.scene, camera, self.tags.as_mut());
            return self.weigh(photo, luma, guidance);
        }
        self.before = std::mem::take(&mut self.last);
        let scale = f64::from(luma.width()) / f64::from(self.last_width.max(1));
        self.last_width = luma.width();
        for corner in self
            .before
            .iter_mut()
            .flat_map(|tag| tag.corners_px.iter_mut().flatten())
        {
            *corner = (*corner + 0.5) * scale - 0.5;
        }
        let scene = &self.scene;
        let live = self.live.as_mut();
        let at_once = live.map(|live| {
            let pose = self.pose.as_ref().filter(|_| self.tracked < MOST_TRACKED);
            locate_luma(luma, turned_deg, pose, scene, camera, live.as_mut())
        });
        let is_answered = at_once.as_ref().is_some_and(|photo| photo.result.is_ok());
        self.unanswered = if is_answered { 0 } else { self.unanswered + 1 };
        let photo = at_once
            .filter(|_| is_answered || !self.unanswered.is_multiple_of(UNANSWERED))
            .unwrap_or_else(|| locate_luma(luma, turned_deg, None, scene, camera, self.tags.as_mut()));
        let judgement = self.weigh(photo, luma, guidance);
        self.pose = judgement.located.as_ref().map(|located| located.pose);
        self.tracked = (self.tracked + 1) % (MOST_TRACKED + 1);
        self.last.clone_from(&judgement.seen);
        judgement
    }

    /// Judges a frame, and decides if it is taken: of a stream, when all gates have held for a moment, and still do by the tag detector whose
    /// poses are kept.
    pub(crate) fn decide(
        &mut self,
        luma: &GrayImage,
        turned_deg: u32,
        camera: &Camera,
        guidance: &Guidance,
        taking: Taking,
        run: &mut SteadyRun,
    ) -> FrameJudgement {
        let mut judgement = self.judge(luma, turned_deg, camera, guidance);
        let is_by_hand = taking == Taking::ByHand;
        if !self.is_stream {
            run.end();
        } else if let (Err(advice), false) = (run.add(&judgement.verdict, taking), is_by_hand) {
            judgement.verdict = Err(advice);
            return judgement;
        } else if self.live.is_some() {
            let photo = locate_luma(luma, turned_deg, None, &self.scene, camera, self.tags.as_mut());
            judgement = self.weigh(photo, luma, guidance);
        }
        if is_by_hand {
            judgement.verdict = judgement.place.clone();
        }
        judgement
    }

    /// Measures a located frame and judges it by the gates.
    fn weigh(&self, photo: LocatedPhoto, grey: &GrayImage, guidance: &Guidance) -> FrameJudgement {
        let (seen, located) = (photo.seen, photo.result);
        let fitted = match photo.fitted {
            Ok(fitted) => fitted,
            // The camera file does not fit the frame.
            Err(e) => {
                let advice = Advice::NotLocated(Abstention::from(e));
                return FrameJudgement {
                    seen,
                    located: None,
                    measures: Measures::default(),
                    cautions: Vec::new(),
                    place: Err(advice.clone()),
                    verdict: Err(advice),
                };
            }
        };
        let appearance = Appearance::measure(grey, &seen);
        let pose = located.as_ref().ok().map(|l| &l.pose);
        let measures = Measures {
            blur_px: appearance.blur_px.filter(|px| px.is_finite()),
            white_level: appearance.white_level,
            clipped_share: pose.and_then(|pose| clipped_share(grey, &self.scene, pose, &fitted.camera)),
            moved_px: moved_px(&self.before, &seen)
                .filter(|_| self.is_stream)
                .map(|px| px / self.intervals),
        };
        let light = light(&measures, &seen, grey);
        let focus = focus(&appearance, &seen, grey);
        let model = measures.clipped_share.is_none().then_some(Advice::NoModel);
        let (place, first_fault) = match &located {
            Err(abstention) => {
                // Why there is no pose tells more than that the focus is unknown.
                let spoiled = light.or(focus.filter(|advice| *advice != Advice::Unmeasured));
                let advice = spoiled.unwrap_or_else(|| self.not_located(abstention.clone(), &seen));
                (Err(advice), None)
            }
            Ok(located) => {
                let place = place(located, guidance);
                let still = unsteady(&measures, grey);
                let way = place.clone().err();
                let order = if self.is_stream {
                    [model, light, way, focus, still]
                } else {
                    [model, light, focus, way, None]
                };
                (place, order.into_iter().flatten().next())
            }
        };
        FrameJudgement {
            seen,
            located: located.ok(),
            measures,
            cautions: fitted.cautions(),
            verdict: first_fault.map_or_else(|| place.clone(), Err),
            place,
        }
    }

    fn not_located(&self, abstention: Abstention, seen: &[SeenTag]) -> Advice {
        use Abstention::{Blurred, NoTags, OneTagAmbiguous, OneTagCovered, OneTagFrontal};
        match (&abstention, seen) {
            (NoTags, _) => Advice::NoTags,
            (&Blurred { blur_px }, _) => Advice::Blurred { blur_px: Some(blur_px) },
            (&(OneTagCovered { id } | OneTagFrontal { id, .. } | OneTagAmbiguous { id, .. }), [only]) => {
                let tag = self.scene.tag(only.family, id);
                let beside = tag.and_then(|tag| beside(tag, &self.scene)).map(|tag| tag.id);
                Advice::OneTag { id, beside }
            }
            _ => Advice::NotLocated(abstention),
        }
    }
}

fn unsteady(measures: &Measures, grey: &GrayImage) -> Option<Advice> {
    // The first frame of a stream has none to be compared with.
    let moves = measures.moved_px.is_none_or(|px| px > MAX_MOVED_PX * enlarged(grey));
    moves.then_some(Advice::Moving)
}

fn enlarged(grey: &GrayImage) -> f64 {
    limit_scale([grey.width(), grey.height()])
}

/// Returns the target that a viewpoint fills, or the step to one.
fn place(located: &Located, guidance: &Guidance) -> Result<usize, Advice> {
    let from = &located.viewpoint;
    let next = guidance.nearest_open(from).map(|i| (i, guidance.step(i, from)));
    match next {
        Some((target, None)) => Ok(target),
        Some((_, Some(step))) if guidance.filled_at(from).is_none() => Err(Advice::Walk(step)),
        next => Err(Advice::Filled {
            then: next.and_then(|(_, step)| step),
        }),
    }
}

/// Returns advice on a frame that is too dark or too bright.
fn light(measures: &Measures, seen: &[SeenTag], grey: &GrayImage) -> Option<Advice> {
    let (is_dark, is_bright) = match measures.white_level {
        Some(white) => (white < MIN_WHITE, white > MAX_WHITE),
        None if seen.is_empty() => {
            let mean = grey.as_raw().iter().map(|v| f64::from(*v)).sum::<f64>() / grey.as_raw().len().max(1) as f64;
            (mean <= DARK_MEAN, mean >= BRIGHT_MEAN)
        }
        None => (false, false),
    };
    let is_clipped = measures.clipped_share.is_some_and(|share| share > MAX_CLIPPED);
    let too_bright = (is_bright || is_clipped).then_some(Advice::TooBright);
    is_dark.then_some(Advice::TooDark).or(too_bright)
}

/// Returns advice on a frame that is blurred, or whose blur cannot be measured.
fn focus(appearance: &Appearance, seen: &[SeenTag], grey: &GrayImage) -> Option<Advice> {
    let enlarged = enlarged(grey);
    // Blur beyond what a tag's border can take hides the tags, or leaves them looking covered.
    if !seen.iter().any(|tag| tag.is_whole) {
        let [across, along] = sharpest_edges_px(grey);
        let is_hopeless = across
            .zip(along)
            .is_some_and(|(a, b)| a.min(b) > HOPELESS_BLUR_PX * enlarged);
        return Some(if is_hopeless {
            Advice::Blurred { blur_px: None }
        } else {
            Advice::Unmeasured
        });
    }
    match appearance.blur_px {
        Some(px) if px <= MAX_BLUR_PX * enlarged => None,
        Some(px) => Some(Advice::Blurred { blur_px: Some(px) }),
        None => Some(Advice::TooSmall),
    }
}

/// Returns the share of white pixels in the upright rectangle about the model's box; `None` when it lies outside the image.
fn clipped_share(grey: &GrayImage, scene: &Scene, pose: &Rigid, camera: &Camera) -> Option<f64> {
    let corners = scene.model.box_corners_mm().into_iter();
    let corners: Vec<[f64; 2]> = corners.filter_map(|corner| camera.project(&(pose * corner))).collect();
    let range = |axis: usize, size: u32| {
        let (low, high) = extent(corners.iter().map(|c| c[axis]));
        low.clamp(0.0, f64::from(size)) as u32..high.clamp(0.0, f64::from(size)) as u32
    };
    let (columns, rows) = (range(0, grey.width()), range(1, grey.height()));
    let pixels = columns.len() as u64 * rows.len() as u64;
    let is_clipped = |x: &u32, y: u32| grey.get_pixel(*x, y).0[0] >= CLIPPED;
    let clipped: usize = rows.map(|y| columns.clone().filter(|x| is_clipped(x, y)).count()).sum();
    (pixels > 0).then(|| clipped as f64 / pixels as f64)
}

/// Returns the median distance that the corners of tags moved between two frames, px; `None` without a tag in both.
fn moved_px(last: &[SeenTag], seen: &[SeenTag]) -> Option<f64> {
    let pairs = seen.iter().filter_map(|tag| {
        let before = last.iter().find(|l| (l.family, l.id) == (tag.family, tag.id))?;
        Some(tag.corners_px.iter().zip(&before.corners_px))
    });
    let ways: Vec<f64> = pairs.flatten().map(|(a, b)| distance(*a, *b)).collect();
    upper_median(&ways)
}

/// Returns the nearest other tag that faces a similar direction.
fn beside<'a>(tag: &Tag, scene: &'a Scene) -> Option<&'a Tag> {
    let normal = |tag: &Tag| tag.right.cross(&tag.up);
    let is_other = |other: &&Tag| (other.family, other.id) != (tag.family, tag.id);
    let others = (scene.tags.iter()).filter(|other| is_other(other) && normal(other).dot(&normal(tag)) > 0.0);
    let away = |other: &Tag| (other.centre_mm - tag.centre_mm).norm();
    others.min_by(|a, b| away(a).total_cmp(&away(b)))
}
