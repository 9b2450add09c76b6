//! `scaleproof detectors`: which detectors there are, where their weights come from, and whether they work.

mod add;
mod check;
mod registry;
mod speed;
mod validate;

pub(crate) use scaleproof_detect::choose as chosen;

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::answer::{Named, answer, named};
use crate::cli::{CommandResult, Outcome, Result, advice, full, photos};
use scaleproof_detect::{Manifest, WeightFolders, WeightsError, registered, registered_names};
use scaleproof_photo::Photo;

#[derive(Subcommand)]
pub(super) enum Command {
    /// Every known detector: licence, origin, and where its weights lie.
    List(ListArgs),
    #[command(flatten)]
    Full(full::DetectorsCommand),
    /// Run every detector whose weights are present on some photos and print what it finds.
    Check(check::Args),
    /// Write the manifest of a detector of your own from its ONNX file, or say what the file does not tell.
    ///
    /// The network is run on a grey image and on noise; its outputs tell the family. How a photo is to be prepared no file
    /// says: the family's usual way is written, to be compared with the program that the weights come from.
    Add(add::Args),
    Speed(speed::Args),
    Validate(validate::Args),
    /// Put a detector of your own on the list, so that `--detector NAME` finds it from everywhere.
    Register(registry::RegisterArgs),
    /// Take a registered detector off the list; its files stay.
    Remove(registry::RemoveArgs),
}

/// Where weights are.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct Folder {
    /// Folder with weights; looked up before $SCALEPROOF_DETECTORS, $SCALEPROOF_SHARED/detectors and the user's cache.
    #[arg(long = "detectors", value_name = "DIR")]
    pub(super) weights_folder: Option<PathBuf>,
}

impl Folder {
    /// The folders to look in; a named one must be there.
    pub(super) fn folders(&self) -> Result<WeightFolders, String> {
        match &self.weights_folder {
            Some(folder) if !folder.is_dir() => {
                Err(format!("--detectors {}: there is no such folder", folder.display()))
            }
            named => Ok(WeightFolders::new(named.clone())),
        }
    }
}

/// Photos, and the detectors that look at them.
#[derive(clap::Args)]
struct Looking {
    /// Photos (JPEG or PNG), or folders of them.
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// Only this detector; may be given several times, or as a list with commas.
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',')]
    detectors: Vec<String>,
    #[command(flatten)]
    folder: Folder,
}

type WithWeights = (Manifest, PathBuf);

impl Looking {
    fn open(&mut self) -> Result<(Vec<WithWeights>, Vec<Photo>)> {
        Ok((self.networks(&self.detectors)?, self.photos()?))
    }

    fn networks(&self, names: &[String]) -> Result<Vec<WithWeights>> {
        let folders = self.folder.folders()?;
        let manifests = present(names, &folders)?.into_iter();
        let detectors = manifests.map(|manifest| folders.checked(&manifest).map(|weights| (manifest, weights)));
        Ok(detectors.collect::<Result<_, WeightsError>>()?)
    }

    /// Opens the photos; those of named folders are named one by one from then on.
    fn photos(&mut self) -> Result<Vec<Photo>> {
        self.photos = photos::of(&self.photos)?;
        let photos = self.photos.iter().map(|path| Photo::open(path));
        Ok(photos.collect::<Result<_, _>>()?)
    }
}

#[derive(clap::Args)]
pub(crate) struct ListArgs {
    #[command(flatten)]
    folder: Folder,
    /// One JSON object a line.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::List(args) => list(args, out),
        Command::Full(command) => full::detectors(command, out),
        Command::Check(args) => check::run(args, out),
        Command::Add(args) => add::run(args, out),
        Command::Speed(args) => speed::run(args, out),
        Command::Validate(args) => validate::run(args, out),
        Command::Register(args) => registry::register(&args, out),
        Command::Remove(args) => registry::remove(&args, out),
    }
}

/// Those that ship with the program, then the registered ones; one whose manifest cannot be read any more is named in a note.
fn all() -> Result<Vec<Manifest>> {
    let mut all = Manifest::all()?;
    for name in registered_names() {
        match registered(&name) {
            Ok(manifest) => all.extend(manifest),
            Err(e) => say!("note: {}", advice::sentence(&e)),
        }
    }
    Ok(all)
}

/// `detectors list --json`: one object a line for each known detector.
#[derive(Serialize, JsonSchema)]
pub(super) struct Listed {
    /// Of the manifest, like the next five.
    name: String,
    title: String,
    licence: String,
    origin: String,
    url: String,
    sha256: String,
    /// Where the weights are; `null` when they are not here, or not the described file.
    path: Option<PathBuf>,
    /// Whether it is on your own list (`detectors register`, `detectors add --register`).
    registered: bool,
}

fn list(args: ListArgs, out: &mut dyn Write) -> CommandResult {
    let folders = args.folder.folders()?;
    let mut rows = vec![["name", "detector", "licence", "sha256", "weights"].map(str::to_owned)];
    for m in all()? {
        let checked = folders.checked(&m);
        if args.json {
            let listed = Listed {
                registered: m.folder.is_some(),
                name: m.name,
                title: m.title,
                licence: m.licence,
                origin: m.origin,
                url: m.weights.url,
                sha256: m.weights.sha256,
                path: checked.ok(),
            };
            answer(&listed, out)?;
        } else {
            let place = match checked {
                Ok(path) => path.display().to_string(),
                Err(WeightsError::WrongHash { files, .. }) => format!("not the described file: {files}"),
                Err(e) if m.weights.url.is_empty() => advice::sentence(&e),
                Err(_) => "not here: scaleproof detectors fetch".into(),
            };
            rows.push([m.name, m.title, m.licence, m.weights.sha256[..12].to_owned(), place]);
        }
    }
    if !args.json {
        let longest = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
        let [a, b, c, d] = [(0, 14), (1, 17), (2, 13), (3, 12)].map(|(i, least)| longest(i).unwrap_or(0).max(least));
        for [name, title, licence, sha256, place] in &rows {
            writeln!(out, "{name:<a$} {title:<b$} {licence:<c$} {sha256:<d$} {place}")?;
        }
    }
    Ok(Outcome::Done)
}

/// The weights of a detector: those already there when they are the right ones, else downloaded.
pub(super) fn fetch_one(manifest: &Manifest, folders: &WeightFolders) -> Result<PathBuf> {
    if let Ok(path) = folders.checked(manifest) {
        return Ok(path);
    }
    full::download(manifest, folders)
}

/// The named detectors, or all whose weights are here.
pub(super) fn present(names: &[String], folders: &WeightFolders) -> Result<Vec<Manifest>> {
    let mut manifests = chosen(names)?;
    if names.is_empty() {
        manifests.retain(|m| folders.find(m).is_some());
    }
    if manifests.is_empty() {
        Err("no detector's weights are here: get them with `scaleproof detectors fetch`".into())
    } else {
        Ok(manifests)
    }
}

pub(super) fn schemas() -> Vec<Named> {
    vec![
        named::<add::Added>("detectors-add"),
        named::<check::DetectionLine>("detectors-check"),
        named::<Listed>("detectors-list"),
        named::<validate::Validated>("detectors-validate"),
    ]
}
