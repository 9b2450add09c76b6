//! From a video to photos of a session: files are read, frames are looked at, the chosen ones are written, and the session lists them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::cache::FrameCache;
use crate::choose::{Refusal, SelectionCriteria, count_refusals};
use crate::keep::{KeepError, PhotosOf, SavedFrame};
use crate::pairs::TargetViews;
use crate::tracking::FrameResult;
use crate::walk::{TrackError, Walk, open_video, usual_step};
use crate::{cause, coverage, sheet};
use scaleproof_capture::slug;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail};
use scaleproof_core::spelling::count;
use scaleproof_pose::camera::{Camera, CameraError};
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::{StartError, TagDetectorChoice};
use scaleproof_session::filling::{self, FillingError};
use scaleproof_session::folders::{self, PhotoFolder};
use scaleproof_session::{NewSession, PhotoEntry, Session, SessionError};
use scaleproof_video::{Selection, VideoError};

/// A video that is to become photos of a session.
pub struct FilmRequest {
    pub video: PathBuf,
    pub scene: PathBuf,
    pub camera: PathBuf,
    pub variant: String,
    pub place: String,
    /// Folder of the session; made where it is missing.
    pub folder: PathBuf,
    /// The session that is in the folder already.
    pub session: Option<Session>,
    /// Frames of each bin.
    pub per_bin: usize,
    /// Shortest time between two frames of one bin, s.
    pub apart_s: f64,
    /// Part of the video, s.
    pub from_s: f64,
    pub to_s: Option<f64>,
    /// Step in frames: every Nth one is looked at; by default the step that leaves about 30 a second.
    pub every: Option<u64>,
    /// PNG instead of JPEG.
    pub png: bool,
}

/// A video and all that is read before a frame is looked at.
pub struct Film {
    pub request: FilmRequest,
    pub walk: Walk,
    /// Frames that are looked at.
    pub part: Selection,
    /// SHA-256 of the session's list; `None` without a session.
    list: Option<String>,
}

/// A session with the photos of a film, and what became of the film's frames.
pub struct Filmed {
    /// Path of `session.json`.
    pub file: PathBuf,
    /// All photos of the session.
    pub photos: Vec<PhotoEntry>,
    /// Folder of the film's photos, by its name in the session.
    pub inside: String,
    /// Every frame that was looked at.
    pub looks: Vec<FrameResult>,
    /// Frames that could not be chosen, by reason.
    pub refused: BTreeMap<Refusal, usize>,
    /// Frames that are photos now.
    pub kept: Vec<SavedFrame>,
    pub contact_sheet: PathBuf,
    pub coverage: PathBuf,
}

/// Reason why a film gave no photos.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    #[error("stopped: no photo was kept")]
    Interrupted,
    #[error(transparent)]
    Failed(Box<dyn std::error::Error + Send + Sync>),
}

/// Converts whatever else fails.
macro_rules! failed {
    ($($error:ty),+) => {
        $(impl From<$error> for FilmError {
            fn from(e: $error) -> FilmError {
                FilmError::Failed(e.into())
            }
        })+
    };
}
failed!(
    Message,
    CameraError,
    FileError,
    FillingError,
    SessionError,
    StartError,
    VideoError
);

impl From<KeepError> for FilmError {
    fn from(e: KeepError) -> FilmError {
        match e {
            KeepError::Interrupted => FilmError::Interrupted,
            other => FilmError::Failed(other.into()),
        }
    }
}

impl From<TrackError> for FilmError {
    fn from(e: TrackError) -> FilmError {
        match e {
            TrackError::Interrupted => FilmError::Interrupted,
            other => FilmError::Failed(other.into()),
        }
    }
}

/// Step of a film's way into a session, with a progress of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmStep {
    Looking,
    Keeping,
}

/// Callback after each frame: the step, the frames done and their expected number; returns false to stop.
pub type FilmProgress<'a> = &'a mut dyn FnMut(FilmStep, usize, usize) -> bool;

impl FilmRequest {
    /// Reads all files but the frames.
    ///
    /// # Errors
    /// A file that cannot be read; a video that the camera file does not fit, or that the session has photos of already; no tag detector.
    pub fn open(self) -> Result<Film, FilmError> {
        let list = hash_of_list(&self.folder)?;
        let (scene, camera) = (Scene::open(&self.scene)?, Camera::open(&self.camera)?);
        let state = files::FileState::of(&self.video)?;
        let video = open_video(&self.video, &camera)?;
        let sha256 = files::sha256_of_file(&self.video)?;
        let targets = match &self.session {
            Some(session) => {
                self.refuse_twice(session, &sha256)?;
                TargetViews::of(session, &self.variant, &self.place, TagDetectorChoice::default())?
            }
            None => TargetViews::default(),
        };
        let part = Selection {
            from_s: self.from_s,
            to_s: self.to_s,
            every: self.every.unwrap_or_else(|| usual_step(&video)),
            ..Selection::default()
        };
        let walk = Walk {
            name: files::name_of(&self.video),
            video,
            sha256,
            state,
            scene,
            camera,
            targets,
        };
        Ok(Film {
            request: self,
            walk,
            part,
            list,
        })
    }

    /// Refuses a video that the session has photos of: each photo counts once.
    fn refuse_twice(&self, session: &Session, sha256: &str) -> Result<(), Message> {
        let is_it = |photo: &&PhotoEntry| photo.frame.as_ref().is_some_and(|frame| frame.sha256 == sha256);
        let Some(photo) = session.photos.iter().find(is_it) else {
            return Ok(());
        };
        let (folder, video) = (self.folder.display(), self.video.display());
        bail!(
            "{folder} has frames of {video} already, as {}: name a new session",
            photo.file
        )
    }
}

fn hash_of_list(session: &Path) -> Result<Option<String>, FileError> {
    let list = session.join("session.json");
    list.exists().then(|| files::sha256_of_file(&list)).transpose()
}

impl Film {
    /// Looks at the frames, chooses, and writes the session with the pictures beside its photos; all of it or nothing.
    ///
    /// # Errors
    /// No frame can be chosen; the video breaks off; another run fills the session; a file cannot be written; `progress` returns false.
    pub fn to_session(&self, progress: FilmProgress) -> Result<Filmed, FilmError> {
        let folder = &self.request.folder;
        let had_folder = folder.exists();
        files::make_named_folder(folder)?;
        let lock = filling::locked(folder)?;
        let made = self.refuse_if_changed().and_then(|()| self.make(progress));
        // Also that of a run that was killed; a capture makes its own again.
        let _ = files::chosen::remove(folder, &folder.join(filling::MARK));
        if !had_folder {
            files::remove_if_empty(folder);
        }
        drop(lock);
        made
    }

    /// Refuses a session that another run has filled between the reading of it and the lock on it.
    fn refuse_if_changed(&self) -> Result<(), FilmError> {
        let folder = &self.request.folder;
        if hash_of_list(folder)? == self.list {
            return Ok(());
        }
        bail!(
            "{} was filled by another run just now: call this again",
            folder.display()
        )
    }

    fn make(&self, progress: FilmProgress) -> Result<Filmed, FilmError> {
        let (request, walk) = (&self.request, &self.walk);
        let criteria = walk.criteria(request.per_bin, request.apart_s);
        let (looks, held) = self.look(&criteria, progress)?;
        let folder = folder_name(&slug(&request.variant), &slug(&stem(&walk.name)));
        let folder = files::free_place(&request.folder.join(folder));
        let kept = self.keep(&looks, &criteria, &held, &folder, progress)?;
        if kept.is_empty() {
            let why = self.why_none(&criteria, &looks);
            let cause = cause::common_cause(walk, &looks, [&request.scene, &request.camera]);
            return Err(Message::new(cause.map_or(why.clone(), |cause| format!("{why}: {cause}"))).into());
        }
        let made = self.write(looks, &criteria, &folder, kept);
        if made.is_err() {
            // Photos that no list names would be taken for photos of nobody knows what.
            let _ = files::chosen::remove_folder(&request.folder, &folder);
            for picture in pictures(&folder) {
                let _ = files::chosen::remove(&request.folder, &picture);
            }
        }
        made
    }

    fn look(
        &self,
        criteria: &SelectionCriteria,
        progress: FilmProgress,
    ) -> Result<(Vec<FrameResult>, FrameCache), FilmError> {
        let all = self.walk.expected(&self.part);
        let looked = |looks: &[FrameResult]| progress(FilmStep::Looking, looks.len(), all);
        let (looks, held) = self.walk.track(&self.part, criteria, looked)?;
        if looks.is_empty() {
            let request = &self.request;
            let to = request.to_s.map_or(String::new(), |to| format!(" and before {to} s"));
            bail!(
                "{} has no frame after {} s{to}",
                request.video.display(),
                request.from_s
            );
        }
        Ok((looks, held))
    }

    /// Writes the chosen frames into a folder of the session.
    fn keep(
        &self,
        looks: &[FrameResult],
        criteria: &SelectionCriteria,
        held: &FrameCache,
        folder: &Path,
        progress: FilmProgress,
    ) -> Result<Vec<SavedFrame>, FilmError> {
        let (mut done, all) = (0, self.walk.choose(looks, criteria).len());
        let goes_on = || {
            done += 1;
            progress(FilmStep::Keeping, done, all)
        };
        let photos = PhotosOf {
            variant: &self.request.variant,
            place: &self.request.place,
            png: self.request.png,
        };
        Ok(self.walk.keep(photos, looks, criteria, held, folder, goes_on)?)
    }

    /// Returns the reason why no frame was chosen, and what to do.
    fn why_none(&self, criteria: &SelectionCriteria, looks: &[FrameResult]) -> String {
        let video = self.request.video.display();
        let refused = count_refusals(criteria, looks);
        let reasons: Vec<String> = refused
            .iter()
            .map(|(why, count)| format!("{} {count}", why.name()))
            .collect();
        if reasons.is_empty() {
            return format!(
                "{video}: no frame is near enough to a photo of the session to be its pair: film from the same height and distance"
            );
        }
        format!(
            "{video}: none of {} can be a photo ({}): see the guide, Film instead of photographs",
            count(looks.len(), "frame"),
            reasons.join(", ")
        )
    }

    /// Writes the session and the pictures beside the folder of its photos.
    fn write(
        &self,
        looks: Vec<FrameResult>,
        criteria: &SelectionCriteria,
        folder: &Path,
        kept: Vec<SavedFrame>,
    ) -> Result<Filmed, FilmError> {
        let (request, walk) = (&self.request, &self.walk);
        let given = PhotoFolder {
            variant: request.variant.clone(),
            place: Some(request.place.clone()),
            folder: folder.to_owned(),
        };
        let mut gathered = folders::gather(&[given], &request.scene, &request.camera, &request.place)?;
        for photo in &mut gathered.session.photos {
            let name = files::name_of(Path::new(&photo.file));
            let own = kept.iter().find(|one| one.file == name);
            photo.frame = own.map(|one| one.frame.clone());
        }
        let [contact_sheet, coverage] = pictures(folder);
        let title = format!("{}: {}", walk.name, request.variant);
        files::replace_all_atomically(
            &request.folder,
            &[
                (&contact_sheet, sheet::png(&kept).unwrap_or_default()),
                (&coverage, coverage::svg(&title, criteria, &looks, &kept).into_bytes()),
            ],
        )?;
        let (file, photos) = NewSession {
            folder: &request.folder,
            photos: &gathered,
            scene: &request.scene,
            camera: &request.camera,
            copy: false,
        }
        .write()?;
        Ok(Filmed {
            file,
            photos,
            inside: files::name_of(folder),
            refused: count_refusals(criteria, &looks),
            looks,
            kept,
            contact_sheet,
            coverage,
        })
    }
}

/// Name of the folder of the photos, by the texture and the video.
fn folder_name(variant: &str, video: &str) -> String {
    if video.starts_with(variant) {
        video.to_owned()
    } else {
        format!("{variant}_{video}")
    }
}

fn stem(name: &str) -> String {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
}

/// Returns the contact sheet and the coverage plot of the photos in a folder, beside it.
fn pictures(photos: &Path) -> [PathBuf; 2] {
    let inside = files::name_of(photos);
    ["contact.png", "coverage.svg"].map(|ending| photos.with_file_name(format!("{inside}.{ending}")))
}
