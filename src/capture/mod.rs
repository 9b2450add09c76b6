//! Guided capture: frames in, advice out, and a session that holds one good photo of each view that is wanted.
//!
//! A frame goes through `gates` (tags, pose, focus, light, steadiness) and `guidance` (the nearest view that is still wanted); what
//! holds is taken at once by `store`, and a refused frame gets one sentence of `advice`. No clock is read: photos are ordered by their
//! numbers.

mod advice;
mod gates;
mod guidance;
pub mod pair;
mod recover;
mod replay;
mod source;
mod store;
mod watch;

use std::io::Cursor;
use std::path::Path;

use image::{GrayImage, ImageFormat};

use crate::camera::{Camera, Fitted};
use crate::files;
use crate::geometry::rigid;
use crate::locate::{Abstention, Located};
use crate::photo::PhotoFile;
use crate::scene::{Bin, Scene, Viewpoint};
use crate::session::PhotoEntry;
use crate::tags::SeenTag;

pub use advice::Advice;
pub use gates::{
    Judge, Judgement, MAX_BLUR_PX, MAX_CLIPPED, MAX_MOVED_PX, MAX_WHITE, MIN_WHITE, Measures, enlargement,
};
pub use guidance::{Guidance, Step, Target, Tolerance, usual, viewpoints_of};
pub use replay::Replay;
pub use source::{Frame, FrameSource, Original, SourceError, SourceName};
pub use store::{Sidecar, Store, StoreError};
pub use watch::Watch;

/// What became of a frame.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Width and height of the upright frame; zeros when it could not be read.
    pub size_px: [u32; 2],
    pub tags: Vec<SeenTag>,
    pub viewpoint: Option<Viewpoint>,
    pub measures: Measures,
    /// The name of the accepted photo and its target's index, or what to do.
    pub verdict: Result<(String, usize), Advice>,
    /// What to know before believing the pose, as sentences.
    pub cautions: Vec<String>,
}

impl Answer {
    fn refused(advice: Advice) -> Answer {
        Answer {
            size_px: [0, 0],
            tags: Vec::new(),
            viewpoint: None,
            measures: Measures::default(),
            verdict: Err(advice),
            cautions: Vec::new(),
        }
    }
}

/// A capture of one variant at one place.
pub struct Capture {
    guidance: Guidance,
    judge: Judge,
    store: Store,
    camera: Camera,
    variant: String,
    place: String,
}

impl Capture {
    /// Goes on with a session: its photos of the variant fill the targets they were taken for, or else the nearest within tolerance.
    pub fn new(guidance: Guidance, judge: Judge, store: Store, camera: Camera, variant: &str, place: &str) -> Capture {
        let mut capture = Capture {
            guidance,
            judge,
            store,
            camera,
            variant: variant.to_owned(),
            place: place.to_owned(),
        };
        capture.fill_from_store();
        capture
    }

    pub fn guidance(&self) -> &Guidance {
        &self.guidance
    }

    fn of_variant(&self) -> impl DoubleEndedIterator<Item = &Sidecar> {
        let accepted = self.store.accepted().iter();
        accepted.filter(|sidecar| sidecar.photo.variant == self.variant)
    }

    fn fill_from_store(&mut self) {
        let photos: Vec<_> = self
            .of_variant()
            .map(|s| (s.photo.file.clone(), s.target, s.viewpoint))
            .collect();
        for (photo, target, viewpoint) in photos {
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

    /// Judges a frame and takes it when all gates hold.
    ///
    /// # Errors
    /// The photo cannot be written. Frames are never errors.
    pub fn see(&mut self, frame: &Frame) -> Result<Answer, StoreError> {
        let (grey, turned_deg) = match &frame.original {
            Original::Unreadable(sentence) => return Ok(Answer::refused(Advice::Unreadable(sentence.clone()))),
            Original::Pixels(rgb) => (image::imageops::grayscale(rgb), 0),
            Original::Encoded(bytes) => {
                if let Some(advice) = self.known(&files::sha256_hex(bytes)) {
                    return Ok(Answer::refused(advice));
                }
                let photo = PhotoFile::of_bytes(Path::new(&frame.name), bytes.clone());
                match photo.and_then(|photo| Ok((photo.grey()?, photo.turned_deg))) {
                    Ok(seen) => seen,
                    Err(e) => return Ok(Answer::refused(Advice::Unreadable(e.to_string()))),
                }
            }
        };
        self.take(frame, &grey, turned_deg)
    }

    fn known(&self, sha256: &str) -> Option<Advice> {
        if let Some(photo) = self.store.named(sha256) {
            return Some(Advice::Repeated {
                photo: photo.to_owned(),
            });
        }
        self.store.was_taken_back(sha256).then_some(Advice::TakenBack)
    }

    fn take(&mut self, frame: &Frame, grey: &GrayImage, turned_deg: u32) -> Result<Answer, StoreError> {
        let fitted = match self.camera.for_photo(grey.width(), grey.height(), turned_deg) {
            Ok(fitted) => fitted,
            Err(e) => return Ok(Answer::refused(Advice::NotLocated(Abstention::from(e)))),
        };
        let judgement = self.judge.judge(grey, &fitted.camera, &self.guidance);
        let verdict = match (judgement.verdict, &judgement.located) {
            (Ok(target), Some(located)) => self.accept(frame, target, located, judgement.measures)?,
            (Ok(_), None) => Err(Advice::NoTags), // a frame on target is located
            (Err(advice), _) => Err(advice),
        };
        Ok(Answer {
            size_px: [grey.width(), grey.height()],
            tags: judgement.seen,
            viewpoint: judgement.located.map(|located| located.viewpoint),
            measures: judgement.measures,
            verdict,
            cautions: Fitted::cautions(&fitted),
        })
    }

    fn accept(
        &mut self,
        frame: &Frame,
        target: usize,
        located: &Located,
        gates: Measures,
    ) -> Result<Result<(String, usize), Advice>, StoreError> {
        let (bytes, extension) = match file_of(&frame.original) {
            Ok(file) => file,
            Err(sentence) => return Ok(Err(Advice::Unreadable(sentence))),
        };
        let sidecar = Sidecar {
            photo: PhotoEntry {
                file: String::new(),
                variant: self.variant.clone(),
                place: Some(self.place.clone()),
                taken: frame.taken.clone(),
                box_xyxy_px: None,
                viewpoint: None,
            },
            sha256: files::sha256_hex(&bytes),
            source: frame.name.clone(),
            target: self.guidance.targets()[target].viewpoint,
            viewpoint: located.viewpoint,
            sigma: located.sigma,
            T_camera_model: rigid::rows(&located.pose),
            tags: located.tags.clone(),
            rms_px: located.rms_px,
            gates,
        };
        let photo = self.store.accept(&bytes, extension, sidecar)?;
        self.guidance.fill(target, &photo);
        Ok(Ok((photo, target)))
    }

    /// Takes back the photo of this variant that was accepted last; its name, if there is one.
    ///
    /// # Errors
    /// Files that cannot be moved.
    pub fn undo(&mut self) -> Result<Option<String>, StoreError> {
        let last = self.of_variant().next_back().map(|sidecar| sidecar.photo.file.clone());
        if let Some(photo) = &last {
            self.take_back(photo)?;
        }
        Ok(last)
    }

    /// Takes back the photos of this variant in the bins that `is_meant` names; their names.
    ///
    /// # Errors
    /// Files that cannot be moved.
    pub fn redo(&mut self, scene: &Scene, is_meant: impl Fn(&Bin) -> bool) -> Result<Vec<String>, StoreError> {
        let meant = self
            .of_variant()
            .filter(|sidecar| is_meant(&scene.bins.bin_of(&sidecar.viewpoint)));
        let photos: Vec<String> = meant.map(|sidecar| sidecar.photo.file.clone()).collect();
        photos.iter().try_for_each(|photo| self.take_back(photo))?;
        Ok(photos)
    }

    fn take_back(&mut self, photo: &str) -> Result<(), StoreError> {
        self.store.take_back(photo)?;
        self.guidance.reopen(photo);
        Ok(())
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
        Original::Pixels(rgb) => {
            let mut bytes = Vec::new();
            let written = rgb.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png);
            written.map_err(|e| format!("the camera's picture cannot be kept as PNG: {e}"))?;
            Ok((bytes, "png"))
        }
    }
}
