//! `scaleproof session new`: folders of photos become a session.

use crate::cli::answer::answer;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{by_variant, in_words};
use crate::cli::Result;
use crate::cli::sessions::{FolderFiles, pair, quoted};
use crate::cli::{CommandResult, Outcome};
use scaleproof_session::session::NewSession;
use scaleproof_session::session::folders::PhotoFolder;

/// Make a session of folders with photos of one texture each
///
/// The session gets a session.json, and copies of the scene and the camera unless they lie in it. The photos stay as and where they are.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The session's folder; one that is there keeps its files
    folder: PathBuf,
    /// Folders with the texture their photos show, as in normal=monday checker=tuesday
    #[arg(value_name = "VARIANT=DIR")]
    photos: Vec<PathBuf>,
    #[command(flatten)]
    about: FolderFiles,
    /// Copy the photos into the session, in a folder for each of theirs, instead of naming them where they are
    #[arg(long)]
    copy: bool,
    /// Print what was made as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args, out: &mut dyn Write) -> CommandResult {
    let folders = folders(args)?;
    let gathered = args.about.gather(&folders)?;
    let made = NewSession {
        folder: &args.folder,
        photos: &gathered,
        scene: args.about.scene()?,
        camera: args.about.camera()?,
        copy: args.copy,
    }
    .write()?;
    let variants = by_variant(&made.photos);
    if args.json {
        let new = Answer {
            session: &args.folder,
            file: &made.path,
            photos: made.photos.len(),
            variants,
            place: args.about.place(),
            copied: args.copy,
        };
        answer(&new, out)?;
    } else {
        writeln!(out, "{}", in_words(&made.path, &made.photos, &args.folder))?
    }
    Ok(Outcome::Done)
}

/// `session new --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer<'a> {
    /// The folder.
    session: &'a Path,
    /// The `session.json` in it.
    file: &'a Path,
    /// How many.
    photos: usize,
    /// Photos by variant.
    variants: BTreeMap<&'a str, usize>,
    /// Of all photos.
    place: &'a str,
    /// Whether the photos were copied into the session.
    copied: bool,
}

fn folders(args: &Args) -> Result<Vec<PhotoFolder>> {
    let not_alone = |what: &Path| {
        format!(
            "{} is no VARIANT=FOLDER: write `scaleproof session new NAME VARIANT=FOLDER …`, as in normal=monday",
            what.display()
        )
    };
    if args.photos.is_empty() {
        // The name was forgotten, or the folders.
        return Err(match pair(&args.folder)? {
            Some(_) => format!(
                "{} is taken for the session's folder: name that first, as in `scaleproof session new NAME {}`",
                args.folder.display(),
                quoted(&args.folder.display().to_string())
            )
            .into(),
            None => "no photos are named: add VARIANT=FOLDER for each texture, as in normal=monday".into(),
        });
    }
    let named = |given: &PathBuf| Ok(pair(given)?.ok_or_else(|| not_alone(given))?);
    args.photos.iter().map(named).collect()
}
