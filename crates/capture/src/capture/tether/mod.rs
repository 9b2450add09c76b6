//! A camera that a computer triggers, by the program gphoto2: DSLR and mirrorless cameras at a USB port.
//!
//! A photo takes seconds, and the photographer has the camera in the hands or on a tripod. So where the camera has a live view, that is judged
//! like any running camera, and when it has held still at a view that is open, the photo is triggered, downloaded and judged by itself. Where
//! it has none, the photographer presses the camera's own button, and each photo is downloaded as it is taken: a clock, or a key of the
//! computer, would take photos while the camera is being carried.

mod arrivals;
mod error;
mod gphoto;
mod live_view;

use std::time::{Duration, Instant};

use arrivals::Arrivals;
use live_view::LiveView;

use super::live::{CameraSettings, LiveCameraError};
use super::programs::RunningProgram;
use super::source::{FrameSource, Original, Purpose, Shutter, SourceError, SourceFrame};
use scaleproof_pose::camera::Camera;

pub use error::TetherError;
pub use gphoto::{Abilities, FoundCamera, found_cameras, parse_abilities, parse_found};

/// From the trigger to the photo on this machine: half a minute of exposure, and a raw file beside the JPEG over a slow cable.
const PHOTO_WITHIN: Duration = Duration::from_secs(90);
const LOOK_AGAIN: Duration = Duration::from_millis(50);

/// How far the shape of a live view may be from that of the photos, as a share of the height: cameras cut a few rows off.
const MOST_CUT: f64 = 0.02;

/// A tethered camera.
pub struct Tether {
    model: String,
    port: Option<String>,
    /// Width and height of the camera file.
    size: [u32; 2],
    way: Way,
    /// Those of the last live view, which has ended when a photo comes.
    settings: Option<CameraSettings>,
}

/// How photos come about.
enum Way {
    /// The live view is looked at; it is started again after each photo.
    LiveView { view: Option<LiveView>, shutter: Shutter },
    /// The photographer presses the camera's button.
    Button {
        program: RunningProgram,
        arrivals: Arrivals,
        /// Why there is no live view.
        reason: String,
    },
}

impl Tether {
    /// Connects to the only camera, or to the one at a port.
    ///
    /// # Errors
    /// No gphoto2, no camera, several, or one that takes no photos for a computer.
    pub fn open(port: Option<&str>, camera: &Camera) -> Result<Tether, SourceError> {
        if port.is_none() {
            let found = found_cameras()?.ok_or(TetherError::NoProgram)?;
            if found.len() > 1 {
                let names: Vec<String> = found
                    .iter()
                    .map(|one| format!("{} at {}", one.model, one.port))
                    .collect();
                return Err(TetherError::Several(names.join(", ")).into());
            }
            if found.is_empty() {
                return Err(TetherError::NoCamera.into());
            }
        }
        let abilities = gphoto::abilities(port)?;
        if !abilities.captures {
            return Err(TetherError::NoCapture(abilities.model).into());
        }
        let (model, port) = (abilities.model, port.map(str::to_owned));
        let size = [camera.width, camera.height];
        let way = match abilities.previews.then(|| start_view(&model, port.as_deref(), size)) {
            Some(Ok(view)) => Way::LiveView {
                view: Some(view),
                shutter: Shutter::default(),
            },
            Some(Err(SourceError::NoLiveView { reason, .. })) if !is_unusable(&reason) => {
                button(port.as_deref(), reason.to_string())?
            }
            Some(Err(e)) => return Err(e),
            None => button(port.as_deref(), "this model has none".into())?,
        };
        Ok(Tether {
            model,
            port,
            size,
            way,
            settings: None,
        })
    }

    fn frame(&self, (name, original): (String, Original), purpose: Purpose) -> SourceFrame {
        let name = format!("{} {name}", self.model);
        SourceFrame {
            purpose,
            ..SourceFrame::untimed(name, original)
        }
    }
}

/// Whether a camera that gives no live view for this reason gives no photos, either.
fn is_unusable(reason: &LiveCameraError) -> bool {
    use TetherError::{Busy, Unplugged, Working};
    matches!(reason, LiveCameraError::Tethered(Busy | Working | Unplugged))
}

fn start_view(model: &str, port: Option<&str>, size: [u32; 2]) -> Result<LiveView, SourceError> {
    LiveView::start(model, port, move |view| shapes_agree(view, size))
}

/// Whether a live view shows what a photo does, but for a few rows.
pub(super) fn shapes_agree(view: [u32; 2], photo: [u32; 2]) -> bool {
    let [[width, height], [of_width, of_height]] = [view, photo].map(|size| size.map(f64::from));
    let expected = width * of_height / of_width;
    (height - expected).abs() <= 1.0 + MOST_CUT * expected
}

fn button(port: Option<&str>, reason: String) -> Result<Way, TetherError> {
    let arrivals = Arrivals::new()?;
    let program = gphoto::start_in(arrivals.folder(), "--capture-tethered", port)?;
    Ok(Way::Button {
        program,
        arrivals,
        reason,
    })
}

impl FrameSource for Tether {
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError> {
        match &mut self.way {
            Way::Button { program, arrivals, .. } => {
                let arrived = pressed(program, arrivals);
                let arrived = arrived.map_err(|reason| SourceError::TetherGone {
                    model: self.model.clone(),
                    reason,
                })?;
                Ok(Some(self.frame(arrived, Purpose::Photo)))
            }
            Way::LiveView { view, shutter } => {
                if let Some(is_by_hand) = shutter.was_released() {
                    // One program at a time may use the camera.
                    let ended = view.take();
                    self.settings = ended.and_then(|view| view.camera.settings()).or(self.settings.take());
                    let photo = triggered(self.port.as_deref());
                    let photo = photo.unwrap_or_else(|e| ("photo".into(), Original::Unreadable(e.to_string())));
                    return Ok(Some(self.frame(photo, Purpose::Released { is_by_hand })));
                }
                let running = match view {
                    Some(running) => running,
                    None => view.insert(start_view(&self.model, self.port.as_deref(), self.size)?),
                };
                let frame = running.camera.next()?;
                let purpose = Purpose::Preview(shutter.clone());
                Ok(frame.map(|frame| SourceFrame { purpose, ..frame }))
            }
        }
    }

    fn is_stream(&self) -> bool {
        matches!(self.way, Way::LiveView { .. })
    }

    fn settings(&self) -> Option<CameraSettings> {
        match &self.way {
            Way::LiveView { view, .. } => {
                let running = view.as_ref().and_then(|view| view.camera.settings());
                running.or_else(|| self.settings.clone())
            }
            Way::Button { .. } => None,
        }
    }

    fn instructions(&self) -> Option<String> {
        let model = &self.model;
        Some(match &self.way {
            Way::LiveView { .. } => {
                format!(
                    "walk round the model with the {model}; hold it still where it is told, and it takes the photo; Ctrl-C ends"
                )
            }
            Way::Button { reason, .. } => {
                format!(
                    "walk round the model with the {model} and press its button at each view, as there is no live view ({reason}); Ctrl-C ends"
                )
            }
        })
    }
}

/// Waits until the photographer has pressed the camera's button.
fn pressed(program: &RunningProgram, arrivals: &Arrivals) -> Result<(String, Original), TetherError> {
    // A JPEG may follow its raw file within some seconds.
    let mut others: Option<(String, Instant)> = None;
    loop {
        // Asked first: what has arrived by then is all there is.
        let ended = program.ended();
        if let Some(photo) = arrivals.take_jpeg() {
            arrivals.others();
            return Ok(photo);
        }
        if let Some(name) = arrivals.others().pop_first() {
            others = Some((name, Instant::now()));
        }
        if let Some((name, _)) = others.take_if(|(_, since)| since.elapsed() > RAW_ALONE) {
            let sentence = TetherError::NoJpeg(name.clone()).to_string();
            return Ok((name, Original::Unreadable(sentence)));
        }
        if ended.is_some() {
            return Err(match TetherError::understood(&program.said()) {
                TetherError::NoCamera | TetherError::NoPhoto(_) => TetherError::Unplugged,
                reason => reason,
            });
        }
        std::thread::sleep(LOOK_AGAIN);
    }
}

/// After so long without a JPEG, a raw file came alone.
const RAW_ALONE: Duration = Duration::from_secs(6);

/// Takes a photo.
fn triggered(port: Option<&str>) -> Result<(String, Original), TetherError> {
    let arrivals = Arrivals::new()?;
    let program = gphoto::start_in(arrivals.folder(), "--capture-image-and-download", port)?;
    let seconds = PHOTO_WITHIN.as_secs();
    program
        .ended_within(PHOTO_WITHIN)
        .ok_or(TetherError::TooSlow { seconds })?;
    // Whether it ended well says little: gphoto2 does after many failures.
    if let Some(photo) = arrivals.take_jpeg() {
        return Ok(photo);
    }
    Err(match arrivals.others().pop_first() {
        Some(name) => TetherError::NoJpeg(name),
        None => TetherError::understood(&program.said()),
    })
}

/// A camera file for the live view of a camera whose photos it is for: each side scaled by itself, as a few rows may be cut off. Good enough to
/// say where to go; no pose of it is kept.
pub(super) fn camera_of_view(camera: &Camera, [width, height]: [u32; 2]) -> Camera {
    let [sx, sy] = [
        f64::from(width) / f64::from(camera.width),
        f64::from(height) / f64::from(camera.height),
    ];
    let mut of_view = camera.clone();
    (of_view.width, of_view.height) = (width, height);
    (of_view.fx, of_view.fy) = (camera.fx * sx, camera.fy * sy);
    (of_view.cx, of_view.cy) = ((camera.cx + 0.5) * sx - 0.5, (camera.cy + 0.5) * sy - 0.5);
    of_view
}
