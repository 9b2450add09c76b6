//! `scaleproof attack import`: frames from another engine.

use std::io::Write;
use std::path::PathBuf;

use super::CommandResult;
use crate::files;
use crate::frames::LIST;
use crate::frames::import::import;

/// Make frames of a folder that another engine exported (CARLA's layout; see the guide, `frames.md`)
#[derive(clap::Args)]
pub(super) struct ImportArgs {
    /// The folder with import.json, poses.csv, rgb/ and mask/
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Folder for the frames
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ImportArgs, out: &mut dyn Write) -> CommandResult {
    let list = args.output.join(LIST);
    if list.exists() {
        return Err(format!("{} is there already; give another folder", list.display()).into());
    }
    let same = |a: &PathBuf, b: &PathBuf| a.canonicalize().ok().is_some_and(|a| b.canonicalize().ok() == Some(a));
    if same(&args.folder, &args.output) {
        return Err("the frames would be written over the images they come from; give another folder".into());
    }
    let new = import(&args.folder, &args.output, "attack import")?;
    files::replace_all_atomically(&new)?;
    // Three images a frame, and the list.
    super::say_frames(&list, new.len() / 3, args.json, out)
}
