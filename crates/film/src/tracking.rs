//! Fast pose tracking through the frames of a video, most of which are never kept.
//!
//! Tags are searched where the pose of the frame before puts them; every 25 frames, and when that fails, in the whole image, reduced. Frames that are
//! kept are located again by the search that photos get (`keep.rs`).

use scaleproof_core::geometry::Rigid;
use scaleproof_photo::Luma;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Abstention, Sigma, locate_luma};
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_pose::tags::{StartError, TagDetector, TagDetectorChoice, edge_blurs, worst_blur_px};
use scaleproof_video::{Frame, Picture};

/// Frames of which the first is searched as a whole and the others are tracked: nothing that tracking believes lasts longer.
const GROUP: usize = 25;
/// Interval of frames that are searched by every means while none has a pose.
const SEARCHED_WELL: u32 = 12;

/// A frame whose luma differs from the last one's by less than this on average, levels, shows the same picture. Encoded again, pictures that are repeated
/// differ by 0.004 to 0.5 in four codecs; those of the filmed walks by 2 and more.
const ALIKE_LEVELS: f64 = 0.6;
/// A picture is repeated for no longer than this, s: a camera that is held still gives frames that are as alike.
const REPEATED_S: f64 = 0.12;
/// Least length of the long side to which frames are reduced for tracking, px; kept frames are located at full size.
const LOOKED_AT_PX: u32 = 1920;

/// Result of tracking one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameResult {
    /// Its number in the video, from 0.
    pub number: u64,
    /// Time at which it is shown, s since the start of the video.
    pub time_s: f64,
    /// Number of the frame from which on it can be decoded.
    pub key: u64,
    /// Its pose and sharpness; `Err` where there is no pose.
    pub shows: Result<View, NoPose>,
}

/// Findings in a frame with a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    pub viewpoint: Viewpoint,
    /// Share of the camera's motion in σ of the viewpoint, set by [`crate::motion::set_motion`]; `None` until then, and where the frames before or after have no pose.
    pub moved: Option<Sigma>,
    /// Standard deviation of the blur in its worst direction, px; `None` where no whole tag is large enough to tell.
    pub blur_px: Option<f64>,
    /// True if the model's whole box lies in the image.
    pub is_model_whole: bool,
    /// Probability that the viewpoint's bin is the right one, 0 to 1.
    pub bin_probability: f64,
}

/// Reason why a frame has no pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoPose {
    NoTags,
    Blurred,
    Unsure,
    /// The picture of the frame before once more: its pose would say that the camera stood still.
    Repeated,
}

/// Tracks the camera through the frames of one video, in their order. Has its own tag detectors.
pub struct FrameTracker<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    turned_deg: u32,
    fast: Box<dyn TagDetector>,
    thorough: Box<dyn TagDetector>,
    /// Poses of the last two frames, the older first.
    poses: [Option<Rigid>; 2],
    looked: usize,
    lost: u32,
    /// The last frame that was not repeated, with its time, s.
    last: Option<(f64, Picture)>,
}

impl<'a> FrameTracker<'a> {
    /// Creates a tracker; `turned_deg` is the clockwise turn that the container gives the sensor's image.
    ///
    /// # Errors
    /// The tag detector does not start.
    pub fn new(
        scene: &'a Scene,
        camera: &'a Camera,
        turned_deg: u32,
        detector: TagDetectorChoice,
    ) -> Result<FrameTracker<'a>, StartError> {
        let families = scene.families();
        let fast = match detector.open_live(&families)? {
            Some(fast) => fast,
            None => detector.open(&families)?,
        };
        Ok(FrameTracker {
            scene,
            camera,
            turned_deg,
            fast,
            thorough: detector.open(&families)?,
            poses: [None, None],
            looked: 0,
            lost: 0,
            last: None,
        })
    }

    /// Locates the camera in the next frame.
    pub fn track(&mut self, frame: Frame<Picture>) -> FrameResult {
        if self.looked.is_multiple_of(GROUP) {
            (self.poses, self.lost) = ([None, None], 0);
        }
        self.looked += 1;
        let is_repeated =
            |(time_s, last): &(f64, Picture)| frame.time_s - time_s < REPEATED_S && is_alike(last, &frame.image);
        let is_repeated = self.last.as_ref().is_some_and(is_repeated);
        let look = FrameResult {
            number: frame.number,
            time_s: frame.time_s,
            key: frame.key,
            shows: match is_repeated {
                true => Err(NoPose::Repeated),
                false => self.view(&frame),
            },
        };
        if !is_repeated {
            self.last = Some((frame.time_s, frame.image));
        }
        look
    }

    fn view(&mut self, frame: &Frame<Picture>) -> Result<View, NoPose> {
        let factor = reduction(frame.image.size());
        let reduced = (factor > 1).then(|| frame.image.reduced(factor));
        let luma: &dyn Luma = match &reduced {
            Some(reduced) => reduced.as_ref(),
            None => &frame.image,
        };
        let guess = self.guess();
        let mut photo = self.located(luma, guess.as_ref(), false);
        if guess.is_some() && photo.result.is_err() {
            photo = self.located(luma, None, false);
        }
        if photo.result.is_err() {
            if self.lost.is_multiple_of(SEARCHED_WELL) {
                photo = self.located(luma, None, true);
            }
            self.lost += 1;
        }
        let pose = photo.result.as_ref().ok().map(|located| located.pose);
        self.poses = [self.poses[1], pose];
        if pose.is_some() {
            self.lost = 0;
        }
        match (&photo.result, &photo.fitted) {
            (Ok(located), Ok(fitted)) => {
                let blur_px = worst_blur_px(&edge_blurs(luma, &photo.seen)).filter(|px| px.is_finite());
                Ok(View {
                    viewpoint: located.viewpoint,
                    moved: None,
                    blur_px: blur_px.map(|px| px * f64::from(factor)),
                    is_model_whole: self.is_model_whole(&located.pose, &fitted.camera),
                    bin_probability: located.bin_probability,
                })
            }
            (Err(why), _) => Err(NoPose::of(why)),
            (_, Err(_)) => Err(NoPose::Unsure),
        }
    }

    fn located(
        &mut self,
        luma: &dyn Luma,
        guess: Option<&Rigid>,
        is_thorough: bool,
    ) -> scaleproof_pose::locate::LocatedPhoto {
        let tags = if is_thorough {
            &mut self.thorough
        } else {
            &mut self.fast
        };
        locate_luma(luma, self.turned_deg, guess, self.scene, self.camera, tags.as_mut())
    }

    /// Extrapolates the camera's pose at constant velocity.
    fn guess(&self) -> Option<Rigid> {
        match self.poses {
            [Some(before), Some(last)] => Some(last * before.inverse() * last),
            [None, last] => last,
            [Some(_), None] => None,
        }
    }

    fn is_model_whole(&self, pose: &Rigid, camera: &Camera) -> bool {
        let is_inside = |[x, y]: [f64; 2]| {
            (0.0..=f64::from(camera.width) - 1.0).contains(&x) && (0.0..=f64::from(camera.height) - 1.0).contains(&y)
        };
        let corners = self.scene.model.box_corners_mm();
        corners
            .iter()
            .all(|corner| camera.project(&(pose * corner)).is_some_and(is_inside))
    }
}

/// Returns true if two frames show one picture.
fn is_alike(one: &Picture, other: &Picture) -> bool {
    one.difference(other).is_some_and(|levels| levels < ALIKE_LEVELS)
}

/// Returns the factor by which frames of a size are reduced, a divisor of both sides.
fn reduction(size: [u32; 2]) -> u32 {
    let most = size[0].max(size[1]) / LOOKED_AT_PX;
    let is_whole = |factor: &u32| size.iter().all(|side| side.is_multiple_of(*factor));
    (1..=most).rev().find(is_whole).unwrap_or(1)
}

impl NoPose {
    fn of(why: &Abstention) -> NoPose {
        match why {
            Abstention::NoTags => NoPose::NoTags,
            Abstention::Blurred { .. } => NoPose::Blurred,
            _ => NoPose::Unsure,
        }
    }
}
