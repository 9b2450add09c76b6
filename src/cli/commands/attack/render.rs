//! `scaleproof attack render`: frames from Blender Cycles.

use crate::cli::print::attack::frames::say_frames;
use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cli::args::attack::render::RenderArgs;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_frames::render::{RenderPlan, blender, check_folder, render};
use scaleproof_frames::{FrameSet, FramesError, LIST};

pub fn run(args: &RenderArgs, out: &mut dyn Write) -> CommandResult {
    let plan = RenderPlan::new(args.request()?)?;
    check_folder(&args.output)?;
    scaleproof_core::files::check_writable(&args.output)?;
    let python = blender::find(&cache(), progress::announce)?;
    progress::frames("rendering", plan.frames().len())
        .during(|bar| render(&plan, &args.output, &python, |done| bar.set_position(done as u64)))?;
    note_unusable(&args.output)?;
    say_frames(&args.output.join(LIST), plan.frames().len(), args.json, out)
}

/// Says at once what would stop the commands that take the frames, as a view that shows no paint. A frame of each view is looked at.
fn note_unusable(folder: &Path) -> Result<(), FramesError> {
    let set = FrameSet::open(folder)?;
    let mut views = HashSet::new();
    let mut firsts = set.list.frames.iter().filter(|frame| views.insert(&frame.paint_mask));
    if let Some(fault) = firsts.find_map(|frame| set.check_images(frame).err()) {
        say!("note: {fault}");
    }
    Ok(())
}

/// Returns the folder that Blender is kept in: the project's `.cache` when `./run` started the program, else the user's.
pub fn cache() -> PathBuf {
    match scaleproof_core::files::environment::variable("SCALEPROOF_HOME") {
        Some(home) => Path::new(&home).join(".cache"),
        None => dirs::cache_dir().unwrap_or_else(std::env::temp_dir).join("scaleproof"),
    }
}
