//! `scaleproof detectors fetch`: weights from where they are published.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use crate::cli::answer::answer;
use crate::cli::args::fetch::FetchArgs;
use crate::cli::detectors::{chosen, fetch_one};
use crate::cli::print::fetch::Fetched;
use crate::cli::{CommandResult, Outcome, Result, progress};
use scaleproof_detect::download::{FetchError, fetch};
use scaleproof_detect::{Manifest, WeightFolders};

pub fn run(args: FetchArgs, out: &mut dyn Write) -> CommandResult {
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

pub fn download(manifest: &Manifest, folders: &WeightFolders) -> Result<PathBuf> {
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

pub fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    matches!(error.downcast_ref(), Some(FetchError::Taken(_)))
        .then(|| ", or fetch into another folder by --detectors".into())
}
