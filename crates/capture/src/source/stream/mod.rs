//! Cameras that stream: motion JPEG over HTTP (phones as webcams) and RTSP (network cameras), read by the system's ffmpeg.
//!
//! Motion JPEG is only unpacked, so that a photo is kept byte for byte as the camera made it; what RTSP carries is decoded.

mod address;
mod connection;

use std::time::{Duration, Instant};

use super::error::SourceError;
use super::live::{CameraSettings, Device, LiveCamera, LiveCameraError, LiveName, RawImage, Setting};
use scaleproof_core::message::message;
use scaleproof_pose::camera::Camera;

pub use address::{StreamAddress, StreamScheme};
pub use connection::Connection;

/// Waits before each new connection; after the last try the stream ends.
pub const BACK_OFF: [Duration; 5] = [
    Duration::from_millis(500),
    Duration::from_secs(1),
    Duration::from_secs(2),
    Duration::from_secs(4),
    Duration::from_secs(8),
];

/// Duration after which a connection counts as good: the next loss begins with the shortest wait.
const GOOD: Duration = Duration::from_secs(10);

/// Times longer than a connection takes to give up by itself, so that its reason is known.
const OPENING: Duration = Duration::from_secs(20);
const PATIENCE: Duration = Duration::from_secs(40);

/// Connects to a stream; frames are given as those of any running camera.
///
/// # Errors
/// An address that is not read; no connection, or images of another shape than the camera file's.
pub fn open(address: &StreamAddress, camera: &Camera) -> Result<LiveCamera, SourceError> {
    let unread = |reason| message!("the stream {address} is not read: {reason}");
    let scheme = address.scheme().map_err(unread)?;
    let (of_connection, camera) = (address.clone(), camera.clone());
    let connect = move || connection::connect(&of_connection, scheme);
    start(&address.to_string(), &BACK_OFF, connect, move |size| {
        camera.scaled_to(size[0], size[1]).is_ok()
    })
}

/// Starts a camera of whatever connects; `is_of_use` accepts images of a size. After a loss it connects again, as often as `back_off` has waits.
///
/// # Errors
/// As [`open`].
pub fn start(
    address: &str,
    back_off: &'static [Duration],
    mut connect: impl FnMut() -> Result<Box<dyn Connection>, String> + Send + 'static,
    is_of_use: impl Fn([u32; 2]) -> bool + Send + 'static,
) -> Result<LiveCamera, SourceError> {
    let name = address.to_owned();
    let open = move || -> Result<Box<dyn Device>, LiveCameraError> {
        let mut connection = connect().map_err(LiveCameraError::Ended)?;
        let first = connection.image().map_err(LiveCameraError::Ended)?;
        let size = [first.width, first.height];
        if !is_of_use(size) {
            let [width, height] = size;
            return Err(LiveCameraError::Failed(format!(
                "its images are {width} × {height} px, of another shape than the camera file's"
            )));
        }
        Ok(Box::new(Stream {
            address: name,
            described: connection.described(),
            size,
            first: Some(first),
            connection: Some(connection),
            since: Instant::now(),
            connect: Box::new(connect),
            back_off,
            lost: 0,
        }))
    };
    LiveCamera::start(LiveName::Stream(address.to_owned()), OPENING, PATIENCE, open)
}

/// A stream that is connected again when it breaks off.
struct Stream {
    address: String,
    described: String,
    size: [u32; 2],
    first: Option<RawImage>,
    connection: Option<Box<dyn Connection>>,
    since: Instant,
    connect: Box<dyn FnMut() -> Result<Box<dyn Connection>, String>>,
    back_off: &'static [Duration],
    /// Number of losses in a row.
    lost: usize,
}

impl Stream {
    /// Returns an image of the connection, which is made first if there is none.
    fn try_image(&mut self) -> Result<RawImage, String> {
        let connection = match &mut self.connection {
            Some(connection) => connection,
            None => {
                // The wait was told when it was lost.
                let wait = self.lost.checked_sub(1).and_then(|last| self.back_off.get(last));
                std::thread::sleep(wait.copied().unwrap_or_default());
                let made = (self.connect)()?;
                self.since = Instant::now();
                self.connection.insert(made)
            }
        };
        let image = connection.image()?;
        if [image.width, image.height] != self.size {
            let [width, height] = self.size;
            return Err(format!(
                "its images were {width} × {height} px and are {} × {} now",
                image.width, image.height
            ));
        }
        Ok(image)
    }
}

impl Device for Stream {
    fn image(&mut self) -> Result<RawImage, LiveCameraError> {
        if let Some(first) = self.first.take() {
            return Ok(first);
        }
        let reason = match self.try_image() {
            Ok(image) => return Ok(image),
            Err(reason) => reason,
        };
        if self.connection.take().is_some() && self.since.elapsed() >= GOOD {
            self.lost = 0;
        }
        self.lost += 1;
        let Some(wait) = self.back_off.get(self.lost - 1) else {
            return Err(LiveCameraError::Ended(format!(
                "{reason}, after {} tries",
                self.back_off.len()
            )));
        };
        Err(LiveCameraError::Waiting(format!(
            "the stream {} broke off ({reason}): connecting again in {} s, try {} of {}",
            self.address,
            wait.as_secs_f64(),
            self.lost,
            self.back_off.len()
        )))
    }

    /// Locks nothing: a stream carries images only.
    fn lock(&mut self) -> CameraSettings {
        let [width, height] = self.size;
        CameraSettings {
            device: self.address.clone(),
            format: format!("{} {width} × {height}", self.described),
            exposure: Setting::default(),
            focus: Setting::default(),
            white_balance: Setting::default(),
        }
    }

    fn settling(&self) -> Duration {
        Duration::ZERO
    }
}
