//! Frames from Blender Cycles: any mesh, lights, viewpoints and paints.
//!
//! `plan.rs` decides everything, `render_frames.py` renders it, [`blender`] has the Python package `bpy`, and
//! `collect.rs` makes frames of what comes out.

pub mod blender;
mod collect;
mod light;
mod plan;
mod request;

pub use collect::{srgb, triples};
pub use light::Panorama;
pub use plan::{Missing, PlannedFrame, RenderPlan};
pub use request::{ROUGHNESS, RenderPaint, RenderRequest};

use std::path::{Path, PathBuf};

use crate::FramesError;
use scaleproof_core::files::{self, FileError};
use scaleproof_pose::scene::Viewpoint;

/// Why nothing, or not everything, was rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Frames(#[from] FramesError),
    #[error("{what} cannot be {value}; give {wanted}")]
    BadNumber {
        what: &'static str,
        value: f64,
        wanted: &'static str,
    },
    #[error(
        "light '{text}' is not understood; write one of Blender's (city, courtyard, forest, interior, night, studio, sunrise, sunset) or an .exr \
         or .hdr file, and a turn from 0 up to 360 degrees if you like, as in forest@90"
    )]
    BadLight { text: String },
    #[error("a light's file cannot be called {name:?}; rename it to letters, digits, '-', '_' and '.'")]
    BadLightName { name: String },
    #[error("nothing to render: give at least one {what}")]
    Nothing { what: &'static str },
    #[error("a pattern or texture cannot be called {name:?}; rename its file to plain letters and digits")]
    BadName { name: String },
    #[error("Blender cannot write below {folder}: give a folder whose path is UTF-8 text without a backslash")]
    BadFolder { folder: PathBuf },
    #[error("the frame {name} would be rendered twice; give each light, viewpoint and paint once")]
    Twice { name: String },
    #[error("the mesh has no triangles of the paint's materials")]
    NoPaint,
    #[error(
        "the camera at azimuth {}°, pitch {}°, {} mm is not above the ground and outside the model; move it away",
        .0.azimuth_deg, .0.pitch_deg, .0.distance_mm
    )]
    CameraInside(Viewpoint),
    #[error(
        "the model is not whole in the image at azimuth {}°, pitch {}°, {} mm, so it would be judged by a part; move the camera away, or widen the \
         field of view",
        .0.azimuth_deg, .0.pitch_deg, .0.distance_mm
    )]
    CutOff(Viewpoint),
    #[error("{folder} holds frames of another render; give an empty folder, or the same arguments to go on")]
    OtherRender { folder: PathBuf },
    #[error(
        "rendering needs Python 3.11, for which Blender's package bpy 4.5 is built, and `{program}` does not start; install it (on Debian: \
             apt install python3.11), or name it with SCALEPROOF_PYTHON"
    )]
    NoPython { program: String },
    #[error(
        "`{program}` is Python {version}, and Blender's package bpy 4.5 is built for 3.11; name a Python 3.11 with SCALEPROOF_PYTHON"
    )]
    OtherPython { program: String, version: String },
    #[error(
        "Blender's Python package could not be installed: `{command}` said: {reason}; with a network, or with the wheel in a folder that \
             PIP_FIND_LINKS names, run this again"
    )]
    Install { command: String, reason: String },
    #[error("{0}")]
    Refused(String),
    #[error(
        "Blender stopped after {done} of {wanted} frames; what it said is in {log}; the same command goes on where it stopped"
    )]
    Stopped { done: usize, wanted: usize, log: PathBuf },
    #[error("Blender made {path} with {found} bytes instead of {wanted}; run the command again")]
    Torn { path: PathBuf, found: usize, wanted: usize },
}

/// Renders what is still missing in `folder` and writes `frames.json` when all is there. `on_frame` is called with the frames done so far, those
/// found already included.
///
/// # Errors
/// A folder of another render, no Blender, and whatever Blender cannot do. Frames that are whole stay, and the next call goes on after them.
pub fn render(
    plan: &RenderPlan,
    folder: &Path,
    python: &blender::Python,
    mut on_frame: impl FnMut(usize),
) -> Result<(), RenderError> {
    reserve(plan, folder)?;
    let work = &blender::work_folder(folder);
    let collector = collect::Collector { plan, folder };
    let missing = collector.missing();
    let wanted = plan.frames().len();
    let mut done = wanted - missing.frames.len();
    on_frame(done);
    if !missing.is_empty() {
        // Blender says more than the script, such as names in a mesh: what was not asked for is none of its images.
        let is_asked = |name: &String| missing.frames.iter().any(|frame| plan.frame_name(frame) == *name);
        let is_view = |name: &String| missing.viewpoints.iter().any(|view| plan.view_name(*view) == *name);
        let finished = blender::run(python, &plan.to_script(&missing, folder), folder, |event| {
            match event {
                blender::BlenderEvent::Geometry(view) if is_view(&view) => collector.take_geometry(&view)?,
                blender::BlenderEvent::Frame(name) if is_asked(&name) => {
                    collector.take_frame(&name)?;
                    done += 1;
                }
                _ => {}
            }
            on_frame(done);
            Ok(())
        })?;
        if !finished || !collector.missing().is_empty() {
            let log = blender::log(work);
            return Err(RenderError::Stopped { done, wanted, log });
        }
    }
    let (path, bytes) = plan.list().to_file(folder)?;
    files::replace_atomically(folder, &path, &bytes)?;
    // Nothing is lost if the work folder stays.
    let _ = files::chosen::remove_folder(folder, work);
    Ok(())
}

/// Refuses a folder that Blender would miss: it takes a backslash for a slash.
pub fn check_folder(folder: &Path) -> Result<(), RenderError> {
    let whole = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    match whole.to_str() {
        Some(text) if !text.contains('\\') => Ok(()),
        _ => Err(RenderError::BadFolder { folder: whole }),
    }
}

/// Writes what the folder is for, or refuses a folder that is for something else.
fn reserve(plan: &RenderPlan, folder: &Path) -> Result<(), RenderError> {
    let note = folder.join("render.json");
    let own = plan.identity();
    // What was refused before its first image leaves the folder free.
    let is_begun = note.is_file() && (folder.join("views").is_dir() || folder.join("rgb").is_dir());
    let is_free = if is_begun {
        files::read_text(&note)? == own
    } else {
        !folder.join(crate::LIST).exists()
    };
    if !is_free {
        let folder = folder.to_owned();
        return Err(RenderError::OtherRender { folder });
    }
    if is_begun {
        return Ok(());
    }
    for (path, bytes) in plan.pattern_files(folder)? {
        files::replace_atomically(folder, &path, &bytes)?;
    }
    Ok(files::replace_atomically(folder, &note, own.as_bytes())?)
}
