//! `scaleproof detectors fetch`: weights from where they are published.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::answer::answer;
use crate::cli::detectors::{Folder, chosen, fetch_one};
use crate::cli::{CommandResult, Outcome, Result, progress};
use scaleproof_detect::download::{FetchError, fetch};
use scaleproof_detect::{Manifest, WeightFolders};

/// Download weights, verify their SHA-256, go on with a broken download.
#[derive(clap::Args)]
pub(in crate::cli) struct FetchArgs {
    /// Which detectors; all when none is named.
    names: Vec<String>,
    #[command(flatten)]
    folder: Folder,
    /// One JSON object a line.
    #[arg(long)]
    json: bool,
}

/// `detectors fetch --json`: one object a line for each detector.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Fetched {
    name: String,
    /// Where the weights now are.
    path: PathBuf,
}

pub(super) fn run(args: FetchArgs, out: &mut dyn Write) -> CommandResult {
    let folders = WeightFolders::new(args.folder.weights_folder);
    for manifest in chosen(&args.names)? {
        let path = fetch_one(&manifest, &folders)?;
        if args.json {
            let name = manifest.name;
            answer(&Fetched { name, path }, out)?
        } else {
            writeln!(out, "{:<14} {}", manifest.name, path.display())?
        }
    }
    Ok(Outcome::Done)
}

pub(in crate::cli) fn download(manifest: &Manifest, folders: &WeightFolders) -> Result<PathBuf> {
    let bar = progress::bytes(&manifest.name);
    let fetched = fetch(manifest, &folders.download_folder()?, &|done, total| {
        if let Some(total) = total {
            bar.set_length(total);
        }
        bar.set_position(done);
    });
    bar.finish_and_clear();
    Ok(fetched?)
}

pub(super) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    matches!(error.downcast_ref(), Some(FetchError::Taken(_)))
        .then(|| ", or fetch into another folder by --detectors".into())
}
