//! `scaleproof session import`: boxes and viewpoints from elsewhere become a session.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;

use super::{CommandResult, Outcome};
use crate::files;
use crate::session::import::{self, Request};

/// Make a session of photos whose truth is known from elsewhere
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Read boxes and viewpoints from a COCO annotation file or a CSV, and write a session.json beside the photos
    Import(ImportArgs),
}

#[derive(clap::Args)]
struct ImportArgs {
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
}

/// Runs `scaleproof session …`.
pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Import(args) => run_import(&args, out),
    }
}

fn run_import(args: &ImportArgs, out: &mut dyn Write) -> CommandResult {
    let scene = args.scene.clone().unwrap_or_else(|| args.photos.join("scene.toml"));
    let imported = import::import(&Request {
        file: &args.file,
        folder: &args.photos,
        scene: &scene,
        camera: args.camera.as_deref(),
        variant: args.variant.as_deref(),
    })?;
    files::write_atomically(&imported.path, imported.text.as_bytes())?;
    if let Some(first) = imported.without_box.first() {
        let count = imported.without_box.len();
        say!("note: {count} photos have no box of the model and are left out (the first: {first})");
    }
    let mut variants: BTreeMap<&str, usize> = BTreeMap::new();
    for photo in &imported.session.photos {
        *variants.entry(&photo.variant).or_default() += 1;
    }
    let variants: Vec<_> = variants.iter().map(|(name, count)| format!("{name} {count}")).collect();
    writeln!(
        out,
        "{}: {} photos ({}); score them with `scaleproof score {}`",
        imported.path.display(),
        imported.session.photos.len(),
        variants.join(", "),
        args.photos.display()
    )?;
    Ok(Outcome::Done)
}
