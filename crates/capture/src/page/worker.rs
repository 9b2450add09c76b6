//! The one place that touches the capture: frames of the source, uploads and buttons come to it one after the other.

use std::collections::BTreeSet;
use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use tokio::sync::{OwnedSemaphorePermit, oneshot, watch};

use super::dial::DialRings;
use super::state::{self, CaptureInfo, FilmedView, PageState, PairsSoFar, ShownFrame};
use super::{PageError, ground, upload};
use crate::{
    CameraSettings, Capture, FrameAnswer, FrameSource, Guidance, SourceError, SourceFrame, StoreError, Taking,
};
use scaleproof_pose::scene::{Bin, Scene};

/// What comes to the worker.
pub(super) enum WorkerEvent {
    /// With what the camera was set to, if it is one.
    Frame(Result<Option<(SourceFrame, Option<CameraSettings>)>, SourceError>),
    /// What a browser asks for.
    Asked(Action, ReplySender),
    Finish,
}

/// What a browser may ask of the capture.
pub(super) enum Action {
    /// A photo's bytes, and the place in memory they take until they are judged.
    Upload(Vec<u8>, OwnedSemaphorePermit),
    /// A picture of what the device with this number films.
    Filmed {
        device: u32,
        kind: FilmKind,
        after_ms: u32,
        bytes: Vec<u8>,
        place: OwnedSemaphorePermit,
    },
    /// Take the newest frame by hand.
    Shoot,
    Undo,
    /// Of the sector with this index.
    Redo(usize),
}

/// A picture of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum FilmKind {
    /// Small and quickly sent; never taken.
    Preview,
    /// Of the size of the film.
    Whole,
}

/// After so long without a picture of the device that films, another may.
const FILMING: Duration = Duration::from_secs(2);

pub(super) type ReplySender = oneshot::Sender<ActionReply>;

/// The reply to a browser's request.
#[derive(Debug, Serialize)]
pub(super) struct ActionReply {
    #[serde(skip)]
    pub status: StatusCode,
    pub sentence: String,
    /// As in the terminal's JSON; absent for buttons.
    pub code: Option<&'static str>,
    pub photo: Option<String>,
    /// Of a film, whether the next picture should be a whole one.
    pub wants_whole: bool,
}

impl ActionReply {
    /// To a button, or that a photo is not taken.
    pub(super) fn new(status: StatusCode, sentence: impl Into<String>) -> ActionReply {
        ActionReply {
            status,
            sentence: sentence.into(),
            code: None,
            photo: None,
            wants_whole: false,
        }
    }
}

/// What browsers can see now. The newest replaces all older ones: whoever asks late misses some and waits for none.
#[derive(Default)]
pub(super) struct Published {
    pub revision: u64,
    pub json: Bytes,
    pub frame: Option<Arc<NewestFrame>>,
    /// Names of the photos that may be requested.
    pub photos: Vec<String>,
    pub has_ended: bool,
}

/// The newest frame.
pub(super) struct NewestFrame {
    pub number: u64,
    pub frame: Arc<SourceFrame>,
    /// A small picture of a film, which is not taken by hand either.
    pub is_preview: bool,
}

/// What the terminal reports.
pub enum CaptureNotice<'a> {
    Seen {
        frame: &'a str,
        answer: &'a FrameAnswer,
        guidance: &'a Guidance,
        /// One of many a second.
        is_filmed: bool,
    },
    TakenBack {
        photo: &'a str,
    },
    /// What the camera is set to now.
    Set(&'a CameraSettings),
}

/// Asks what the pairs say so far; an error ends the capture.
pub type AskPairs<'a> = &'a dyn Fn(&Guidance) -> Result<PairsSoFar, Box<dyn std::error::Error>>;

pub(super) struct CaptureWorker<'a> {
    capture: &'a mut Capture,
    scene: &'a Scene,
    about: &'a CaptureInfo,
    published: &'a watch::Sender<Arc<Published>>,
    notify: &'a mut dyn FnMut(CaptureNotice) -> io::Result<()>,
    rings: DialRings,
    bins: Vec<Bin>,
    /// Targets whose photo was taken back.
    redo: BTreeSet<usize>,
    shown: Option<ShownFrame>,
    newest: Option<Arc<NewestFrame>>,
    frames: u64,
    uploads: u64,
    /// The device that films, and when it was heard last.
    filming: Option<(u32, Instant)>,
    source_ended: bool,
    settings: Option<CameraSettings>,
    ask: Option<AskPairs<'a>>,
    pairs: Option<PairsSoFar>,
}

impl<'a> CaptureWorker<'a> {
    pub(super) fn new(
        capture: &'a mut Capture,
        scene: &'a Scene,
        about: &'a CaptureInfo,
        published: &'a watch::Sender<Arc<Published>>,
        notify: &'a mut dyn FnMut(CaptureNotice) -> io::Result<()>,
        ask: Option<AskPairs<'a>>,
    ) -> CaptureWorker<'a> {
        let bins = state::bins(capture.guidance());
        CaptureWorker {
            capture,
            scene,
            about,
            published,
            notify,
            rings: DialRings::of_bins(&bins),
            bins,
            redo: BTreeSet::new(),
            shown: None,
            newest: None,
            frames: 0,
            uploads: 0,
            filming: None,
            source_ended: false,
            settings: None,
            ask,
            pairs: None,
        }
    }

    /// Works until somebody finishes, or what keeps the capture from going on. Whether the pairs have decided.
    pub(super) fn work(
        &mut self,
        events: &Receiver<WorkerEvent>,
        own: Sender<WorkerEvent>,
        source: Option<Box<dyn FrameSource + Send>>,
    ) -> Result<bool, PageError> {
        let worked = self.work_through(events, own, source);
        let last_words = match &worked {
            Ok(()) => {
                let (filled, all) = (self.filled().len(), self.capture.guidance().targets().len());
                let decided = if self.is_decided() { "Decided: " } else { "" };
                format!("{decided}{filled} of {all} views are there. This page can be closed.")
            }
            Err(e) => format!("The capture has ended: {e}"),
        };
        self.publish(Some(&last_words));
        worked.map(|()| self.is_decided())
    }

    fn work_through(
        &mut self,
        events: &Receiver<WorkerEvent>,
        own: Sender<WorkerEvent>,
        source: Option<Box<dyn FrameSource + Send>>,
    ) -> Result<(), PageError> {
        self.ask_pairs()?;
        self.publish(None);
        let mut wants_frame = source.map(|source| spawn_reader(source, own));
        // A frame that nobody looks at as long as no photo is needed.
        let mut held = None;
        while let Ok(event) = events.recv() {
            match event {
                WorkerEvent::Finish => break,
                WorkerEvent::Frame(Err(e)) => return Err(e.into()),
                WorkerEvent::Frame(Ok(None)) => {
                    self.source_ended = true;
                    wants_frame = None;
                    self.publish(None);
                }
                WorkerEvent::Frame(Ok(Some(frame))) => held = Some(frame),
                WorkerEvent::Asked(action, reply) => {
                    let answer = self.act(action)?;
                    // Published first: who has the answer and asks for the state sees what the answer speaks of.
                    self.publish(None);
                    let _ = reply.send(answer); // a browser that has left needs no answer
                }
            }
            if let Some((frame, settings)) = held.take_if(|_| !self.is_decided()) {
                self.set(settings)?;
                self.judge(frame.into(), Taking::ByItself, None)?;
                self.publish(None);
                // Asked for only now, so that none waits here and grows old.
                if let Some(more) = &wants_frame {
                    let _ = more.try_send(()); // the source takes what is asked
                }
            }
        }
        Ok(())
    }

    fn act(&mut self, action: Action) -> Result<ActionReply, PageError> {
        let refused = |sentence: &str| Ok(ActionReply::new(StatusCode::CONFLICT, sentence));
        match action {
            // A running camera's calibration does not fit a phone's photos.
            Action::Upload(..) | Action::Filmed { .. } if self.about.is_stream => {
                refused("The running camera takes the photos")
            }
            Action::Upload(..) | Action::Filmed { .. } | Action::Shoot if self.is_decided() => {
                refused("It is decided, and no photo is needed: press Finish")
            }
            Action::Upload(bytes, _place) => {
                self.uploads += 1;
                let frame = upload::frame(format!("upload {}", self.uploads), bytes);
                self.judge(frame.into(), Taking::ByItself, None)
            }
            Action::Filmed { device, .. } if self.films_elsewhere(device) => {
                refused("Another device is filming: end it there first")
            }
            Action::Filmed {
                device,
                kind,
                after_ms,
                bytes,
                place: _place,
            } => {
                self.filming = Some((device, Instant::now()));
                let frame = upload::frame(format!("film {}", self.frames + 1), bytes);
                match kind {
                    FilmKind::Preview => self.judge(frame.into(), Taking::Never, Some((device, after_ms))),
                    FilmKind::Whole => {
                        let whole = upload::whole_frame(frame, self.capture.camera());
                        self.judge(whole.into(), Taking::ByItself, Some((device, after_ms)))
                    }
                }
            }
            Action::Shoot => match self.newest.clone() {
                Some(newest) if newest.is_preview => refused("A device is filming: take the photo there"),
                Some(newest) => self.judge(newest.frame.clone(), Taking::ByHand, None),
                None => refused("There is no photo yet"),
            },
            Action::Undo => self.taken_back(|capture| Ok(capture.undo()?.into_iter().collect())),
            Action::Redo(sector) => {
                let (scene, bin) = (self.scene, self.bins.get(sector).copied());
                self.taken_back(|capture| capture.redo(scene, |other| Some(*other) == bin))
            }
        }
    }

    fn set(&mut self, settings: Option<CameraSettings>) -> Result<(), PageError> {
        if settings != self.settings {
            if let Some(settings) = &settings {
                (self.notify)(CaptureNotice::Set(settings)).map_err(PageError::Output)?;
            }
            self.capture.set_camera_settings(settings.clone());
            self.settings = settings;
        }
        Ok(())
    }

    /// Whether another device than this one films now.
    fn films_elsewhere(&self, device: u32) -> bool {
        (self.filming).is_some_and(|(filming, heard)| filming != device && heard.elapsed() < FILMING)
    }

    /// What is drawn over the picture that a device films.
    fn filmed_view(&self, device: u32, answer: &FrameAnswer) -> FilmedView {
        let [width, height] = answer.size_px;
        let camera = self.capture.camera().for_photo(width, height, 0).ok();
        let bins = (&*self.bins, self.capture.guidance().azimuth_step_deg(), &self.rings);
        let seen = answer.pose.as_ref().zip(camera);
        let ground_px = seen.map(|(pose, fitted)| ground::outlines_px(bins, self.scene, &fitted.camera, pose));
        FilmedView {
            device,
            ground_px: ground_px.unwrap_or_default(),
        }
    }

    /// Shows the capture a frame, which the device of this number films so many ms after the last, if one does.
    fn judge(
        &mut self,
        frame: Arc<SourceFrame>,
        taking: Taking,
        film: Option<(u32, u32)>,
    ) -> Result<ActionReply, PageError> {
        let (answer, wants_whole) = match film {
            Some((_, after_ms)) => self.capture.filmed(&frame, taking, after_ms)?,
            None => (self.capture.look(&frame, taking)?, false),
        };
        let film = film.map(|(device, _)| self.filmed_view(device, &answer));
        let is_filmed = film.is_some();
        let guidance = self.capture.guidance();
        self.frames += 1;
        let (number, is_stream) = (self.frames, self.about.is_stream || is_filmed);
        let mut shown = ShownFrame::new((number, &frame.name), &answer, guidance, &self.rings, is_stream);
        shown.film = film;
        let news = CaptureNotice::Seen {
            frame: &frame.name,
            answer: &answer,
            guidance,
            is_filmed,
        };
        (self.notify)(news).map_err(PageError::Output)?;
        self.redo.retain(|target| guidance.targets()[*target].photo.is_none());
        if shown.photo.is_some() {
            self.ask_pairs()?;
        }
        let response = ActionReply {
            status: match shown.photo {
                // Most frames of a film are not taken, and are not at fault.
                None if !is_filmed || shown.size_px == [0, 0] => StatusCode::UNPROCESSABLE_ENTITY,
                _ => StatusCode::OK,
            },
            sentence: shown.advice.clone(),
            code: Some(shown.code),
            photo: shown.photo.clone(),
            wants_whole,
        };
        let is_preview = taking == Taking::Never;
        self.shown = Some(shown);
        self.newest = Some(Arc::new(NewestFrame {
            number,
            frame,
            is_preview,
        }));
        Ok(response)
    }

    /// Targets that have a photo.
    fn filled(&self) -> BTreeSet<usize> {
        let targets = self.capture.guidance().targets();
        let filled = (0..targets.len()).filter(|index| targets[*index].photo.is_some());
        filled.collect()
    }

    /// Takes photos back; `take_back` returns their names.
    fn taken_back(
        &mut self,
        take_back: impl FnOnce(&mut Capture) -> Result<Vec<String>, StoreError>,
    ) -> Result<ActionReply, PageError> {
        let before = self.filled();
        let photos = take_back(self.capture)?;
        for photo in &photos {
            (self.notify)(CaptureNotice::TakenBack { photo }).map_err(PageError::Output)?;
        }
        self.redo.extend(before.difference(&self.filled()));
        self.ask_pairs()?;
        let sentence = if photos.is_empty() {
            "There is no photo to take back".into()
        } else {
            format!("Taken back: {}", photos.join(", "))
        };
        // What was said of the newest frame may be true no longer.
        if let Some(shown) = &mut self.shown {
            shown.advice.clone_from(&sentence);
            shown.photo = None;
        }
        Ok(ActionReply::new(StatusCode::OK, sentence))
    }

    /// Looks at the pairs that are there now.
    fn ask_pairs(&mut self) -> Result<(), PageError> {
        if let Some(ask) = self.ask {
            self.pairs = Some(ask(self.capture.guidance()).map_err(PageError::Pairs)?);
        }
        Ok(())
    }

    fn is_decided(&self) -> bool {
        self.pairs.as_ref().is_some_and(|pairs| pairs.is_decided)
    }

    /// The view that is required next.
    fn next(&self) -> Option<usize> {
        if self.is_decided() {
            return None;
        }
        let tells_most = self.pairs.as_ref().and_then(|pairs| pairs.next);
        tells_most.or_else(|| {
            let shown = self.shown.as_ref()?;
            self.capture.guidance().nearest_open(&shown.viewpoint?)
        })
    }

    fn publish(&self, ended: Option<&str>) {
        let guidance = self.capture.guidance();
        let revision = self.published.borrow().revision + 1;
        let (sectors, views) = state::views(guidance, &self.rings, &self.bins, &self.redo);
        let state = PageState {
            revision,
            about: self.about,
            rings: &self.rings.0,
            sectors,
            filled: views.iter().filter(|view| view.photo.is_some()).count(),
            views,
            frame: self.shown.as_ref(),
            pairs: self.pairs.as_ref(),
            next: self.next(),
            source_ended: self.source_ended,
            ended,
        };
        let photos = guidance.targets().iter().filter_map(|target| target.photo.clone());
        self.published.send_replace(Arc::new(Published {
            revision,
            // Numbers and strings always serialise.
            json: serde_json::to_vec(&state).unwrap_or_default().into(),
            frame: self.newest.clone(),
            photos: photos.collect(),
            has_ended: ended.is_some(),
        }));
    }
}

/// Starts a thread that reads one frame of a source for each request, the first at once. Of a source that blocks forever the thread is
/// abandoned when the program ends.
fn spawn_reader(mut source: Box<dyn FrameSource + Send>, events: Sender<WorkerEvent>) -> SyncSender<()> {
    let (request, requests) = sync_channel(1);
    let _ = request.try_send(()); // the channel is empty
    std::thread::spawn(move || {
        while requests.recv().is_ok() {
            let next = source.next().map(|frame| frame.map(|frame| (frame, source.settings())));
            let is_last = !matches!(next, Ok(Some(_)));
            if events.send(WorkerEvent::Frame(next)).is_err() || is_last {
                break;
            }
        }
    });
    request
}
