//! Guided capture from its request to its end: files are read, source and page are opened, the session is opened or made, and every frame is
//! judged.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::interruptible::{Interruptible, OnInterrupt};
use crate::page::{AskPairs, CaptureInfo, CaptureNotice, Page, PageError};
use crate::pair::{self, PairError};
use crate::{
    Capture, FrameSource, Guidance, Judge, LiveCamera, Replay, SourceError, SourceName, Store, StoreError, Tolerance,
    Watch, stream,
};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail};
use scaleproof_pose::camera::{Camera, CameraError};
use scaleproof_pose::scene::{Bins, NoSuchBin, Scene};
use scaleproof_pose::tags::{StartError, TagDetectorChoice};

/// Request for a capture, of a new session or of one that has photos already.
pub struct GuidedRequest {
    pub scene: PathBuf,
    pub camera: PathBuf,
    pub variant: String,
    pub place: String,
    /// Folder of the session.
    pub folder: PathBuf,
    /// Source of frames; `None` only to take photos back.
    pub source: Option<SourceName>,
    pub options: SourceOptions,
    pub views: ViewsRequest,
    pub page: Option<PageRequest>,
}

/// Options of some sources.
#[derive(Debug, Clone, Copy, Default)]
pub struct SourceOptions {
    /// End when all photos of a watched folder were seen.
    pub headless: bool,
    /// Seed of the order of a replay; `None` for that of the session.
    pub shuffle: Option<u64>,
    /// Time between two photos of a replay.
    pub pace: Option<Duration>,
}

/// Views that are required: every azimuth bin at some pitches and distances, or another session's viewpoints.
#[derive(Debug, Clone, Default)]
pub struct ViewsRequest {
    /// Pitches of the scene's bins; empty for the one nearest to 15°.
    pub pitch_deg: Vec<f64>,
    /// Distances of the scene's bins; empty for the middle one.
    pub distance_mm: Vec<f64>,
    /// Session of which the viewpoints of the normal photos are required instead.
    pub pair_with: Option<PathBuf>,
    pub azimuth_tolerance_deg: Option<f64>,
    pub pitch_tolerance_deg: Option<f64>,
    pub distance_tolerance_mm: Option<f64>,
}

/// A page that is to be served.
#[derive(Debug, Clone, Copy)]
pub struct PageRequest {
    /// 0 for any free one.
    pub port: u16,
    /// True if phones in the local network may join.
    pub lan: bool,
}

/// Reason why a capture cannot begin or go on.
#[derive(Debug, thiserror::Error)]
pub enum GuidedError {
    #[error(transparent)]
    Message(#[from] Message),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Bins(#[from] NoSuchBin),
    #[error(transparent)]
    Pair(#[from] PairError),
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Page(#[from] PageError),
}

/// A capture whose files are read and whose source and page are open, before its session is touched.
pub struct OpenedCapture {
    request: GuidedRequest,
    scene: Scene,
    camera: Camera,
    guidance: Guidance,
    judge: Judge,
    source: Option<Box<dyn FrameSource + Send>>,
    page: Option<Page>,
}

/// A capture that frames can be shown to.
pub struct GuidedCapture {
    pub capture: Capture,
    pub scene: Scene,
    /// Page that is served until the capture is followed.
    pub page: Option<Page>,
    /// Facts that the page shows.
    pub info: CaptureInfo,
    source: Option<Box<dyn FrameSource + Send>>,
}

/// End of a capture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CaptureEnd {
    /// The pairs are enough, so that open views are not needed.
    pub is_decided: bool,
    /// The user ended it while it waited for a frame.
    pub was_interrupted: bool,
}

impl GuidedRequest {
    /// Reads the files, and opens the source and the page. `note` hears of photos that give no view. `hurry` is called by the page when the user
    /// interrupts a second time.
    ///
    /// # Errors
    /// A file that cannot be read; views that the scene has no bins for; a source or a page that cannot be opened.
    pub fn open(
        self,
        note: &mut dyn FnMut(&str),
        hurry: impl FnOnce() + Send + 'static,
    ) -> Result<OpenedCapture, GuidedError> {
        self.check_folder()?;
        // The list of photos is written anew at each photo, so reading it does not make it an input.
        files::inputs::own(&self.folder.join("session.json"));
        let (scene, camera) = (Scene::open(&self.scene)?, Camera::open(&self.camera)?);
        let guidance = self.views.guidance(&scene.bins, note)?;
        let source = match &self.source {
            Some(name) => name.open(&self.variant, self.options, &camera)?,
            None => None,
        };
        let is_stream = source.as_ref().is_some_and(|source| source.is_stream());
        let judge = Judge::new(&scene, TagDetectorChoice::default(), is_stream)?;
        let page = self
            .page
            .map(|page| Page::open(page.port, page.lan, &self.folder, hurry));
        Ok(OpenedCapture {
            page: page.transpose()?,
            request: self,
            scene,
            camera,
            guidance,
            judge,
            source,
        })
    }

    /// Nothing is written among the originals.
    fn check_folder(&self) -> Result<(), Message> {
        let same = |folder: &Path| files::is_same(folder, &self.folder);
        if self.source.as_ref().and_then(SourceName::folder).is_some_and(same) {
            bail!(
                "{} is both the source and the session: capture into another folder",
                self.folder.display()
            );
        }
        Ok(())
    }
}

impl SourceName {
    /// Opens the source for photos of a variant; `None` for photos that only browsers send.
    ///
    /// # Errors
    /// A folder, camera or stream that is not there; a session without photos of the variant.
    pub fn open(
        &self,
        variant: &str,
        options: SourceOptions,
        camera: &Camera,
    ) -> Result<Option<Box<dyn FrameSource + Send>>, SourceError> {
        Ok(Some(match self {
            SourceName::Replay(folder) => {
                let pace = options.pace.unwrap_or_default();
                Box::new(Replay::open(folder, variant, options.shuffle, pace)?)
            }
            SourceName::Watch(folder) => Box::new(Watch::open(folder, options.headless)?),
            SourceName::Camera(number) => Box::new(LiveCamera::open(*number, camera)?),
            SourceName::Stream(address) => Box::new(stream::open(address, camera)?),
            SourceName::Upload => return Ok(None),
        }))
    }
}

impl ViewsRequest {
    /// Returns the guidance to the views; photos of the other session that give none are noted.
    fn guidance(&self, bins: &Bins, note: &mut dyn FnMut(&str)) -> Result<Guidance, GuidedError> {
        let (viewpoints, tolerance) = match &self.pair_with {
            Some(session) => {
                let (viewpoints, faults) = pair::viewpoints(session, TagDetectorChoice::default())?;
                faults.iter().for_each(|fault| note(&format!("no target for {fault}")));
                let tolerance = Tolerance::of_pairs(&viewpoints);
                (viewpoints, tolerance)
            }
            None => {
                let views = bins.photographed(&self.pitch_deg, &self.distance_mm)?;
                let distances: Vec<f64> = views.iter().map(|view| view.distance_mm).collect();
                let tolerance = Tolerance::of_bins(bins, &distances);
                (views, tolerance)
            }
        };
        let tolerance = Tolerance {
            azimuth_deg: self.azimuth_tolerance_deg.unwrap_or(tolerance.azimuth_deg),
            pitch_deg: self.pitch_tolerance_deg.unwrap_or(tolerance.pitch_deg),
            distance_mm: self.distance_tolerance_mm.unwrap_or(tolerance.distance_mm),
        };
        Ok(Guidance::at(&viewpoints, tolerance, bins))
    }
}

impl OpenedCapture {
    /// Opens the session, or makes it, and goes on with it.
    ///
    /// # Errors
    /// Another run fills the session; one of another scene or camera; files that cannot be written.
    pub fn begin(self) -> Result<GuidedCapture, GuidedError> {
        let (request, camera) = (self.request, self.camera);
        let (variant, place) = (&request.variant, &request.place);
        let store = Store::open(&request.folder, &request.scene, &request.camera, variant)?;
        let is_stream = self.judge.is_stream();
        let info = CaptureInfo {
            variant: variant.clone(),
            place: place.clone(),
            source: request.source.as_ref().map_or("none", SourceName::kind),
            is_stream,
            is_paired: request.views.pair_with.is_some(),
            camera_px: [camera.width, camera.height],
        };
        let mut capture = Capture::new(self.guidance, self.judge, store, camera, variant, place);
        if self.page.is_some() && !is_stream {
            capture = capture.with_film(Judge::new(&self.scene, TagDetectorChoice::default(), true)?);
        }
        Ok(GuidedCapture {
            capture,
            scene: self.scene,
            page: self.page,
            info,
            source: self.source,
        })
    }
}

impl GuidedCapture {
    /// Shows the capture every frame until all views are there, the pairs have decided, the source ends, or the user interrupts; with a page
    /// also the photos of browsers, until somebody finishes. `ask` says what the pairs say so far, `notify` hears of everything that happens.
    ///
    /// # Errors
    /// The source is gone; a photo cannot be written; the page or its output fails.
    pub fn follow(
        &mut self,
        ask: Option<AskPairs>,
        notify: &mut dyn FnMut(CaptureNotice) -> io::Result<()>,
        on_interrupt: OnInterrupt,
    ) -> Result<CaptureEnd, PageError> {
        match (self.page.take(), self.source.take()) {
            (Some(page), source) => {
                let is_decided = page.follow(&mut self.capture, &self.scene, source, &self.info, ask, notify)?;
                Ok(CaptureEnd {
                    is_decided,
                    ..CaptureEnd::default()
                })
            }
            (None, Some(source)) => self.follow_source(Interruptible::new(source, on_interrupt), ask, notify),
            (None, None) => Ok(CaptureEnd::default()),
        }
    }

    fn follow_source(
        &mut self,
        mut source: Interruptible,
        ask: Option<AskPairs>,
        notify: &mut dyn FnMut(CaptureNotice) -> io::Result<()>,
    ) -> Result<CaptureEnd, PageError> {
        let capture = &mut self.capture;
        let are_enough = |capture: &Capture| -> Result<bool, PageError> {
            let pairs = ask.map(|ask| ask(capture.guidance())).transpose();
            Ok(pairs.map_err(PageError::Pairs)?.is_some_and(|pairs| pairs.is_decided))
        };
        let mut is_decided = are_enough(capture)?;
        let mut settings = None;
        while !is_decided && !capture.guidance().is_finished() {
            let Some((frame, set)) = source.next()? else { break };
            if settings != set {
                settings = set;
                if let Some(settings) = &settings {
                    notify(CaptureNotice::Set(settings)).map_err(PageError::Output)?;
                }
                capture.set_camera_settings(settings.clone());
            }
            let answer = capture.see(&frame)?;
            let seen = CaptureNotice::Seen {
                frame: &frame.name,
                answer: &answer,
                guidance: capture.guidance(),
                is_filmed: false,
            };
            notify(seen).map_err(PageError::Output)?;
            if answer.verdict.is_ok() {
                is_decided = are_enough(capture)?;
            }
        }
        Ok(CaptureEnd {
            is_decided,
            was_interrupted: source.was_interrupted(),
        })
    }
}
