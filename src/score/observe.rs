//! What the pixels of a photo say: tags, detections, a preview. All that is slow is in here, and all of it can be kept.

use image::RgbImage;
use serde::{Deserialize, Serialize};

use super::cache::{Cache, Key};
use super::{Contestant, NotScored, ScoreError, Source, preview};
use crate::detect::{DetectError, Detection, Detector, Runtime};
use crate::geometry::BoxPx;
use crate::locate::{Located, locate_tags};
use crate::photo::{Photo, PhotoError};
use crate::scene::TagFamily;
use crate::session::{PhotoEntry, Session};
use crate::tags::{SeenTag, TagDetector, TagDetectorChoice};
use crate::workers;

/// How a run is done; none of it changes a result.
#[derive(Debug)]
pub struct Options {
    pub threads: usize,
    /// Where results are kept for the next run.
    pub cache: Option<Cache>,
}

impl Default for Options {
    /// One thread a core, nothing kept.
    fn default() -> Options {
        Options {
            threads: workers::thread_count(),
            cache: None,
        }
    }
}

/// All that a run needs to know of a photo's pixels. Poses, truth, hits and figures follow from it in no time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// SHA-256 of the file, hex.
    pub sha256: String,
    /// Of the upright picture, in pixels.
    pub width: u32,
    pub height: u32,
    /// How far EXIF turned the picture clockwise.
    pub turned_deg: u32,
    /// Empty when the session says where the model is.
    pub tags: Vec<SeenTag>,
    /// One list per contestant, best first.
    pub detections: Vec<Vec<Detection>>,
    /// A small JPEG for the report; empty when it shows other photos.
    pub preview_jpeg: Vec<u8>,
}

/// One photo to be scored.
pub(super) struct Job<'a> {
    /// From 1, in the order of the sessions.
    pub id: u64,
    pub session_index: usize,
    pub session: &'a Session,
    pub entry: &'a PhotoEntry,
}

impl Job<'_> {
    pub fn all(sessions: &[Session]) -> Vec<Job<'_>> {
        let entries = sessions
            .iter()
            .enumerate()
            .flat_map(|(i, s)| s.photos.iter().map(move |entry| (i, s, entry)));
        (1..)
            .zip(entries)
            .map(|(id, (session_index, session, entry))| Job {
                id,
                session_index,
                session,
                entry,
            })
            .collect()
    }

    pub fn left_out(&self, reason: String) -> NotScored {
        NotScored {
            session: self.session.name.clone(),
            file: self.entry.file.clone(),
            variant: self.entry.variant.clone(),
            reason,
        }
    }

    fn needs_tags(&self) -> bool {
        self.entry.box_xyxy_px.is_none() || self.entry.viewpoint.is_none()
    }
}

/// Where the model is in a photo, and from where it was seen.
pub(super) struct Place {
    pub located: Option<Located>,
    pub truth: BoxPx,
}

/// The session's own truth and viewpoint where it has them, else from the tags; or why there is none.
pub(super) fn place(job: &Job, seen: &Observation) -> Result<Place, String> {
    let scene = &job.session.scene;
    let given = job
        .entry
        .box_xyxy_px
        .map(|b| b.clipped(seen.width.into(), seen.height.into()));
    if given.is_some_and(|b| !b.is_solid()) {
        return Err("box_xyxy_px lies outside the picture: is it another photo's?".into());
    }
    if let (Some(truth), false) = (given, job.needs_tags()) {
        return Ok(Place { located: None, truth });
    }
    let camera = job.session.known_camera().map_err(|e| e.to_string())?;
    let photo = locate_tags(
        seen.tags.clone(),
        (seen.width, seen.height),
        seen.turned_deg,
        scene,
        camera,
    );
    if let Some(truth) = given {
        let located = photo.result.ok();
        return Ok(Place { located, truth });
    }
    let (located, fitted) = photo.pose_and_camera().map_err(|e| e.to_string())?;
    let truth = job.session.outline.box_in_photo(&located.pose, &fitted.camera);
    Ok(Place {
        truth: truth.map_err(|e| e.to_string())?,
        located: Some(located),
    })
}

/// What each thread owns.
pub(super) struct Observer<'a> {
    families: &'a [TagFamily],
    contestants: &'a [Contestant],
    runtime: Option<&'static Runtime>,
    cache: Option<&'a Cache>,
    /// Photos of the whole run, of which this one may see a part.
    photos: usize,
    tags: Box<dyn TagDetector>,
    /// Opened when first needed, so that a run whose results are kept loads no network.
    detectors: Vec<Option<Detector>>,
}

/// Why a photo could not be observed.
enum Stop {
    /// It is left out.
    Photo(String),
    /// The run ends.
    Run(ScoreError),
}

impl From<PhotoError> for Stop {
    fn from(e: PhotoError) -> Stop {
        Stop::Photo(e.to_string())
    }
}

impl<'a> Observer<'a> {
    pub fn new(
        families: &'a [TagFamily],
        contestants: &'a [Contestant],
        runtime: Option<&'static Runtime>,
        cache: Option<&'a Cache>,
        photos: usize,
    ) -> Result<Observer<'a>, ScoreError> {
        Ok(Observer {
            families,
            contestants,
            runtime,
            cache,
            photos,
            tags: TagDetectorChoice::default().open(families)?,
            detectors: contestants.iter().map(|_| None).collect(),
        })
    }

    /// The outer error ends the run, the inner one only leaves the photo out.
    pub fn photo(&mut self, job: &Job) -> Result<Result<(Observation, Place), NotScored>, ScoreError> {
        match self.observe(job) {
            Ok(seen) => Ok(Ok(seen)),
            Err(Stop::Photo(reason)) => Ok(Err(job.left_out(reason))),
            Err(Stop::Run(e)) => Err(e),
        }
    }

    /// Tags first: no detector looks at a photo that cannot be placed.
    fn observe(&mut self, job: &Job) -> Result<(Observation, Place), Stop> {
        let photo = Photo::open(&job.session.photo_path(job.entry))?;
        let mut seen = Observation {
            sha256: photo.sha256.clone(),
            width: photo.width,
            height: photo.height,
            turned_deg: photo.turned_deg,
            tags: match job.needs_tags() {
                true => self.tags(&photo)?,
                false => Vec::new(),
            },
            detections: Vec::new(),
            preview_jpeg: Vec::new(),
        };
        let place = place(job, &seen).map_err(Stop::Photo)?;
        let mut pictures = Pictures::of(&photo);
        for index in 0..self.contestants.len() {
            seen.detections.push(self.detections(index, job, &mut pictures)?);
        }
        if preview::has_preview(job.id, self.photos) {
            let side_px = preview::longest_side_px(self.photos);
            let key = self.key(&["preview", &photo.sha256, &side_px.to_string()]);
            seen.preview_jpeg = self.kept(key, |_| Ok(preview::jpeg(&mut pictures, side_px)?))?;
        }
        Ok((seen, place))
    }

    fn tags(&mut self, photo: &Photo) -> Result<Vec<SeenTag>, Stop> {
        let key = self.key(&["tags", &photo.sha256, &format!("{:?}", self.families)]);
        self.kept(key, |own| Ok(own.tags.find(&photo.luma()?)))
    }

    fn detections(&mut self, index: usize, job: &Job, pictures: &mut Pictures) -> Result<Vec<Detection>, Stop> {
        let contestant = &self.contestants[index];
        let weights = match &contestant.source {
            Source::Live(weights) => weights,
            Source::Recorded(recordings) => {
                let found = recordings.iter().find_map(|r| r.of_photo(&pictures.file.sha256));
                let not_recorded = || ScoreError::NotRecorded {
                    file: job.entry.file.clone(),
                    detector: contestant.manifest.name.clone(),
                };
                return Ok(found.ok_or_else(not_recorded).map_err(Stop::Run)?.to_vec());
            }
        };
        let manifest = &contestant.manifest;
        let read = format!("{:?} {:?} {:?}", manifest.input, manifest.head, manifest.labels);
        let key = self.key(&["detections", &pictures.file.sha256, &manifest.weights.sha256, &read]);
        self.kept(key, |own| {
            let (width, height) = (pictures.file.width, pictures.file.height);
            let picture = pictures.at_least(manifest.least_px(width, height))?;
            let detector = own.detector(index, weights).map_err(|e| Stop::Run(e.into()))?;
            detector.detect_reduced(picture, width, height).map_err(|e| match e {
                DetectError::NotANumber { .. } => Stop::Photo(e.to_string()),
                e => Stop::Run(e.into()),
            })
        })
    }

    fn detector(&mut self, index: usize, weights: &std::path::Path) -> Result<&mut Detector, DetectError> {
        let opened = match self.detectors[index].take() {
            Some(detector) => detector,
            None => {
                let runtime = match self.runtime {
                    Some(runtime) => runtime,
                    None => Runtime::load()?,
                };
                Detector::open(runtime, &self.contestants[index].manifest, weights)?
            }
        };
        Ok(self.detectors[index].insert(opened))
    }

    fn key(&self, parts: &[&str]) -> Option<Key> {
        self.cache.map(|cache| cache.key(parts))
    }

    /// What the cache has under a key, else what `compute` gives, which is then kept.
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

/// The colours of a photo at the sizes that somebody asked for.
pub(super) struct Pictures<'a> {
    pub file: &'a Photo,
    /// With how much smaller each is.
    decoded: Vec<(u32, RgbImage)>,
}

impl Pictures<'_> {
    fn of(file: &Photo) -> Pictures<'_> {
        Pictures {
            file,
            decoded: Vec::new(),
        }
    }

    /// The photo, reduced as far as `least` (width, height) allows. Nothing else decides, so that every detector sees the same
    /// picture whichever others take part.
    pub fn at_least(&mut self, least: [u32; 2]) -> Result<&RgbImage, PhotoError> {
        let reduction = self.file.reduction(least);
        let at = match self.decoded.iter().position(|(r, _)| *r == reduction) {
            Some(at) => at,
            None => {
                self.decoded.push((reduction, self.file.rgb(reduction)?));
                self.decoded.len() - 1
            }
        };
        Ok(&self.decoded[at].1)
    }
}
