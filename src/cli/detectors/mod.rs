//! `scaleproof detectors`: which detectors there are, where their weights come from, and whether they work.

mod add;
mod speed;

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use serde::Serialize;

use crate::cli::{CommandResult, Outcome, progress};
use crate::detect::{self, Detector, Manifest, Runtime, WeightFolders, WeightsError};
use crate::geometry::BoxPx;
use crate::photo::PhotoFile;

/// List, fetch, try out and add object detectors.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Every known detector: licence, origin, and where its weights lie.
    List(ListArgs),
    /// Download weights, verify their SHA-256, go on with a broken download.
    #[cfg(feature = "full")]
    Fetch(FetchArgs),
    /// Run every detector whose weights are present on some photos and print what it finds.
    Check(CheckArgs),
    /// Write the manifest of a detector of your own from its ONNX file, or say what the file does not tell.
    ///
    /// The network is run on a grey picture and on noise; its outputs tell the family. How a photo is to be prepared no file
    /// says: the family's usual way is written, to be compared with the program that the weights come from.
    Add(add::Args),
    Speed(speed::Args),
}

/// Where weights are.
#[derive(Debug, Clone, clap::Args)]
pub struct Folder {
    /// Folder with weights; looked up before $SCALEPROOF_DETECTORS, $SCALEPROOF_SHARED/detectors and the user's cache.
    #[arg(long = "detectors", value_name = "DIR")]
    weights_folder: Option<PathBuf>,
}

impl Folder {
    /// The folders to look in; a named one must be there.
    pub fn folders(&self) -> Result<WeightFolders, String> {
        match &self.weights_folder {
            Some(folder) if !folder.is_dir() => {
                Err(format!("--detectors {}: there is no such folder", folder.display()))
            }
            named => Ok(WeightFolders::new(named.clone())),
        }
    }
}

#[derive(clap::Args)]
struct ListArgs {
    #[command(flatten)]
    folder: Folder,
    /// One JSON object a line.
    #[arg(long)]
    json: bool,
}

#[cfg(feature = "full")]
#[derive(clap::Args)]
struct FetchArgs {
    /// Which detectors; all when none is named.
    names: Vec<String>,
    #[command(flatten)]
    folder: Folder,
}

#[derive(clap::Args)]
struct CheckArgs {
    /// Photos (JPEG or PNG).
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// Only this detector; may be given several times, or as a list with commas.
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',')]
    detectors: Vec<String>,
    #[command(flatten)]
    folder: Folder,
    /// Boxes below this confidence are not printed.
    #[arg(long, default_value_t = 0.3)]
    confidence: f64,
    /// One JSON object a line.
    #[arg(long)]
    json: bool,
}

pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.command {
        Command::List(args) => list(args, out),
        #[cfg(feature = "full")]
        Command::Fetch(args) => fetch(args, out),
        Command::Check(args) => check(args, out),
        Command::Add(args) => add::run(args, out),
        Command::Speed(args) => speed::run(args, out),
    }
}

/// The named detectors, or all that ship with the program; a name that ends in `.toml` is a manifest of the user's own.
pub fn chosen(names: &[String]) -> CommandResultOf<Vec<Manifest>> {
    if names.is_empty() {
        return Ok(Manifest::all()?);
    }
    let mut manifests: Vec<Manifest> = Vec::new();
    for name in names {
        let manifest = match name.ends_with(".toml") {
            true => Manifest::open(Path::new(name))?,
            false => Manifest::named(name)?,
        };
        if !manifests.contains(&manifest) {
            manifests.push(manifest);
        }
    }
    Ok(manifests)
}

type CommandResultOf<T> = Result<T, Box<dyn std::error::Error>>;

fn list(args: ListArgs, out: &mut dyn Write) -> CommandResult {
    let folders = args.folder.folders()?;
    if !args.json {
        writeln!(
            out,
            "{:<14} {:<17} {:<13} {:<12} weights",
            "name", "detector", "licence", "sha256"
        )?;
    }
    for m in Manifest::all()? {
        let checked = folders.checked(&m);
        if args.json {
            let line = serde_json::json!({
                "name": m.name, "title": m.title, "licence": m.licence, "origin": m.origin, "url": m.weights.url,
                "sha256": m.weights.sha256, "path": checked.ok(),
            });
            writeln!(out, "{line}")?;
        } else {
            let place = match checked {
                Ok(path) => path.display().to_string(),
                Err(WeightsError::WrongHash { path, .. }) => format!("not the described file: {}", path.display()),
                Err(_) => "not here: scaleproof detectors fetch".into(),
            };
            writeln!(
                out,
                "{:<14} {:<17} {:<13} {:<12} {place}",
                m.name,
                m.title,
                m.licence,
                &m.weights.sha256[..12]
            )?;
        }
    }
    Ok(Outcome::Done)
}

#[cfg(feature = "full")]
fn fetch(args: FetchArgs, out: &mut dyn Write) -> CommandResult {
    let folders = WeightFolders::new(args.folder.weights_folder);
    for manifest in chosen(&args.names)? {
        let path = fetch_one(&manifest, &folders)?;
        writeln!(out, "{:<14} {}", manifest.name, path.display())?;
    }
    Ok(Outcome::Done)
}

/// The weights of a detector: those already there when they are the right ones, else downloaded.
pub fn fetch_one(manifest: &Manifest, folders: &WeightFolders) -> CommandResultOf<PathBuf> {
    if let Ok(path) = folders.checked(manifest) {
        return Ok(path);
    }
    download(manifest, folders)
}

#[cfg(not(feature = "full"))]
fn download(manifest: &Manifest, _: &WeightFolders) -> CommandResultOf<PathBuf> {
    let name = &manifest.name;
    Err(format!("the weights of {name} are not here; `./run detectors fetch` gets them").into())
}

#[cfg(feature = "full")]
fn download(manifest: &Manifest, folders: &WeightFolders) -> CommandResultOf<PathBuf> {
    let bar = progress::bytes(&manifest.name);
    let fetched = detect::fetch(manifest, &folders.download_folder()?, &|done, total| {
        if let Some(total) = total {
            bar.set_length(total);
        }
        bar.set_position(done);
    });
    bar.finish_and_clear();
    Ok(fetched?)
}

/// The named detectors, or all whose weights are here.
pub fn present(names: &[String], folders: &WeightFolders) -> CommandResultOf<Vec<Manifest>> {
    let mut manifests = chosen(names)?;
    if names.is_empty() {
        manifests.retain(|m| folders.find(m).is_some());
    }
    match manifests.is_empty() {
        true => Err("no detector's weights are here: get them with `scaleproof detectors fetch`".into()),
        false => Ok(manifests),
    }
}

/// One line of `check --json`.
#[derive(Serialize)]
struct Line<'a> {
    detector: &'a str,
    file: String,
    label: &'a str,
    score: f64,
    /// x1, y1, x2, y2.
    box_px: BoxPx,
}

fn check(args: CheckArgs, out: &mut dyn Write) -> CommandResult {
    if !(0.0..=1.0).contains(&args.confidence) {
        return Err(format!("--confidence is {}: give a number from 0 to 1", args.confidence).into());
    }
    let folders = args.folder.folders()?;
    let manifests = present(&args.detectors, &folders)?;
    let photos = args
        .photos
        .iter()
        .map(|p| PhotoFile::open(p))
        .collect::<Result<Vec<_>, _>>()?;
    let runtime = Runtime::load()?;
    for manifest in &manifests {
        let mut detector = Detector::open(runtime, manifest, &folders.checked(manifest)?)?;
        for (path, photo) in args.photos.iter().zip(&photos) {
            // Reduced as `score` reduces it, so that both say the same.
            let picture = photo.rgb(photo.reduction(manifest.least_px(photo.width, photo.height)))?;
            let mut found = detector.detect_reduced(&picture, photo.width, photo.height)?;
            found.retain(|d| d.score >= args.confidence);
            if !args.json {
                writeln!(out, "{} on {}: {} found", manifest.title, path.display(), found.len())?;
            }
            for d in &found {
                let label = manifest.labels.name(d.label).unwrap_or("?");
                let file = path.display().to_string();
                let line = Line {
                    detector: &manifest.name,
                    file,
                    label,
                    score: d.score,
                    box_px: d.box_px,
                };
                writeln!(
                    out,
                    "{}",
                    if args.json {
                        serde_json::to_string(&line)?
                    } else {
                        row(&line)
                    }
                )?;
            }
        }
    }
    Ok(Outcome::Done)
}

fn row(line: &Line) -> String {
    let b = line.box_px;
    format!(
        "  {:<14} {:.3}  [{:.0}, {:.0}, {:.0}, {:.0}]",
        line.label, line.score, b.x1, b.y1, b.x2, b.y2
    )
}
