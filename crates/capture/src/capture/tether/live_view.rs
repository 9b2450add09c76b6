//! The live view of a tethered camera: JPEG files that `gphoto2 --capture-movie` writes one behind the other.

use std::process::ChildStdout;
use std::time::Duration;

use super::error::TetherError;
use super::gphoto;
use crate::capture::live::{
    CameraSettings, Device, Jpegs, LiveCamera, LiveCameraError, LiveName, PixelFormat, RawImage, Setting, jpeg_size,
};
use crate::capture::programs::RunningProgram;
use crate::capture::source::SourceError;

/// Mirror up, sensor on: the first image is there within this.
const OPENING: Duration = Duration::from_secs(15);
const PATIENCE: Duration = Duration::from_secs(10);

/// A running live view. The camera is let go when it is dropped.
pub(super) struct LiveView {
    pub camera: LiveCamera,
    program: RunningProgram,
}

impl LiveView {
    /// Starts it; `is_of_use` says whether images of a size can be.
    ///
    /// # Errors
    /// A camera that gives none, or none of use.
    pub(super) fn start(
        model: &str,
        port: Option<&str>,
        is_of_use: impl Fn([u32; 2]) -> bool + Send + 'static,
    ) -> Result<LiveView, SourceError> {
        let (program, stdout) = gphoto::started(&mut gphoto::command(&["--stdout", "--capture-movie"], port))?;
        let (name, model, running) = (LiveName::Tethered(model.to_owned()), model.to_owned(), program.clone());
        let open = move || -> Result<Box<dyn Device>, LiveCameraError> {
            let mut movie = Movie {
                model,
                jpegs: Jpegs::new(stdout),
                first: None,
                size: [0, 0],
                program: running,
            };
            let first = movie.image()?;
            movie.size = [first.width, first.height];
            movie.first = Some(first);
            match is_of_use(movie.size) {
                true => Ok(Box::new(movie)),
                false => Err(LiveCameraError::OtherShape { size: movie.size }),
            }
        };
        let camera = LiveCamera::start(name, OPENING, PATIENCE, open);
        if camera.is_err() {
            program.stop();
        }
        Ok(LiveView {
            camera: camera?,
            program,
        })
    }
}

impl Drop for LiveView {
    fn drop(&mut self) {
        self.program.stop();
    }
}

struct Movie {
    model: String,
    jpegs: Jpegs<ChildStdout>,
    first: Option<RawImage>,
    size: [u32; 2],
    program: RunningProgram,
}

impl Device for Movie {
    fn image(&mut self) -> Result<RawImage, LiveCameraError> {
        if let Some(first) = self.first.take() {
            return Ok(first);
        }
        let bytes = match self.jpegs.next_jpeg() {
            Ok(Some(bytes)) => bytes,
            ended => {
                // What it says comes before it ends, and it ends with status 0, too, when it could not.
                self.program.ended_within(Duration::from_secs(1));
                return Err(match ended {
                    Err(e) => LiveCameraError::Ended(e.to_string()),
                    Ok(_) => TetherError::understood(&self.program.said()).into(),
                });
            }
        };
        let [width, height] = jpeg_size(&bytes).ok_or(LiveCameraError::UnknownPixelFormat)?;
        Ok(RawImage {
            format: PixelFormat::Mjpeg,
            width,
            height,
            bytes,
        })
    }

    /// Nothing is held: the photographer sets the camera.
    fn lock(&mut self) -> CameraSettings {
        let [width, height] = self.size;
        CameraSettings {
            device: self.model.clone(),
            format: format!("live view {width} × {height}"),
            exposure: Setting::default(),
            focus: Setting::default(),
            white_balance: Setting::default(),
        }
    }

    fn settling(&self) -> Duration {
        Duration::ZERO
    }
}
