//! Observation of photos: tags, detections, a preview. All that is slow is in here, and all of it can be cached.

use std::path::Path;
use std::sync::Arc;

use image::RgbImage;
use serde::Serialize;

use crate::error::ScoreError;
use crate::evaluated::{DetectionSource, EvaluatedDetector, not_changeable};
use crate::figures::NotScored;
use crate::observe::{Cache, DecodedPhoto, Key, NotScoredReason, Observation, PlacedModel, ScoringJob, place, preview};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, message};
use scaleproof_core::workers::stopwatch::{Stage, timed};
use scaleproof_detect::{DetectError, Detection, Detector, ProgramDetector, ProgramError, ProgramPhoto, Runtime};
use scaleproof_photo::{Photo, PhotoError, perceptual_hash};
use scaleproof_pose::locate::locate_luma;
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::{SeenTag, TagDetector, TagDetectorChoice};
use scaleproof_session::Session;

/// Least size of the image that a perceptual hash is made from, px.
const HASHED_FROM_PX: [u32; 2] = [64, 64];

pub(crate) struct Observer<'a> {
    families: &'a [TagFamily],
    detectors: &'a [EvaluatedDetector],
    runtime: Option<&'static Runtime>,
    cache: Option<&'a Cache>,
    /// Number of photos of the whole run, of which this one may see a part.
    photos: usize,
    tags: Box<dyn TagDetector>,
    /// Detectors, opened when first needed, so that a run whose results are cached loads no network.
    loaded: Vec<Option<Detector>>,
}

pub(crate) struct PhotoPart<'a> {
    pub path: &'a Path,
    /// File, as the session names it.
    pub file: &'a str,
    pub sha256: &'a str,
    /// Place of the part in the photo, px.
    pub window: BoxPx,
    /// Name of all that the image depends on besides the photo's content; `None` where it may be another one each time.
    pub name: Option<&'a str>,
}

impl PhotoPart<'_> {
    /// Maps detections in an image of the part, of (width, height) in px, to the photo.
    fn in_photo(&self, found: Vec<Detection>, (width, height): (u32, u32)) -> Vec<Detection> {
        let BoxPx { x1, y1, x2, y2 } = self.window;
        let (across, down) = ((x2 - x1) / f64::from(width), (y2 - y1) / f64::from(height));
        let moved = found.into_iter().filter_map(|d| {
            let b = d.box_px;
            let [from, to] = [(b.x1, b.y1), (b.x2, b.y2)].map(|(x, y)| (x1 + across * x, y1 + down * y));
            let in_photo = BoxPx::new(from.0, from.1, to.0, to.1);
            Detection::new(d.label, d.score, in_photo)
        });
        moved.collect()
    }
}

/// Reason why a photo could not be observed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ObserveError {
    #[error(transparent)]
    Photo(#[from] NotScoredReason),
    /// Error that ends the run.
    #[error(transparent)]
    Run(#[from] ScoreError),
}

impl From<DetectError> for ObserveError {
    fn from(error: DetectError) -> ObserveError {
        match error {
            DetectError::NotANumber(_) => NotScoredReason::new(error).into(),
            error => ObserveError::Run(error.into()),
        }
    }
}

impl From<ProgramError> for ObserveError {
    fn from(error: ProgramError) -> ObserveError {
        match error {
            ProgramError::Declined(_) => NotScoredReason::new(error).into(),
            error => ObserveError::Run(error.into()),
        }
    }
}

impl From<Message> for ObserveError {
    fn from(error: Message) -> ObserveError {
        ObserveError::Run(error.into())
    }
}

impl From<PhotoError> for ObserveError {
    fn from(e: PhotoError) -> ObserveError {
        NotScoredReason::new(e).into()
    }
}

/// Splits the reasons: the outer error ends the run, the inner one only leaves the photo out.
fn unless_run_ends<T>(seen: Result<T, ObserveError>) -> Result<Result<T, NotScoredReason>, ScoreError> {
    match seen {
        Ok(seen) => Ok(Ok(seen)),
        Err(ObserveError::Photo(reason)) => Ok(Err(reason)),
        Err(ObserveError::Run(e)) => Err(e),
    }
}

impl<'a> Observer<'a> {
    pub(crate) fn new(
        families: &'a [TagFamily],
        tags: TagDetectorChoice,
        detectors: &'a [EvaluatedDetector],
        runtime: Option<&'static Runtime>,
        cache: Option<&'a Cache>,
        photos: usize,
    ) -> Result<Observer<'a>, ScoreError> {
        Ok(Observer {
            families,
            detectors,
            runtime,
            cache,
            photos,
            tags: tags.open(families)?,
            loaded: detectors.iter().map(|_| None).collect(),
        })
    }

    /// Observes and places a photo: the outer error ends the run, the inner one only leaves the photo out.
    pub(crate) fn photo(
        &mut self,
        job: &ScoringJob,
    ) -> Result<Result<(Observation, PlacedModel), NotScored>, ScoreError> {
        Ok(unless_run_ends(self.observe(job))?.map_err(|reason| job.left_out(reason)))
    }

    /// Returns a photo's tags without running any detector, or the reason why they cannot be searched.
    pub(crate) fn tags_alone(&mut self, job: &ScoringJob) -> Result<Result<Observation, NotScoredReason>, ScoreError> {
        let mut looked = || -> Result<Observation, ObserveError> {
            let photo = timed(Stage::Read, || Photo::open(&job.session.photo_path(job.entry)))?;
            let tags = self.tags(job.session, &photo)?;
            Ok(Observation {
                tags,
                ..Observation::unseen(&photo)
            })
        };
        unless_run_ends(looked())
    }

    /// Observes a photo, tags first: no detector runs on one that cannot be placed.
    fn observe(&mut self, job: &ScoringJob) -> Result<(Observation, PlacedModel), ObserveError> {
        let photo = timed(Stage::Read, || Photo::open(&job.session.photo_path(job.entry)))?;
        let mut seen = Observation::unseen(&photo);
        if job.needs_tags() || job.is_checked {
            seen.tags = self.tags(job.session, &photo)?;
        }
        let place = timed(Stage::Pose, || place(job, &seen))?;
        let mut decoded = DecodedPhoto::new(&photo);
        for index in 0..self.detectors.len() {
            seen.detections.push(self.detections(index, job, &mut decoded)?);
        }
        if preview::has_preview(job.id, self.photos) {
            let side_px = preview::longest_side_px(self.photos);
            let key = self.key(&["preview", &photo.sha256, &side_px.to_string()]);
            seen.preview_jpeg = self.kept(key, |_| Ok(preview::jpeg(&mut decoded, side_px)?))?;
        }
        let key = self.key(&["perceptual hash", &photo.sha256]);
        seen.hash = self.kept(key, |_| Ok(perceptual_hash(decoded.at_least(HASHED_FROM_PX)?)))?;
        Ok((seen, place))
    }

    /// Returns the tags of a photo. The search stops where a pose says that nothing is missing, so that it depends on the scene and the camera, too.
    fn tags(&mut self, session: &Session, photo: &Photo) -> Result<Vec<SeenTag>, ObserveError> {
        let scene = &session.scene;
        let camera = session.known_camera().map_err(NotScoredReason::new)?;
        let searched = format!("{:?} {:?} {:?} {camera:?}", self.families, scene.tags, scene.model);
        let key = self.key(&["tags", &photo.sha256, &searched]);
        self.kept(key, |own| {
            let luma = timed(Stage::Read, || photo.luma_where_seen())?;
            let search = || locate_luma(luma.as_ref(), photo.turned_deg, None, scene, camera, own.tags.as_mut());
            Ok(timed(Stage::Tags, search).seen)
        })
    }

    fn detections(
        &mut self,
        index: usize,
        job: &ScoringJob,
        decoded: &mut DecodedPhoto,
    ) -> Result<Vec<Detection>, ObserveError> {
        let detector = &self.detectors[index];
        let (photo, file) = (decoded.file, &job.entry.file);
        let not_recorded = || {
            message!("{file} has no recorded detections of {}", detector.manifest.name)
                .hint("run without ‹recorded›, or record them again with ‹record›")
        };
        match &detector.source {
            DetectionSource::Live(weights) => {
                let key = self.network_key(index, &["detections", &photo.sha256]);
                let (manifest, size) = (&detector.manifest, [photo.width, photo.height]);
                let wants_whole = |detector: &&EvaluatedDetector| detector.looks_at_whole(size);
                let is_alone = self.detectors.iter().filter(wants_whole).count() == 1;
                self.kept(key, |own| {
                    let [width, height] = size;
                    let brought_to = manifest.opencv_linear_px(width, height).filter(|_| is_alone);
                    let resized = brought_to.map(|size| decoded.opencv_linear(size)).transpose()?;
                    let image = match resized.flatten() {
                        Some(image) => Arc::new(image),
                        None => Arc::clone(decoded.at_least(manifest.least_px(width, height))?),
                    };
                    let loaded = own.loaded(index, weights)?;
                    Ok(timed(Stage::Network, || loaded.detect_reduced(&image, width, height))?)
                })
            }
            DetectionSource::Recorded(recordings) => {
                let found = recordings.iter().find_map(|r| r.of_photo(&photo.sha256));
                Ok(found.ok_or_else(not_recorded)?.to_vec())
            }
            DetectionSource::Outside(results) => {
                let found = results.of_photo(job.index(), file, [photo.width, photo.height]);
                Ok(found.map_err(ScoreError::from)?)
            }
            DetectionSource::Program(program) => self.by_program(program, job, decoded),
            DetectionSource::Called(function) => {
                let image = decoded.at_least([photo.width, photo.height])?;
                Ok(timed(Stage::Network, || function.detect(file, image))?)
            }
            DetectionSource::Elsewhere(_) => Err(not_recorded().into()),
        }
    }

    /// Returns the detections of a program. They are cached only when it says that it is deterministic.
    fn by_program(
        &mut self,
        program: &ProgramDetector,
        job: &ScoringJob,
        decoded: &mut DecodedPhoto,
    ) -> Result<Vec<Detection>, ObserveError> {
        let sha256 = decoded.file.sha256.clone();
        if let Some(found) = program.answered(&sha256) {
            return Ok(found);
        }
        let key = self.key(&["program", &sha256, &program.card().sha256()]);
        let found = self.kept(key.filter(|_| program.is_deterministic()), |_| {
            let size = [decoded.file.width, decoded.file.height];
            let pixels = program.takes_pixels().then(|| decoded.at_least(size)).transpose()?;
            Ok(program.detect(&ProgramPhoto {
                path: &job.session.photo_path(job.entry),
                file: &job.entry.file,
                size,
                pixels: pixels.map(Arc::as_ref),
            })?)
        })?;
        program.remember(&sha256, &found);
        Ok(found)
    }

    /// Returns the detections of a detector in an image of a part of a photo, in the photo's pixels, or the reason why there are none. `image` is
    /// called where nothing is cached.
    pub(crate) fn in_part(
        &mut self,
        index: usize,
        part: &PhotoPart,
        image: &mut dyn FnMut() -> Result<Arc<RgbImage>, ObserveError>,
    ) -> Result<Result<Vec<Detection>, NotScoredReason>, ScoreError> {
        let detector = &self.detectors[index];
        unless_run_ends(match &detector.source {
            DetectionSource::Live(weights) => {
                let key = part
                    .name
                    .and_then(|name| self.network_key(index, &["part", name, part.sha256]));
                self.kept(key, |own| {
                    let image = image()?;
                    let found = own.loaded(index, weights)?.detect(&image)?;
                    Ok(part.in_photo(found, image.dimensions()))
                })
            }
            DetectionSource::Program(program) => {
                let card = program.card().sha256();
                let key = part.name.and_then(|name| self.key(&["part", name, part.sha256, &card]));
                self.kept(key.filter(|_| program.is_deterministic()), |_| {
                    let image = image()?;
                    let found = program.detect(&ProgramPhoto {
                        path: part.path,
                        file: part.file,
                        size: image.dimensions().into(),
                        pixels: Some(&image),
                    })?;
                    Ok(part.in_photo(found, image.dimensions()))
                })
            }
            DetectionSource::Called(function) => (|| {
                let image = image()?;
                let found = function.detect(part.file, &image)?;
                Ok(part.in_photo(found, image.dimensions()))
            })(),
            _ => Err(not_changeable(&detector.manifest.name, "changed").into()),
        })
    }

    /// Returns the key of a network's detections: also of its weights, and of how it is fed and read.
    fn network_key(&self, index: usize, parts: &[&str]) -> Option<Key> {
        let manifest = &self.detectors[index].manifest;
        let read = format!("{:?} {:?} {:?}", manifest.input, manifest.head, manifest.labels);
        self.key(&[parts, &[&manifest.weights.sha256, &read]].concat())
    }

    fn loaded(&mut self, index: usize, weights: &Path) -> Result<&mut Detector, DetectError> {
        let opened = match self.loaded[index].take() {
            Some(detector) => detector,
            None => {
                let runtime = self.runtime.map_or_else(Runtime::load, Ok)?;
                Detector::open(runtime, &self.detectors[index].manifest, weights)?
            }
        };
        Ok(self.loaded[index].insert(opened))
    }

    fn key(&self, parts: &[&str]) -> Option<Key> {
        self.cache.map(|cache| cache.key(parts))
    }

    /// Returns the cached value of a key, else that of `compute`, which is then cached.
    fn kept<T: Serialize + serde::de::DeserializeOwned>(
        &mut self,
        key: Option<Key>,
        compute: impl FnOnce(&mut Self) -> Result<T, ObserveError>,
    ) -> Result<T, ObserveError> {
        let Some((cache, key)) = self.cache.zip(key) else {
            return compute(self);
        };
        if let Some(value) = cache.get(&key) {
            return Ok(value);
        }
        let value = compute(self)?;
        cache.put(&key, &value);
        Ok(value)
    }
}
