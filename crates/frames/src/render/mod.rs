//! Frames from Blender Cycles: any mesh, lights, viewpoints and paints.
//!
//! `render_frames.py` renders what the plan states.

pub mod blender; // Blender as the Python package bpy: found or installed, and run
mod collect; // frames from the values that the script writes
mod light; // panoramas that light the model
mod plan; // every decision about the pixels
mod request; // the settings, and paints

pub use collect::{srgb, triples};
pub use light::Panorama;
pub use plan::{Missing, PlannedFrame, RenderPlan};
pub use request::{ROUGHNESS, RenderPaint, RenderRequest};

use std::path::Path;

use crate::FramesError;
use scaleproof_core::files;
use scaleproof_core::message::{Message, bail, message};

/// Renders what is still missing in `folder` and writes `frames.json` when all is there. `on_frame` is called with the frames done so far, those
/// found already included. When Blender fails, frames that are whole stay, and the next call goes on after them.
pub fn render(
    plan: &RenderPlan,
    folder: &Path,
    python: &blender::Python,
    mut on_frame: impl FnMut(usize),
) -> Result<(), FramesError> {
    claim(plan, folder)?;
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
                blender::BlenderEvent::Geometry(view) if is_view(&view) => collector.save_geometry(&view)?,
                blender::BlenderEvent::Frame(name) if is_asked(&name) => {
                    collector.save_frame(&name)?;
                    done += 1;
                }
                _ => {}
            }
            on_frame(done);
            Ok(())
        })?;
        if !finished || !collector.missing().is_empty() {
            return Err(stopped(folder, done, wanted).into());
        }
    }
    let (path, bytes) = plan.list().to_file(folder)?;
    files::replace_atomically(folder, &path, &bytes)?;
    // Nothing is lost if the work folder stays.
    let _ = files::chosen::remove_folder(folder, work);
    Ok(())
}

/// Creates the error of a render that Blender did not finish.
pub fn stopped(folder: &Path, done: usize, wanted: usize) -> Message {
    let log = blender::log(&blender::work_folder(folder));
    message!(
        "Blender stopped after {done} of {wanted} frames; what it said is in {}; the same command goes on where it stopped",
        log.display()
    )
}

/// Creates the error of a folder that holds frames of another render.
pub fn other_render(folder: &Path) -> Message {
    message!(
        "{} holds frames of another render; give an empty folder, or the same arguments to go on",
        folder.display()
    )
}

/// Refuses a folder that Blender would miss: it takes a backslash for a slash.
pub fn check_folder(folder: &Path) -> Result<(), Message> {
    let whole = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    match whole.to_str() {
        Some(text) if !text.contains('\\') => Ok(()),
        _ => bail!(
            "Blender cannot write below {}: give a folder whose path is UTF-8 text without a backslash",
            whole.display()
        ),
    }
}

/// Writes the plan's identity into the folder, or refuses a folder of another plan.
fn claim(plan: &RenderPlan, folder: &Path) -> Result<(), FramesError> {
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
        return Err(other_render(folder).into());
    }
    if is_begun {
        return Ok(());
    }
    for (path, bytes) in plan.pattern_files(folder)? {
        files::replace_atomically(folder, &path, &bytes)?;
    }
    Ok(files::replace_atomically(folder, &note, own.as_bytes())?)
}
