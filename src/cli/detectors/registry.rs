//! `scaleproof detectors register` and `remove`: the user's own list of detectors.

use std::io::Write;

use super::{Folder, chosen};
use crate::cli::{CommandResult, Outcome};
use scaleproof_detect as detect;

#[derive(clap::Args)]
pub(crate) struct RegisterArgs {
    /// The detector's manifest (.toml), or its ONNX file with the manifest beside it.
    manifest: String,
    #[command(flatten)]
    folder: Folder,
}

#[derive(clap::Args)]
pub(crate) struct RemoveArgs {
    /// The registered detector.
    name: String,
}

pub(super) fn register(args: &RegisterArgs, out: &mut dyn Write) -> CommandResult {
    let folders = args.folder.folders()?;
    for manifest in chosen(std::slice::from_ref(&args.manifest))? {
        let path = detect::register(&manifest, &folders)?;
        let name = &manifest.name;
        writeln!(out, "registered: {}\nuse it: --detector {name}", path.display())?;
    }
    Ok(Outcome::Done)
}

pub(super) fn remove(args: &RemoveArgs, out: &mut dyn Write) -> CommandResult {
    let path = detect::unregister(&args.name)?;
    writeln!(out, "{}: taken off the list ({})", args.name, path.display())?;
    Ok(Outcome::Done)
}
