//! `scaleproof session import`: boxes and viewpoints from elsewhere become a session.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::{by_variant, in_words};
use crate::cli::CommandResult;
use crate::cli::answer::told;
use scaleproof_core::{files, spelling};
use scaleproof_session::import::{self, ImportRequest};

/// Read boxes and viewpoints from a COCO annotation file or a CSV, and write a session.json beside the photos
#[derive(clap::Args)]
pub(crate) struct Args {
    /// COCO annotations (.json), or a table (.csv) with the header file,variant,place,x1,y1,x2,y2,azimuth_deg,pitch_deg,distance_mm
    file: PathBuf,
    /// The folder with the photos, from which their names count; it gets the session.json
    #[arg(long, value_name = "DIR")]
    photos: PathBuf,
    /// The scene: the model's class and the bins [default: scene.toml in the folder with the photos]
    #[arg(long, value_name = "TOML")]
    scene: Option<PathBuf>,
    /// The camera file; needed only when photos have no viewpoint and show tags
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// The texture of photos for which the file names none
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
    /// Print what was made as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args, out: &mut dyn Write) -> CommandResult {
    let scene = args.scene.clone().unwrap_or_else(|| args.photos.join("scene.toml"));
    let imported = import::import(&ImportRequest {
        file: &args.file,
        folder: &args.photos,
        scene: &scene,
        camera: args.camera.as_deref(),
        variant: args.variant.as_deref(),
    })?;
    files::replace_atomically(&args.photos, &imported.path, imported.text.as_bytes())?;
    if let Some(first) = imported.without_box.first() {
        let count = imported.without_box.len();
        say!(
            "note: {} no box of the model and {} left out (the first: {first})",
            spelling::choose(count, "1 photo has", &format!("{count} photos have")),
            spelling::choose(count, "is", "are")
        );
    }
    let photos = &imported.session.photos;
    let variants = by_variant(photos.iter().map(|photo| &*photo.variant));
    let conditions: BTreeSet<&str> = photos
        .iter()
        .flat_map(|photo| photo.conditions.keys().map(|name| &**name))
        .collect();
    let mut words = in_words(&imported.path, photos.len(), &variants, &args.photos);
    if !conditions.is_empty() {
        let names: Vec<&str> = conditions.iter().copied().collect();
        words += &format!("\nconditions kept, for --group-by: {}", names.join(", "));
    }
    let answer = ImportedSession {
        session: &args.photos,
        file: &imported.path,
        photos: photos.len(),
        variants,
        without_box: &imported.without_box,
        conditions,
    };
    told(args.json, answer, words, out)
}

/// `session import --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct ImportedSession<'a> {
    /// The folder.
    session: &'a Path,
    /// The `session.json` in it.
    file: &'a Path,
    /// How many.
    photos: usize,
    /// Photos by variant.
    variants: BTreeMap<&'a str, usize>,
    /// Photos that the file names without a box of the model.
    without_box: &'a [String],
    /// Names of the conditions that were kept.
    conditions: BTreeSet<&'a str>,
}
