//! Guided capture: frames in, advice out, and a session that holds one good photo of each required view; and its [`page`] in a browser.
//!
//! A frame goes through `gates` (tags, pose, focus, light, steadiness) and `guidance` (the nearest view still required); what
//! holds is taken at once by `store`, and a refused frame gets one sentence of `advice`. No clock is read: photos are ordered by their
//! numbers.
//!
//! ```
//! use scaleproof_capture::{Guidance, Tolerance};
//! use scaleproof_pose::scene::Bins;
//!
//! // Once round the model at 45° steps.
//! let bins = Bins { azimuth_deg: 45.0, pitch_deg: vec![15.0], distance_mm: vec![900.0] };
//! let views = bins.viewpoints(&bins.pitch_deg, &bins.distance_mm);
//! let guidance = Guidance::at(&views, Tolerance::of_bins(&bins, &bins.distance_mm), &bins);
//! assert_eq!(guidance.targets().len(), 8);
//! assert!(!guidance.is_finished());
//! ```

pub mod page;

mod advice;
mod gates;
mod guidance;
mod guided; // a capture from its request to its end
mod interruptible; // sources that can be given up while they wait
pub mod live;
pub mod pair;
mod programs;
mod recover;
mod replay;
mod source;
mod store;
pub mod stream;
mod watch;

use std::path::Path;

use image::{GrayImage, ImageFormat};
use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_core::files;
use scaleproof_core::geometry::{Rigid, rigid};
use scaleproof_photo as photo;
use scaleproof_photo::{Budget, Photo};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::Located;
use scaleproof_pose::scene::{Bin, Scene, Viewpoint};
use scaleproof_pose::tags::SeenTag;
use scaleproof_session::PhotoEntry;

pub use advice::Advice;
pub use gates::{FrameJudgement, Judge, MAX_BLUR_PX, MAX_CLIPPED, MAX_MOVED_PX, MAX_WHITE, MIN_WHITE, Measures};
pub use guidance::{BinName, Guidance, NextMove, Target, Tolerance};
pub use guided::{
    CaptureEnd, GuidedCapture, GuidedError, GuidedRequest, OpenedCapture, PageRequest, SourceOptions, ViewsRequest,
};
pub use interruptible::OnInterrupt;
pub use live::{CameraSettings, LiveCamera};
pub use programs::interrupt_programs;
pub use replay::Replay;
pub use source::{FrameSource, Original, SourceError, SourceFrame, SourceName};
pub use store::{Sidecar, Store, StoreError, sidecar_of, slug};
pub use watch::Watch;

/// What became of a frame.
#[derive(Debug, Clone)]
pub struct FrameAnswer {
    /// Width and height of the upright frame; zeros when it could not be read.
    pub size_px: [u32; 2],
    pub viewpoint: Option<Viewpoint>,
    /// `T_camera_model`.
    pub pose: Option<Rigid>,
    pub measures: Measures,
    /// The name of the accepted photo and its target's index, or what to do.
    pub verdict: Result<(String, usize), Advice>,
    /// What to know before believing the pose, as sentences.
    pub cautions: Vec<String>,
    /// The tags that were seen, in the upright frame.
    pub tags: Vec<SeenTag>,
}

/// One line of `--json` for a frame.
#[derive(Serialize, JsonSchema)]
pub struct FrameLine<'a> {
    frame: &'a str,
    /// `accepted` or `refused`.
    status: &'static str,
    /// The photo's name in the session.
    photo: Option<&'a str>,
    /// What was taken of the frame, or is required.
    bin: Option<Bin>,
    code: Option<&'static str>,
    advice: Option<String>,
    viewpoint: Option<Viewpoint>,
    gates: Measures,
}

impl FrameAnswer {
    /// The line for programs about the frame of this name.
    pub fn line<'a>(&'a self, frame: &'a str, guidance: &Guidance) -> FrameLine<'a> {
        let (accepted, advice) = (self.verdict.as_ref().ok(), self.verdict.as_ref().err());
        FrameLine {
            frame,
            status: if accepted.is_some() { "accepted" } else { "refused" },
            photo: accepted.map(|(photo, _)| photo.as_str()),
            bin: accepted.map(|(_, target)| guidance.targets()[*target].bin),
            code: advice.map(Advice::code),
            advice: advice.map(Advice::to_string),
            viewpoint: self.viewpoint,
            gates: self.measures,
        }
    }

    /// What became of the frame, in a sentence.
    pub fn sentence(&self, guidance: &Guidance) -> String {
        match &self.verdict {
            Ok((photo, target)) => {
                let (target, (filled, all)) = (&guidance.targets()[*target], guidance.filled_of_all());
                format!("taken as {photo}, {target} ({filled} of {all})")
            }
            Err(advice) => advice.to_string(),
        }
    }
}

/// What is said of a damaged image of a running camera.
const DAMAGED: &str = "the camera sent a damaged image: check its connection";

/// In a stream, so many frames in a row must be fit to be taken at the same target; the last of them is. A fifth of a second at 20 frames a
/// second.
const HELD_FRAMES: u32 = 4;

/// How a frame comes to be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Taking {
    /// When all gates hold.
    ByItself,
    /// Whatever its light, focus and steadiness.
    ByHand,
    /// Not at all: it is a small picture of what a device films.
    Never,
}

/// A capture of one variant at one place.
pub struct Capture {
    guidance: Guidance,
    judge: Judge,
    /// Judges what a browser films, beside the photos of the source.
    film: Option<Judge>,
    store: Store,
    camera: Camera,
    variant: String,
    place: String,
    /// Whether frames of a stream are taken by themselves.
    pub is_auto: bool,
    /// The target that the last frames of a stream were fit for, and how many were.
    held: Option<(usize, u32)>,
    camera_settings: Option<CameraSettings>,
}

impl Capture {
    /// Goes on with a session: its photos of the variant at the place fill the targets they were taken for, or else the nearest within tolerance.
    pub fn new(guidance: Guidance, judge: Judge, store: Store, camera: Camera, variant: &str, place: &str) -> Capture {
        let mut capture = Capture {
            guidance,
            judge,
            film: None,
            store,
            camera,
            variant: variant.to_owned(),
            place: place.to_owned(),
            is_auto: true,
            held: None,
            camera_settings: None,
        };
        capture.fill_from_store();
        capture
    }

    /// With a judge of streams for what a browser films.
    pub fn with_film(self, judge: Judge) -> Capture {
        let film = Some(judge);
        Capture { film, ..self }
    }

    /// The camera file's.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    pub fn guidance(&self) -> &Guidance {
        &self.guidance
    }

    /// Photos of this variant at this place.
    fn own(&self) -> impl DoubleEndedIterator<Item = &Sidecar> {
        let is_own = |photo: &PhotoEntry| photo.variant == self.variant && photo.place.as_ref() == Some(&self.place);
        let accepted = self.store.accepted().iter();
        accepted.filter(move |sidecar| is_own(&sidecar.photo))
    }

    fn fill_from_store(&mut self) {
        let photos = self.own().map(|s| (s.photo.file.clone(), s.target, s.viewpoint));
        for (photo, target, viewpoint) in photos.collect::<Vec<_>>() {
            let targets = self.guidance.targets();
            let same = targets.iter().position(|t| t.photo.is_none() && t.viewpoint == target);
            let near = || {
                let nearest = self.guidance.nearest_open(&viewpoint)?;
                self.guidance.step(nearest, &viewpoint).is_none().then_some(nearest)
            };
            if let Some(index) = same.or_else(near) {
                self.guidance.fill(index, &photo);
            }
        }
    }

    /// What the camera was set to, for the sidecars of the photos that follow.
    pub fn set_camera_settings(&mut self, settings: Option<CameraSettings>) {
        self.camera_settings = settings;
    }

    /// Judges a frame and takes it when all gates hold; of a stream, when they have held for a moment.
    ///
    /// # Errors
    /// The photo cannot be written. Frames are never errors.
    pub fn see(&mut self, frame: &SourceFrame) -> Result<FrameAnswer, StoreError> {
        self.look(frame, Taking::ByItself)
    }

    /// Takes a frame by hand: it need only be located and on a target, whatever its light, focus and steadiness; its sidecar says so. Of a
    /// stream, give one that [`Capture::see`] was not given: its way is measured from the frame before.
    ///
    /// # Errors
    /// As [`Capture::see`].
    pub fn shoot(&mut self, frame: &SourceFrame) -> Result<FrameAnswer, StoreError> {
        self.look(frame, Taking::ByHand)
    }

    /// Judges a frame that a browser films as those of a stream are. One of the small ones is never taken. Whether the next should come
    /// whole, since it would be taken if all gates still hold. It was filmed `after_ms` after the last one.
    pub(crate) fn filmed(
        &mut self,
        frame: &SourceFrame,
        taking: Taking,
        after_ms: u32,
    ) -> Result<(FrameAnswer, bool), StoreError> {
        // The judge of films stands in for that of photos.
        let swap = |capture: &mut Capture| {
            if let Some(film) = &mut capture.film {
                std::mem::swap(&mut capture.judge, film);
            }
        };
        swap(self);
        self.judge.filmed_after(after_ms);
        let answer = self.look(frame, taking);
        swap(self);
        let wants_whole = self.held.is_some_and(|(_, frames)| frames + 1 >= HELD_FRAMES);
        Ok((answer?, wants_whole))
    }

    pub(crate) fn look(&mut self, frame: &SourceFrame, taking: Taking) -> Result<FrameAnswer, StoreError> {
        let (luma, turned_deg) = match self.luma(frame) {
            Ok(luma) => luma,
            Err(advice) => {
                self.held = None;
                return Ok(FrameAnswer {
                    size_px: [0, 0],
                    viewpoint: None,
                    pose: None,
                    measures: Measures::default(),
                    verdict: Err(advice),
                    cautions: Vec::new(),
                    tags: Vec::new(),
                });
            }
        };
        let mut judgement = self.judge.judge(&luma, turned_deg, &self.camera, &self.guidance);
        let is_by_hand = taking == Taking::ByHand;
        let held = self.hold(&judgement.verdict, taking);
        if self.judge.is_stream() && (is_by_hand || held.is_ok()) {
            let (camera, guidance) = (&self.camera, &self.guidance);
            judgement = self.judge.confirm(judgement, &luma, turned_deg, camera, guidance);
        }
        let target = match (is_by_hand, held) {
            (true, _) => judgement.place,
            (false, Ok(())) => judgement.verdict,
            (false, Err(advice)) => Err(advice),
        };
        let verdict = match (target, &judgement.located) {
            (Ok(target), Some(located)) => self.accept(frame, target, located, judgement.measures, is_by_hand)?,
            (Ok(_), None) => Err(Advice::NoTags), // a frame on target is located
            (Err(advice), _) => Err(advice),
        };
        Ok(FrameAnswer {
            size_px: luma.dimensions().into(),
            viewpoint: judgement.located.as_ref().map(|located| located.viewpoint),
            pose: judgement.located.map(|located| located.pose),
            measures: judgement.measures,
            verdict,
            // That a small picture is small is no news.
            cautions: if taking == Taking::Never {
                Vec::new()
            } else {
                judgement.cautions
            },
            tags: judgement.seen,
        })
    }

    /// The luma of a frame that may be judged, and how far EXIF turned it, degrees.
    fn luma(&self, frame: &SourceFrame) -> Result<(GrayImage, u32), Advice> {
        match &frame.original {
            Original::Unreadable(sentence) => Err(Advice::Unreadable(sentence.clone())),
            Original::Pixels(upright) => Ok((image::imageops::grayscale(upright), 0)),
            Original::Encoded(bytes) => {
                let photo = Photo::from_bytes(Path::new(&frame.name), bytes.clone(), Budget::FILE);
                if let Some(known) = photo.as_ref().ok().and_then(|photo| self.known(&photo.sha256)) {
                    return Err(known);
                }
                let luma = photo.and_then(|photo| Ok((photo.luma()?, photo.turned_deg)));
                let is_one_of_many = self.judge.is_stream();
                luma.map_err(|e| Advice::Unreadable(if is_one_of_many { DAMAGED.into() } else { e.to_string() }))
            }
        }
    }

    fn known(&self, sha256: &str) -> Option<Advice> {
        let taken_back = self.store.was_taken_back(sha256).then_some(Advice::TakenBack);
        let photo = self.store.named(sha256).map(str::to_owned);
        photo.map(|photo| Advice::Repeated { photo }).or(taken_back)
    }

    /// Whether a frame may be taken by itself, by its verdict and those of the frames before it.
    fn hold(&mut self, verdict: &Result<usize, Advice>, taking: Taking) -> Result<(), Advice> {
        let before = self.held.take();
        let target = *verdict.as_ref().map_err(Advice::clone)?;
        if !self.judge.is_stream() {
            return Ok(());
        }
        if !self.is_auto {
            return Err(Advice::Ready);
        }
        let frames = 1 + before.filter(|(of, _)| *of == target).map_or(0, |(_, frames)| frames);
        if frames >= HELD_FRAMES && taking != Taking::Never {
            return Ok(());
        }
        self.held = Some((target, frames));
        Err(Advice::Hold)
    }

    fn accept(
        &mut self,
        frame: &SourceFrame,
        target: usize,
        located: &Located,
        gates: Measures,
        is_by_hand: bool,
    ) -> Result<Result<(String, usize), Advice>, StoreError> {
        let (bytes, extension) = match file_of(&frame.original) {
            Ok(file) => file,
            Err(sentence) => return Ok(Err(Advice::Unreadable(sentence))),
        };
        let sha256 = files::sha256_hex(&bytes);
        let sidecar = Sidecar {
            photo: PhotoEntry {
                file: String::new(),
                variant: self.variant.clone(),
                place: Some(self.place.clone()),
                taken: frame.taken.clone(),
                ..PhotoEntry::default()
            },
            sha256: sha256.clone(),
            source: frame.name.clone(),
            target: self.guidance.targets()[target].viewpoint,
            viewpoint: located.viewpoint,
            sigma: located.sigma,
            T_camera_model: rigid::rows(&located.pose),
            tags: located.tags.clone(),
            rms_px: located.rms_px,
            gates,
            is_by_hand,
            camera: self.camera_settings.clone(),
        };
        let written = self.store.accept(&bytes, extension, sidecar);
        // Once photo and sidecar are written it counts, even when the list could not be.
        if let Some(photo) = self.store.named(&sha256) {
            self.guidance.fill(target, photo);
        }
        Ok(Ok((written?, target)))
    }

    /// Takes back the photo of this variant and place that was accepted last; its name, if there is one.
    ///
    /// # Errors
    /// Files that cannot be moved.
    pub fn undo(&mut self) -> Result<Option<String>, StoreError> {
        let last = self.own().next_back().map(|sidecar| sidecar.photo.file.clone());
        if let Some(photo) = &last {
            self.take_back(photo)?;
        }
        Ok(last)
    }

    /// Takes back the photos of this variant and place in the bins that `is_meant` names; their names.
    ///
    /// # Errors
    /// Files that cannot be moved.
    pub fn redo(&mut self, scene: &Scene, is_meant: impl Fn(&Bin) -> bool) -> Result<Vec<String>, StoreError> {
        let is_meant = |sidecar: &&Sidecar| is_meant(&scene.bins.bin_of(&sidecar.viewpoint));
        let meant = self.own().filter(is_meant);
        let photos: Vec<String> = meant.map(|sidecar| sidecar.photo.file.clone()).collect();
        photos.iter().try_for_each(|photo| self.take_back(photo))?;
        Ok(photos)
    }

    fn take_back(&mut self, photo: &str) -> Result<(), StoreError> {
        let taken_back = self.store.take_back(photo);
        // Without its sidecar it no longer counts, even when the rest could not be written.
        if !self.own().any(|sidecar| sidecar.photo.file == photo) {
            self.guidance.reopen(photo);
        }
        taken_back
    }
}

/// The bytes to keep of a frame, and the ending of their name.
fn file_of(original: &Original) -> Result<(Vec<u8>, &'static str), String> {
    match original {
        Original::Unreadable(sentence) => Err(sentence.clone()),
        Original::Encoded(bytes) => {
            let is_png = image::guess_format(bytes).is_ok_and(|format| format == ImageFormat::Png);
            Ok((bytes.clone(), if is_png { "png" } else { "jpg" }))
        }
        Original::Pixels(upright) => {
            let bytes = photo::sensor_png(upright, 0).ok_or("the camera's image cannot be kept as PNG")?;
            Ok((bytes, "png"))
        }
    }
}
