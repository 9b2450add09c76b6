//! A capture: frames are judged, and those that hold are accepted into the session.

use std::path::Path;

use image::{GrayImage, ImageFormat};

use super::advice::Advice;
use super::answer::FrameAnswer;
use super::gates::{Judge, Measures};
use super::guidance::Guidance;
use super::source::{CameraSettings, Original, SourceFrame};
use super::steady::{SteadyRun, Taking};
use super::store::{Sidecar, Store, StoreError};
use scaleproof_core::files;
use scaleproof_core::geometry::rigid;
use scaleproof_photo as photo;
use scaleproof_photo::{Budget, Photo};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::Located;
use scaleproof_pose::scene::{Bin, Scene};
use scaleproof_session::PhotoEntry;

/// Sentence on a damaged image of a running camera.
const DAMAGED: &str = "the camera sent a damaged image: check its connection";

/// A capture of one variant at one place.
pub struct Capture {
    guidance: Guidance,
    gates: Judge,
    /// Judges what a browser films, beside the photos of the source.
    film: Option<Judge>,
    store: Store,
    camera: Camera,
    variant: String,
    place: String,
    /// Last frames of a stream, fit for one target.
    run: SteadyRun,
    camera_settings: Option<CameraSettings>,
}

impl Capture {
    /// Goes on with a session: its photos of the variant at the place fill the targets they were taken for, or else the nearest within tolerance.
    pub fn new(guidance: Guidance, judge: Judge, store: Store, camera: Camera, variant: &str, place: &str) -> Capture {
        let mut capture = Capture {
            guidance,
            gates: judge,
            film: None,
            store,
            camera,
            variant: variant.to_owned(),
            place: place.to_owned(),
            run: SteadyRun::default(),
            camera_settings: None,
        };
        capture.fill_from_store();
        capture
    }

    /// Adds a judge of streams for what a browser films.
    pub fn with_film(self, judge: Judge) -> Capture {
        let film = Some(judge);
        Capture { film, ..self }
    }

    /// Returns the camera of the camera file.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    pub fn guidance(&self) -> &Guidance {
        &self.guidance
    }

    /// Returns the photos of this variant at this place.
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

    /// Takes frames of a stream by hand only, from now on.
    pub fn take_by_hand_only(&mut self) {
        self.run.is_auto = false;
    }

    /// Sets the camera's settings, for the sidecars of the photos that follow.
    pub fn set_camera_settings(&mut self, settings: Option<CameraSettings>) {
        self.camera_settings = settings;
    }

    /// Judges a frame and takes it when all gates hold; of a stream, when they have held for a moment.
    ///
    /// # Errors
    /// The photo cannot be written. Frames are never errors.
    pub fn see(&mut self, frame: &SourceFrame) -> Result<FrameAnswer, StoreError> {
        self.judge(frame, Taking::ByItself)
    }

    /// Takes a frame by hand: it need only be located and on a target, whatever its light, focus and steadiness; its sidecar says so. Of a
    /// stream, give one that [`Capture::see`] was not given: its way is measured from the frame before.
    ///
    /// # Errors
    /// As [`Capture::see`].
    pub fn shoot(&mut self, frame: &SourceFrame) -> Result<FrameAnswer, StoreError> {
        self.judge(frame, Taking::ByHand)
    }

    /// Judges a frame that a browser films as those of a stream are. One of the small ones is never taken. Returns true if the next should come
    /// whole, since it would be taken if all gates still hold. It was filmed `after_ms` after the last one.
    pub(crate) fn judge_filmed(
        &mut self,
        frame: &SourceFrame,
        taking: Taking,
        after_ms: u32,
    ) -> Result<(FrameAnswer, bool), StoreError> {
        // The judge of films stands in for that of photos.
        let swap = |capture: &mut Capture| {
            if let Some(film) = &mut capture.film {
                std::mem::swap(&mut capture.gates, film);
            }
        };
        swap(self);
        self.gates.filmed_after(after_ms);
        let answer = self.judge(frame, taking);
        swap(self);
        Ok((answer?, self.run.lacks_one()))
    }

    /// Judges a frame, and takes it as `taking` says.
    pub(crate) fn judge(&mut self, frame: &SourceFrame, taking: Taking) -> Result<FrameAnswer, StoreError> {
        let (luma, turned_deg) = match self.luma(frame) {
            Ok(luma) => luma,
            Err(advice) => {
                self.run.end();
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
        let (camera, guidance) = (&self.camera, &self.guidance);
        let judgement = self
            .gates
            .decide(&luma, turned_deg, camera, guidance, taking, &mut self.run);
        let verdict = match (judgement.verdict, &judgement.located) {
            (Ok(target), Some(located)) => {
                let is_by_hand = taking == Taking::ByHand;
                self.accept(frame, target, located, judgement.measures, is_by_hand)?
            }
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

    /// Returns the luma of a frame that may be judged, and its turn by EXIF, degrees.
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
                let is_one_of_many = self.gates.is_stream();
                luma.map_err(|e| Advice::Unreadable(if is_one_of_many { DAMAGED.into() } else { e.to_string() }))
            }
        }
    }

    fn known(&self, sha256: &str) -> Option<Advice> {
        let taken_back = self.store.was_taken_back(sha256).then_some(Advice::TakenBack);
        let photo = self.store.named(sha256).map(str::to_owned);
        photo.map(|photo| Advice::Repeated { photo }).or(taken_back)
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

    /// Takes back the photo of this variant and place that was accepted last; returns its name, if there is one.
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

    /// Takes back the photos of this variant and place in the bins that `is_meant` names; returns their names.
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

/// Returns the bytes to keep of a frame, and the extension of their file name.
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
