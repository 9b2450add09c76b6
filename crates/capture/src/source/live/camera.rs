//! A running camera: a thread reads it without pause and keeps the newest image only, so that advice is never about the past.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::device::Device;
use super::error::LiveCameraError;
use super::pixels::RawImage;
use super::settings::CameraSettings;
use super::system;
use crate::source::{FrameSource, Original, SourceError, SourceFrame};
use scaleproof_core::message::message;
use scaleproof_pose::camera::Camera;

/// Time without an image after which a camera counts as gone.
const PATIENCE: Duration = Duration::from_secs(5);

/// Time in which a camera must open; some drivers wait for ever for a device that hangs. Where the system asks a
/// person first, that takes its time, too.
const OPENING: Duration = Duration::from_secs(if cfg!(target_os = "macos") { 75 } else { 15 });

/// Maximum number of failures in a row, this far apart; a single image may fail.
const MAX_FAILURES: u32 = 10;
const AFTER_FAILURE: Duration = Duration::from_millis(100);

/// Name of a running camera, for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LiveName {
    /// A camera of this machine.
    Number(u32),
    /// A stream, by its address without passwords.
    Stream(String),
}

impl LiveName {
    fn unusable(&self, reason: &LiveCameraError) -> SourceError {
        match self {
            LiveName::Number(number) => message!("the camera {number} cannot be used ({reason})")
                .hint("see `scaleproof capture list-cameras`")
                .into(),
            LiveName::Stream(address) => message!(
                "the stream {address} cannot be used ({reason}): see that the camera serves it and that a browser or player shows it"
            )
            .into(),
        }
    }

    fn gone(&self, reason: &LiveCameraError) -> SourceError {
        let (name, remedy) = match self {
            LiveName::Number(number) => (format!("camera {number}"), "plug it in again"),
            LiveName::Stream(address) => (format!("stream {address}"), "see to the camera"),
        };
        message!("the {name} gives no more images ({reason}): {remedy} and run this again; what was accepted is kept")
            .into()
    }

    fn frame(&self, count: u64) -> String {
        match self {
            LiveName::Number(number) => format!("camera {number} image {count}"),
            LiveName::Stream(_) => format!("stream image {count}"),
        }
    }
}

/// The frames of a running camera, the newest one each time it is asked.
pub struct LiveCamera {
    name: LiveName,
    /// Time without an image after which the camera counts as gone.
    patience: Duration,
    shared: Arc<SharedState>,
}

/// State that the reading thread and the judging thread share.
#[derive(Default)]
struct SharedState {
    state: Mutex<ReaderState>,
    changed: Condvar,
    /// True once nobody requests frames any more.
    is_left: AtomicBool,
}

#[derive(Default)]
struct ReaderState {
    is_open: bool,
    /// Number since the camera was opened, and the image, or the reason why there is none at the moment. A newer one replaces it.
    newest: Option<(u64, Result<RawImage, LiveCameraError>)>,
    settings: Option<CameraSettings>,
    /// Reason why no more will come.
    ended: Option<LiveCameraError>,
}

impl LiveCamera {
    /// Opens the camera of a number at an image size that `camera` fits: the calibrated one if it has it.
    ///
    /// # Errors
    /// No such camera, one that is in use or may not be used, or that has no image of the camera file's shape.
    pub fn open(number: u32, camera: &Camera) -> Result<LiveCamera, SourceError> {
        let camera = camera.clone();
        LiveCamera::from_device(number, OPENING, move || system::open(number, &camera))
    }

    /// Starts a camera of any make; `open` is called on the thread that reads it, and may take up to `limit`.
    ///
    /// # Errors
    /// The error of `open`, or that it took longer.
    pub fn from_device(
        number: u32,
        limit: Duration,
        open: impl FnOnce() -> Result<Box<dyn Device>, LiveCameraError> + Send + 'static,
    ) -> Result<LiveCamera, SourceError> {
        LiveCamera::start(LiveName::Number(number), limit, PATIENCE, open)
    }

    /// Starts whatever gives images one after the other, as [`LiveCamera::from_device`]; without an image for `patience` it is gone.
    ///
    /// # Errors
    /// As [`LiveCamera::from_device`].
    pub fn start(
        name: LiveName,
        limit: Duration,
        patience: Duration,
        open: impl FnOnce() -> Result<Box<dyn Device>, LiveCameraError> + Send + 'static,
    ) -> Result<LiveCamera, SourceError> {
        let shared = Arc::new(SharedState::default());
        let reading = ReaderThread(Arc::clone(&shared));
        std::thread::spawn(move || reading.read(open));
        let seconds = limit.as_secs();
        let too_late = LiveCameraError::Failed(match &name {
            LiveName::Stream(_) => format!("none came for {seconds} s"),
            LiveName::Number(_) => format!("it did not open within {seconds} s: unplug it and plug it in again"),
        });
        let opened = shared.wait(limit, too_late, |state| state.is_open.then_some(()));
        opened.map_err(|reason| name.unusable(&reason))?;
        Ok(LiveCamera { name, patience, shared })
    }
}

impl FrameSource for LiveCamera {
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError> {
        let seconds = self.patience.as_secs();
        // The image that came last, if it was not given before.
        let too_late = LiveCameraError::Failed(format!("none came for {seconds} s"));
        let newest = self.shared.wait(self.patience, too_late, |state| state.newest.take());
        let (count, image) = newest.map_err(|reason| self.name.gone(&reason))?;
        let original = image
            .map_err(|reason| reason.to_string())
            .and_then(|image| image.original().map_err(str::to_owned))
            .unwrap_or_else(Original::Unreadable);
        Ok(Some(SourceFrame::untimed(self.name.frame(count), original)))
    }

    fn is_stream(&self) -> bool {
        true
    }

    fn settings(&self) -> Option<CameraSettings> {
        self.shared.locked().settings.clone()
    }
}

impl Drop for LiveCamera {
    fn drop(&mut self) {
        self.shared.is_left.store(true, Ordering::Relaxed);
    }
}

impl SharedState {
    /// Locks the state, which a failed thread leaves whole: every change is one assignment.
    fn locked(&self) -> MutexGuard<'_, ReaderState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until `take` takes something from the state; else returns the reason why it never will, or `too_late`.
    fn wait<T>(
        &self,
        limit: Duration,
        too_late: LiveCameraError,
        mut take: impl FnMut(&mut ReaderState) -> Option<T>,
    ) -> Result<T, LiveCameraError> {
        let mut found = None;
        let is_missing = |state: &mut ReaderState| {
            found = take(state);
            found.is_none() && state.ended.is_none()
        };
        let waited = self.changed.wait_timeout_while(self.locked(), limit, is_missing);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        found.ok_or_else(|| state.ended.clone().unwrap_or(too_late))
    }

    fn change(&self, change: impl FnOnce(&mut ReaderState)) {
        change(&mut self.locked());
        self.changed.notify_all();
    }
}

/// Reading thread. However it ends, the state says so.
struct ReaderThread(Arc<SharedState>);

impl ReaderThread {
    fn read(self, open: impl FnOnce() -> Result<Box<dyn Device>, LiveCameraError>) {
        let shared = &self.0;
        let end = |reason: LiveCameraError| shared.change(|state| state.ended = Some(reason));
        let mut device = match open() {
            Ok(device) => device,
            Err(reason) => return end(reason),
        };
        shared.change(|state| state.is_open = true);
        let (since, mut is_locked) = (Instant::now(), false);
        let (mut count, mut failures) = (0, 0);
        while !shared.is_left.load(Ordering::Relaxed) {
            match device.image() {
                Ok(image) => {
                    (count, failures) = (count + 1, 0);
                    if !is_locked && since.elapsed() >= device.settling() {
                        is_locked = true;
                        let settings = device.lock();
                        shared.change(|state| state.settings = Some(settings));
                    } else if is_locked {
                        shared.change(|state| state.newest = Some((count, Ok(image))));
                    }
                }
                Err(reason @ LiveCameraError::Waiting(_)) => {
                    shared.change(|state| state.newest = Some((count, Err(reason))));
                }
                Err(reason @ LiveCameraError::Ended(_)) => return end(reason),
                Err(reason) if failures + 1 == MAX_FAILURES => return end(reason),
                Err(_) => {
                    failures += 1;
                    std::thread::sleep(AFTER_FAILURE);
                }
            }
        }
    }
}

impl Drop for ReaderThread {
    fn drop(&mut self) {
        // Only a driver's panic leaves it open.
        self.0.change(|state| {
            let failed = || LiveCameraError::Failed("its driver failed".into());
            state.ended.get_or_insert_with(failed);
        });
    }
}
