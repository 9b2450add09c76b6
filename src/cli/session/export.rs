//! `scaleproof session export`: the photos of a session with their truth boxes, for other programs.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::by_variant;
use crate::cli::CommandResult;
use crate::cli::answer::told;
use crate::cli::choice::one_of;
use crate::cli::score::{Effort, say_not_scored, score_with_progress};
use crate::cli::sessions::session;
use scaleproof_core::spelling::{self, quoted};
use scaleproof_score::report::{self, ExportFormat};

/// Write what another program should run on: the photos of a session, with their truth boxes, as COCO or YOLO
///
/// The folder gets links to the photos, which stay as they are, and annotations.json (COCO), or data.yaml, images.txt and labels (YOLO). The
/// other program's detections come back by `scaleproof score --results`. Photos that cannot be located are left out and said.
#[derive(clap::Args)]
pub(in crate::cli) struct Args {
    /// The session's folder
    session: PathBuf,
    /// Format of the annotations
    #[arg(long, value_name = "FORMAT", value_parser = one_of([(ExportFormat::Coco, "coco"), (ExportFormat::Yolo, "yolo")]))]
    format: ExportFormat,
    /// A new folder
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// Copy the photos instead of linking to them
    #[arg(long)]
    copy: bool,
    #[command(flatten)]
    effort: Effort,
    /// Print what was written as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    report::check_export(&args.output)?;
    let options = args.effort.options(&[])?;
    let scores = score_with_progress(vec![session(&args.session)?], Vec::new(), &options)?.with_copies();
    say_not_scored(&scores);
    let file = report::export(&scores, args.format, &args.output, args.copy)?;
    let variants = by_variant(scores.photos.iter().map(|photo| photo.variant.as_str()));
    let place = |path: &Path| quoted(&path.display().to_string());
    let back = match args.format {
        ExportFormat::Coco => format!("--results NAME=results.json --images {}", place(&file)),
        ExportFormat::Yolo => "--results NAME=FOLDER".to_owned(),
    };
    let words = format!(
        "{}: {}; run the other program on {}, then `scaleproof score {} {back} -o REPORT`",
        file.display(),
        spelling::count(scores.photos.len(), "photo"),
        args.output.join("images").display(),
        place(&args.session)
    );
    let exported = Exported {
        folder: &args.output,
        file: &file,
        photos: scores.photos.len(),
        variants,
        not_exported: scores.not_scored.len(),
        copied: args.copy,
    };
    told(args.json, exported, words, out)
}

/// `session export --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Exported<'a> {
    /// Where everything is.
    folder: &'a Path,
    /// The file in it that names everything.
    file: &'a Path,
    /// Photos that were written.
    photos: usize,
    /// Photos by variant.
    variants: BTreeMap<&'a str, usize>,
    /// Photos that could not be located.
    not_exported: usize,
    /// Whether the photos were copied.
    copied: bool,
}
