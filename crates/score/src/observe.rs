//! Observation of photos: tags, detections, a preview. All that is slow is in here, and all of it can be cached.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use image::RgbImage;
use serde::{Deserialize, Serialize};

use super::cache::{Cache, Key};
use super::decoded::DecodedPhoto;
use super::error::ScoreError;
use super::{DetectionSource, EvaluatedDetector, NotScored, preview};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::workers;
use scaleproof_core::workers::stopwatch::{Stage, timed};
use scaleproof_detect::{DetectError, Detection, Detector, ProgramDetector, ProgramError, ProgramPhoto, Runtime};
use scaleproof_photo::{PerceptualHash, Photo, PhotoError, perceptual_hash};
use scaleproof_pose::locate::{Located, Warning, locate_luma, locate_tags};
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::{SeenTag, TagDetector, TagDetectorChoice};
use scaleproof_session::{PhotoEntry, Session};

/// Options of a run.
#[derive(Debug)]
pub struct Options {
    /// Number of photos that are observed in parallel.
    pub threads: usize,
    /// Cache of results for the next run.
    pub cache: Option<Cache>,
    /// Tag detector: it changes results, and the cache is opened for it.
    pub tags: TagDetectorChoice,
    /// Set to true from another thread, it ends the run after the photos that are in work.
    pub stop: Arc<AtomicBool>,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            threads: workers::thread_count(),
            cache: None,
            tags: TagDetectorChoice::default(),
            stop: Arc::default(),
        }
    }
}

/// All that a run needs of a photo's pixels. Poses, truth, hits and figures follow from it in no time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// SHA-256 of the file, hex.
    pub sha256: String,
    /// Width of the upright photo, px.
    pub width: u32,
    pub height: u32,
    /// Degrees by which EXIF turned the photo clockwise.
    pub turned_deg: u32,
    /// Time when it was taken, as EXIF says.
    pub taken: Option<String>,
    pub exposure: Option<String>,
    /// Tags of the scene that were needed for its pose. Empty when the session says where the model is, unless that is checked by tags.
    pub tags: Vec<SeenTag>,
    /// Detections, one list per detector, best first.
    pub detections: Vec<Vec<Detection>>,
    /// A small JPEG for the report; empty when it shows other photos.
    pub preview_jpeg: Vec<u8>,
    /// Hash by which near-copies are found.
    pub hash: PerceptualHash,
}

impl Observation {
    /// Returns the observation of a photo's file before anything is searched.
    fn unseen(photo: &Photo) -> Observation {
        let shot = photo.shot();
        Observation {
            sha256: photo.sha256.clone(),
            width: photo.width,
            height: photo.height,
            turned_deg: photo.turned_deg,
            taken: shot.taken,
            exposure: shot.exposure,
            tags: Vec::new(),
            detections: Vec::new(),
            preview_jpeg: Vec::new(),
            hash: PerceptualHash::default(),
        }
    }
}

/// Reason why a photo is left out, as a sentence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("{0}")]
pub struct NotScoredReason(pub(super) String);

impl NotScoredReason {
    pub(super) fn new(reason: impl ToString) -> NotScoredReason {
        NotScoredReason(reason.to_string())
    }
}

pub(super) struct ScoringJob<'a> {
    /// Number from 1, in the order of the sessions.
    pub id: u64,
    pub session_index: usize,
    pub session: &'a Session,
    pub entry: &'a PhotoEntry,
    /// True if the photo's tags are searched to check the list, though the list says all that they would.
    pub is_checked: bool,
}

impl ScoringJob<'_> {
    pub(super) fn all(sessions: &[Session]) -> Vec<ScoringJob<'_>> {
        let sessions = sessions.iter().enumerate();
        let entries = sessions.flat_map(|(i, s)| s.photos.iter().map(move |entry| (i, s, entry)));
        let job = |(id, (session_index, session, entry))| ScoringJob {
            id,
            session_index,
            session,
            entry,
            is_checked: false,
        };
        (1..).zip(entries).map(job).collect()
    }

    pub(super) fn left_out(&self, reason: NotScoredReason) -> NotScored {
        NotScored {
            session: self.session.name.clone(),
            file: self.entry.file.clone(),
            variant: self.entry.variant.clone(),
            reason: reason.0,
            near_copy_of: None,
        }
    }

    /// Returns the index among the photos of the run, from 0.
    fn index(&self) -> usize {
        usize::try_from(self.id.saturating_sub(1)).unwrap_or(usize::MAX)
    }

    pub(super) fn needs_tags(&self) -> bool {
        self.entry.box_xyxy_px.is_none() || self.entry.viewpoint.is_none()
    }
}

/// Ground truth box of the model in a photo, and the located pose.
pub(super) struct PlacedModel {
    pub located: Option<Located>,
    pub truth: BoxPx,
}

/// Returns the session's own truth and viewpoint where it has them, else those from the tags, or the reason why there is none.
pub(super) fn place(job: &ScoringJob, seen: &Observation) -> Result<PlacedModel, NotScoredReason> {
    let scene = &job.session.scene;
    let given = job.entry.box_xyxy_px;
    let given = given.map(|b| b.clipped(seen.width.into(), seen.height.into()));
    if given.is_some_and(|b| !b.is_solid()) {
        return Err(NotScoredReason::new(
            "box_xyxy_px lies outside the photo: is it another photo's?",
        ));
    }
    if let (Some(truth), false) = (given, job.needs_tags()) {
        return Ok(PlacedModel { located: None, truth });
    }
    let camera = job.session.known_camera().map_err(NotScoredReason::new)?;
    let size = (seen.width, seen.height);
    let photo = locate_tags(seen.tags.clone(), size, seen.turned_deg, scene, camera);
    if let Some(truth) = given {
        let located = photo.result.ok();
        return Ok(PlacedModel { located, truth });
    }
    let (located, fitted) = photo.pose_and_camera().map_err(NotScoredReason::new)?;
    let outline = &job.session.outline;
    let truth = outline
        .box_in_photo(&located.pose, &fitted.camera)
        .map_err(NotScoredReason::new)?;
    if located.warnings.contains(&Warning::OpenPose) {
        // Only the bin is certain: the box must be the same by both poses.
        let rival = located.lone.as_ref().and_then(|lone| lone.rival);
        let other = rival.and_then(|rival| outline.box_in_photo(&rival.pose, &fitted.camera).ok());
        let iou = other.map_or(0.0, |other| truth.iou(&other));
        if iou < SAME_BOX_IOU {
            return Err(NotScoredReason(format!(
                "its one tag says from which bin the photo was taken, but not where the model's box is (two poses, whose boxes have an IoU of \
                 {iou:.2}; {SAME_BOX_IOU} is needed): let a second tag be seen, or give box_xyxy_px"
            )));
        }
    }
    Ok(PlacedModel {
        truth,
        located: Some(located),
    })
}

/// Least IoU at which boxes by the two poses of a lone tag are one box: the strictest threshold of COCO's average precision, at which the same
/// detection is a hit by either.
const SAME_BOX_IOU: f64 = 0.95;

/// Least size of the image that a perceptual hash is made from, px.
const HASHED_FROM_PX: [u32; 2] = [64, 64];

pub(super) struct Observer<'a> {
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

pub(super) struct PhotoPart<'a> {
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
pub(super) enum Stop {
    #[error(transparent)]
    Photo(#[from] NotScoredReason),
    /// Error that ends the run.
    #[error(transparent)]
    Run(#[from] ScoreError),
}

impl From<DetectError> for Stop {
    fn from(error: DetectError) -> Stop {
        match error {
            DetectError::NotANumber(_) => NotScoredReason::new(error).into(),
            error => Stop::Run(error.into()),
        }
    }
}

impl From<ProgramError> for Stop {
    fn from(error: ProgramError) -> Stop {
        match error {
            ProgramError::Declined(_) => NotScoredReason::new(error).into(),
            error => Stop::Run(error.into()),
        }
    }
}

impl From<PhotoError> for Stop {
    fn from(e: PhotoError) -> Stop {
        NotScoredReason::new(e).into()
    }
}

/// Splits the reasons: the outer error ends the run, the inner one only leaves the photo out.
fn unless_run_ends<T>(seen: Result<T, Stop>) -> Result<Result<T, NotScoredReason>, ScoreError> {
    match seen {
        Ok(seen) => Ok(Ok(seen)),
        Err(Stop::Photo(reason)) => Ok(Err(reason)),
        Err(Stop::Run(e)) => Err(e),
    }
}

impl<'a> Observer<'a> {
    pub(super) fn new(
        (families, tags): (&'a [TagFamily], TagDetectorChoice),
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
    pub(super) fn photo(
        &mut self,
        job: &ScoringJob,
    ) -> Result<Result<(Observation, PlacedModel), NotScored>, ScoreError> {
        Ok(unless_run_ends(self.observe(job))?.map_err(|reason| job.left_out(reason)))
    }

    /// Returns a photo's tags without running any detector, or the reason why they cannot be searched.
    pub(super) fn tags_alone(&mut self, job: &ScoringJob) -> Result<Result<Observation, NotScoredReason>, ScoreError> {
        let mut looked = || -> Result<Observation, Stop> {
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
    fn observe(&mut self, job: &ScoringJob) -> Result<(Observation, PlacedModel), Stop> {
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
    fn tags(&mut self, session: &Session, photo: &Photo) -> Result<Vec<SeenTag>, Stop> {
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
    ) -> Result<Vec<Detection>, Stop> {
        let detector = &self.detectors[index];
        let (photo, file) = (decoded.file, &job.entry.file);
        let not_recorded = || ScoreError::NotRecorded {
            file: file.clone(),
            detector: detector.manifest.name.clone(),
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
    ) -> Result<Vec<Detection>, Stop> {
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
    pub(super) fn in_part(
        &mut self,
        index: usize,
        part: &PhotoPart,
        image: &mut dyn FnMut() -> Result<Arc<RgbImage>, Stop>,
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
            _ => {
                let detector = detector.manifest.name.clone();
                let changed = "changed";
                Err(ScoreError::NotCorruptible { detector, changed }.into())
            }
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
        compute: impl FnOnce(&mut Self) -> Result<T, Stop>,
    ) -> Result<T, Stop> {
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
