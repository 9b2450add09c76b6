//! ONNX Runtime: found and loaded once, then one session per detector and thread.

use std::fmt::Display;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use image::RgbImage;
use ort::environment::Environment;
use ort::logging::LogLevel;
use ort::session::builder::GraphOptimizationLevel;
use ort::session::{RunOptions, Session};
use ort::value::{DynValue, Tensor as OrtTensor};

use super::heads::{self, Data, HeadError, Tensor};
use super::input::{self, InputPlacement};
use super::manifest::{Head, Input, Values};
use super::nms::{BestFirst, CandidateBox};
use super::{Detection, HIGHEST_SCORE, MAX_DETECTIONS, Manifest};
use scaleproof_core::files;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::workers::stopwatch::{Stage, timed};

/// Why a detector could not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DetectError {
    #[error(transparent)]
    Message(#[from] Message),
    /// The network answered with a NaN, an infinity or a box that is not finite.
    #[error(transparent)]
    NotANumber(Message),
    #[error(transparent)]
    TooLong(Message),
}

impl DetectError {
    /// The error of a detector that was stopped.
    pub(super) fn too_long(detector: &dyn Display, limit: Duration) -> DetectError {
        DetectError::TooLong(message!(
            "{detector} has not answered within {} s and was stopped: its network may run in an endless loop, so export it again, or use another one",
            limit.as_secs_f64()
        ))
    }
}

/// Time limit for one photo, far more than any network takes on a single core. A loop in its file may never end.
const TIME_LIMIT: Duration = Duration::from_secs(120);

pub struct Runtime {
    /// The one a process may have.
    pub environment: Environment,
    /// The library's file name; distributions put the version into it.
    library: String,
}

impl Runtime {
    /// Loads ONNX Runtime from `$ORT_DYLIB_PATH`, else from `lib` beside the program, else from the system's library path.
    pub fn load() -> Result<&'static Runtime, DetectError> {
        static RUNTIME: OnceLock<Result<Runtime, String>> = OnceLock::new();
        let loaded = RUNTIME.get_or_init(load).as_ref();
        Ok(loaded.map_err(|tried| {
            message!("ONNX Runtime was not found ({tried}): start scaleproof through ./run, or set ORT_DYLIB_PATH to libonnxruntime.so")
        })?)
    }

    /// Version and build of the loaded library, for provenance.
    pub fn provenance(&self) -> String {
        format!("{} ({})", self.library, ort::info())
    }
}

/// Loads the library; the error has its name and why it cannot be used.
fn load() -> Result<Runtime, String> {
    let file = files::environment::text("ORT_DYLIB_PATH").unwrap_or_else(default_library);
    let missing = |e: &dyn Display| format!("{file}: {}", first_line(&e));
    let builder = ort::init_from(&file).map_err(|e| missing(&e))?;
    let named = builder.with_telemetry(false).with_name("scaleproof");
    let environment = named.build().map_err(|e| missing(&e))?;
    // What a network says of itself would reach the terminal as it is; complaints come back as errors.
    environment.set_log_level(LogLevel::Fatal);
    Ok(Runtime {
        environment,
        library: files::name_of(&std::fs::canonicalize(&file).unwrap_or(file.into())),
    })
}

/// The library that lies beside a packaged program, else the system's.
fn default_library() -> String {
    let is_apple = std::env::consts::OS == "macos";
    let name = if is_apple {
        "libonnxruntime.dylib"
    } else {
        "libonnxruntime.so"
    };
    let packaged = files::beside_the_program("lib").map(|lib| lib.join(name));
    let packaged = packaged.filter(|path| path.is_file());
    packaged.map_or_else(|| name.to_owned(), |path| path.to_string_lossy().into_owned())
}

pub struct Detector {
    pub manifest: Manifest,
    session: Session,
    /// For one photo.
    pub time_limit: Duration,
}

impl Detector {
    /// Loads a detector's weights; one inference thread.
    pub fn open(runtime: &Runtime, manifest: &Manifest, weights: &Path) -> Result<Detector, DetectError> {
        Ok(Detector {
            manifest: manifest.clone(),
            session: session(runtime, weights)?,
            time_limit: TIME_LIMIT,
        })
    }

    /// Every detection of a photo above the score floor, best first, at most [`MAX_DETECTIONS`].
    pub fn detect(&mut self, photo: &RgbImage) -> Result<Vec<Detection>, DetectError> {
        self.detect_reduced(photo, photo.width(), photo.height())
    }

    /// Like [`Detector::detect`], for a photo of this width and height, px, of which `photo` is a reduced image, no smaller than
    /// [`Manifest::least_px`], or brought to [`Manifest::opencv_linear_px`]; boxes are in pixels of the full photo.
    pub fn detect_reduced(&mut self, photo: &RgbImage, width: u32, height: u32) -> Result<Vec<Detection>, DetectError> {
        let detector = &self.manifest.name;
        let failed = |reason: String| DetectError::from(message!("{detector} failed: {reason}"));
        let not_a_number = |what: String| {
            DetectError::NotANumber(message!("{detector} answered with {what}: no box of it can be trusted"))
        };
        let (input, in_photo_px) = (&self.manifest.input, heads::wants_photo_size(&self.manifest.head));
        let placement = InputPlacement::new(input, width, height);
        let (session, limit) = (&mut self.session, self.time_limit);
        let outputs = run(session, input, in_photo_px, photo, &placement, limit).map_err(|e| match e {
            NoAnswer::Failed(e) => failed(e.to_string().replace('\n', " ")),
            NoAnswer::TooLong => DetectError::too_long(detector, limit),
        })?;
        if let Some(what) = heads::with_no_number(&outputs) {
            return Err(not_a_number(what));
        }
        let candidates = heads::candidates(&self.manifest, &outputs, placement.canvas).map_err(|e| match e {
            HeadError::NotFinite(what) => not_a_number(what),
            e => failed(e.to_string()),
        })?;
        let candidates = match self.manifest.head {
            Head::Efficientdet(_) => within_photo(candidates, &placement),
            _ => candidates,
        };
        let candidates = BestFirst::new(candidates, self.manifest.head.nms_iou());
        if let Some(score) = candidates.highest_score().filter(|score| *score > HIGHEST_SCORE) {
            bail!(
                "{detector} gives a box the score {score}: was it exported without its sigmoid, or is its head another one?"
            );
        }
        let [w, h] = placement.photo;
        let to_photo = |b: BoxPx| {
            if in_photo_px {
                b.clipped(w, h)
            } else {
                placement.to_photo(b)
            }
        };
        let detections = candidates.filter_map(|c| Detection::new(c.label, c.score.min(1.0), to_photo(c.b)));
        Ok(detections.take(MAX_DETECTIONS).collect())
    }
}

/// Candidates in input pixels, cut at the photo's border, without those outside it. Source: effdet's `generate_detections`, which cuts boxes before it
/// suppresses them (`clip_boxes_xyxy`); cut afterwards, others would overlap.
fn within_photo(candidates: Vec<CandidateBox>, placement: &InputPlacement) -> Vec<CandidateBox> {
    let [width, height] = [0, 1].map(|i| placement.photo[i] * placement.scale[i]);
    let [left, top] = placement.offset;
    let cut = |c: CandidateBox| {
        let [x1, y1, x2, y2] = c.b.into();
        let moved = BoxPx::new(x1 - left, y1 - top, x2 - left, y2 - top).clipped(width, height);
        let b = BoxPx::new(moved.x1 + left, moved.y1 + top, moved.x2 + left, moved.y2 + top);
        b.is_solid().then_some(CandidateBox { b, ..c })
    };
    candidates.into_iter().filter_map(cut).collect()
}

pub(super) fn session(runtime: &Runtime, weights: &Path) -> Result<Session, Message> {
    let load = || {
        Session::builder(&runtime.environment)?
            .with_optimization_level(GraphOptimizationLevel::Level3)?
            .with_intra_threads(1)?
            .with_log_level(LogLevel::Fatal)?
            .commit_from_file(weights)
    };
    load().map_err(|e: ort::Error| {
        let (path, reason) = (weights.display(), first_line(&e));
        message!("{path} is not a model ONNX Runtime can load: {reason}")
    })
}

pub(super) fn first_line(e: &impl ToString) -> String {
    e.to_string().lines().next().unwrap_or_default().to_owned()
}

/// Why a network gave no answer.
#[derive(Debug, thiserror::Error)]
pub(super) enum NoAnswer {
    #[error(transparent)]
    Failed(#[from] ort::Error),
    #[error("its time is over")]
    TooLong,
}

/// The network's outputs for a photo, if it answers within the time limit.
pub(super) fn run(
    session: &mut Session,
    input: &Input,
    takes_photo_size: bool,
    photo: &RgbImage,
    placement: &InputPlacement,
    time_limit: Duration,
) -> Result<Vec<Tensor>, NoAnswer> {
    let tensor = timed(Stage::Resize, || input::tensor(photo, input, placement));
    let image = image_tensor(input, tensor, placement)?;
    let mut options = RunOptions::new()?;
    // Its complaints come back as errors; on standard error they would be a second sentence.
    options.set_log_level(LogLevel::Fatal)?;
    let work = || {
        let outputs = if takes_photo_size {
            let size = OrtTensor::from_array(([1, 2], placement.photo.map(|v| v as i64).to_vec()))?;
            session.run_with_options(ort::inputs![image, size], &options)?
        } else {
            session.run_with_options(ort::inputs![image], &options)?
        };
        outputs.iter().map(|(name, value)| copied(name, &value)).collect()
    };
    match stopped_after(time_limit, &options, work) {
        (Ok(outputs), _) => Ok(outputs),
        (Err(_), true) => Err(NoAnswer::TooLong),
        (Err(e), false) => Err(NoAnswer::Failed(e)),
    }
}

/// Does some work, and what ONNX Runtime runs for it with these options is stopped after the time limit; true: it was. ONNX Runtime stops
/// between two operators, also inside a loop.
fn stopped_after<T>(time_limit: Duration, options: &RunOptions, work: impl FnOnce() -> T) -> (T, bool) {
    std::thread::scope(|scope| {
        let (working, is_over) = mpsc::channel::<()>();
        // Nothing is sent: the channel closes when the work is done, or when it panics, and the watchdog ends at once.
        let watchdog = scope.spawn(move || {
            let is_late = is_over.recv_timeout(time_limit) == Err(RecvTimeoutError::Timeout);
            is_late && options.terminate().is_ok()
        });
        let done = work();
        drop(working);
        (done, watchdog.join().unwrap_or(false))
    })
}

/// The image in the shape and type the network takes.
fn image_tensor(input: &Input, tensor: Vec<f32>, placement: &InputPlacement) -> ort::Result<DynValue> {
    let shape = input.shape(placement.canvas);
    Ok(match input.values {
        Values::F32 => OrtTensor::from_array((shape, tensor))?.into_dyn(),
        Values::U8 => {
            let bytes: Vec<u8> = tensor.into_iter().map(|v| v.round() as u8).collect();
            OrtTensor::from_array((shape, bytes))?.into_dyn()
        }
    })
}

fn copied(name: &str, value: &DynValue) -> ort::Result<Tensor> {
    let (shape, data) = if let Ok((shape, data)) = value.try_extract_tensor::<i64>() {
        (shape, Data::I64(data.to_vec()))
    } else if let Ok((shape, data)) = value.try_extract_tensor::<i32>() {
        (shape, Data::I64(data.iter().map(|v| i64::from(*v)).collect()))
    } else {
        let (shape, data) = value.try_extract_tensor::<f32>()?;
        (shape, Data::F32(data.to_vec()))
    };
    Ok(Tensor {
        name: name.to_owned(),
        shape: shape.iter().map(|d| *d as usize).collect(),
        data,
    })
}
