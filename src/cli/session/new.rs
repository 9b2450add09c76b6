//! `scaleproof session new`: folders of photos become a session.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::{by_variant, in_words};
use crate::cli::answer::told;
use crate::cli::sessions::{self, FolderFiles, pair};
use crate::cli::{CommandResult, Result};
use scaleproof_core::files;
use scaleproof_core::spelling::{self, quoted};
use scaleproof_session::NewSession;
use scaleproof_session::filling;
use scaleproof_session::folders::PhotoFolder;

/// Make a session of folders with photos of one texture each, or add them to a session
///
/// A new session gets a session.json, and copies of the scene and the camera unless they lie in it. The photos stay as and where they are.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The session's folder; one that is there keeps its files, and a session its photos, scene and camera
    folder: PathBuf,
    /// Folders with the texture their photos show, as in normal=monday checker=tuesday, or with the place, as in normal@lab=monday
    #[arg(value_name = "VARIANT[@PLACE]=DIR")]
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

pub(super) fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
    let folders = folders(&args)?;
    // Held to the end.
    let _filling = filling::locked_if_marked(&args.folder)?;
    let list = args.folder.join("session.json");
    if list.exists() {
        // It is read and written again.
        files::inputs::own(&list);
        args.about.or_those_of(&sessions::session(&args.folder)?)?;
    }
    let gathered = args.about.gather(&folders)?;
    let (path, photos) = NewSession {
        folder: &args.folder,
        photos: &gathered,
        scene: args.about.scene()?,
        camera: args.about.camera()?,
        copy: args.copy,
    }
    .write()?;
    let variants = by_variant(photos.iter().map(|photo| &*photo.variant));
    let added: usize = gathered.folders.iter().map(|found| found.listing.photos.len()).sum();
    let mut words = in_words(&path, photos.len(), &variants, &args.folder);
    if added < photos.len() {
        words = format!("{} added\n{words}", spelling::count(added, "photo"));
    }
    let new = Answer {
        session: &args.folder,
        file: &path,
        photos: photos.len(),
        added,
        variants,
        places: photos.iter().filter_map(|photo| photo.place.as_deref()).collect(),
        copied: args.copy,
    };
    told(args.json, new, words, out)
}

/// `session new --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer<'a> {
    /// The folder.
    session: &'a Path,
    /// The `session.json` in it.
    file: &'a Path,
    /// How many it has.
    photos: usize,
    /// How many of them are new.
    added: usize,
    /// Photos by variant.
    variants: BTreeMap<&'a str, usize>,
    /// Where its photos were taken.
    places: BTreeSet<&'a str>,
    /// Whether the photos were copied into the session.
    copied: bool,
}

fn folders(args: &Args) -> Result<Vec<PhotoFolder>> {
    if args.photos.is_empty() {
        // The name was forgotten, or the folders.
        let folder = args.folder.display().to_string();
        return Err(match pair(&args.folder)? {
            Some(_) => {
                let command = format!("`scaleproof session new NAME {}`", quoted(&folder));
                format!("{folder} is taken for the session's folder: name that first, as in {command}").into()
            }
            None => "no photos are named: add VARIANT=FOLDER for each texture, as in normal=monday".into(),
        });
    }
    let not_alone = "write `scaleproof session new NAME VARIANT=FOLDER …`, as in normal=monday";
    let named = |given: &PathBuf| {
        Ok(pair(given)?.ok_or_else(|| format!("{} is no VARIANT=FOLDER: {not_alone}", given.display()))?)
    };
    args.photos.iter().map(named).collect()
}
