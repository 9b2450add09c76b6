//! `scaleproof detectors speed`: how many milliseconds does each detector take for a photo, on this machine?

use std::io::Write;
use std::path::PathBuf;

use super::{Folder, present};
use crate::cli::{CommandResult, Outcome};
use crate::detect::{self, ROUNDS, Runtime, Speeds};
use crate::files;
use crate::photo::Photo;

/// Time every detector whose weights are present, one thread, and keep the times in a file for `score --speed`.
///
/// The time runs from the decoded photo to its boxes; the fastest of twenty rounds counts for each photo.
#[derive(clap::Args)]
pub struct Args {
    /// Photos (JPEG or PNG), of the size that will be scored.
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// Only this detector; may be given several times, or as a list with commas.
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',')]
    detectors: Vec<String>,
    #[command(flatten)]
    folder: Folder,
    /// What to call the machine, e.g. "laptop, Core i5-1240P"; stands beside the chart.
    #[arg(long)]
    machine: String,
    /// The file of times.
    #[arg(short, long, alias = "out", value_name = "JSON")]
    output: PathBuf,
    /// The times as one JSON object instead of the text.
    #[arg(long)]
    json: bool,
}

pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let folders = args.folder.folders()?;
    let manifests = present(&args.detectors, &folders)?;
    let opened = args.photos.iter().map(|p| Photo::open(p)?.rgb(1));
    let photos = opened.collect::<Result<Vec<_>, _>>()?;
    let pixels: f64 = photos
        .iter()
        .map(|p| f64::from(p.width()) * f64::from(p.height()))
        .sum();
    let runtime = Runtime::load()?;
    let mut speeds = Speeds {
        machine: args.machine,
        scaleproof: env!("CARGO_PKG_VERSION").to_owned(),
        onnx_runtime: runtime.provenance(),
        threads: 1,
        rounds: ROUNDS,
        photos: photos.len(),
        megapixels: (pixels / 1e4 / photos.len() as f64).round() / 100.0,
        detectors: Vec::new(),
    };
    for manifest in &manifests {
        let speed = detect::measure(runtime, manifest, &folders.checked(manifest)?, &photos)?;
        let [fastest, slowest] = speed.ms_range;
        if !args.json {
            writeln!(
                out,
                "{:<14} {:>8.2} ms a photo ({fastest:.2} to {slowest:.2})",
                speed.detector, speed.ms_per_photo
            )?;
        }
        speeds.detectors.push(speed);
    }
    let text = serde_json::to_string_pretty(&speeds)? + "\n";
    files::write_atomically(&args.output, text.as_bytes())?;
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&speeds)?)?;
    }
    Ok(Outcome::Done)
}
