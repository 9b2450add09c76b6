//! A running camera: a thread reads it without pause and keeps the newest image only, so that advice is never about the past.

mod device;
mod error;
mod pixels;
mod settings;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::source::{FrameSource, Original, SourceError, SourceFrame};
use scaleproof_pose::camera::Camera;

pub use device::{choose_format, list_cameras};
pub use error::LiveCameraError;
pub use pixels::{PixelFormat, RawImage};
pub use settings::{CameraSettings, Setting};

/// Exposure, focus and white balance find their values within this time; they are then held, and frames are given from then on.
const SETTLING: Duration = Duration::from_millis(1500);

/// A camera that gives nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(5);

/// A camera that does not open within this time never will; some drivers wait for ever for a device that hangs. Where the system asks a
/// person first, that takes its time, too.
const OPENING: Duration = Duration::from_secs(if cfg!(target_os = "macos") { 75 } else { 15 });

/// A single image may fail; so many in a row, this far apart, mean that the camera is gone.
const MAX_FAILURES: u32 = 10;
const AFTER_FAILURE: Duration = Duration::from_millis(100);

/// What a camera must be able to do. It stays on the thread that opened it.
pub trait Device {
    /// The next image, waited for.
    ///
    /// # Errors
    /// Why there is none.
    fn image(&mut self) -> Result<RawImage, LiveCameraError>;

    /// Holds exposure, focus and white balance where they are now, as far as the camera lets one.
    fn lock(&mut self) -> CameraSettings;
}

/// The frames of a running camera, the newest one each time it is asked.
pub struct LiveCamera {
    number: u32,
    shared: Arc<SharedState>,
}

/// What the reading thread and the one that judges have in common.
#[derive(Default)]
struct SharedState {
    state: Mutex<ReaderState>,
    changed: Condvar,
    /// Nobody requests frames any more.
    is_left: AtomicBool,
}

#[derive(Default)]
struct ReaderState {
    is_open: bool,
    /// Its number since the camera was opened, and the image. A newer one takes its place.
    newest: Option<(u64, RawImage)>,
    settings: Option<CameraSettings>,
    /// Why there will be no more.
    ended: Option<LiveCameraError>,
}

impl LiveCamera {
    /// Opens the camera of a number at an image size that `camera` fits: the calibrated one if it has it.
    ///
    /// # Errors
    /// No such camera, one that is in use or may not be used, or that has no image of the camera file's shape.
    pub fn open(number: u32, camera: &Camera) -> Result<LiveCamera, SourceError> {
        let camera = camera.clone();
        LiveCamera::from_device(number, OPENING, move || device::open(number, &camera))
    }

    /// A camera of any make; `open` is called on the thread that reads it, and may take up to `limit`.
    ///
    /// # Errors
    /// What `open` says, or that it took longer.
    pub fn from_device(
        number: u32,
        limit: Duration,
        open: impl FnOnce() -> Result<Box<dyn Device>, LiveCameraError> + Send + 'static,
    ) -> Result<LiveCamera, SourceError> {
        let shared = Arc::new(SharedState::default());
        let reading = ReaderThread(Arc::clone(&shared));
        std::thread::spawn(move || reading.read(open));
        let seconds = limit.as_secs();
        let opened = shared.wait(limit, LiveCameraError::SlowToOpen { seconds }, |state| {
            state.is_open.then_some(())
        });
        opened.map_err(|reason| SourceError::NoCamera { number, reason })?;
        Ok(LiveCamera { number, shared })
    }
}

impl FrameSource for LiveCamera {
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError> {
        let (number, seconds) = (self.number, PATIENCE.as_secs());
        // The image that came last, if it was not given before.
        let newest = self
            .shared
            .wait(PATIENCE, LiveCameraError::NoImage { seconds }, |state| {
                state.newest.take()
            });
        let (count, image) = newest.map_err(|reason| SourceError::CameraGone { number, reason })?;
        let original = image
            .original()
            .unwrap_or_else(|reason| Original::Unreadable(reason.into()));
        Ok(Some(SourceFrame::untimed(
            format!("camera {number} image {count}"),
            original,
        )))
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
    /// A thread that failed leaves the state whole: every change is one assignment.
    fn locked(&self) -> MutexGuard<'_, ReaderState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is taken from the state as soon as it is there, why it will never be, or that it came `too_late`.
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

/// The thread's side. However it ends, the other side hears of it.
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
                    if !is_locked && since.elapsed() >= SETTLING {
                        is_locked = true;
                        let settings = device.lock();
                        shared.change(|state| state.settings = Some(settings));
                    } else if is_locked {
                        shared.change(|state| state.newest = Some((count, image)));
                    }
                }
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
            state.ended.get_or_insert(LiveCameraError::DriverPanicked);
        });
    }
}
