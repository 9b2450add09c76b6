//! `scaleproof detectors check`: what do the detectors find in some photos?

use schemars::JsonSchema;
use std::io::Write;
use std::path::PathBuf;

use serde::Serialize;

use super::{Looking, drawn};
use crate::cli::Result;
use crate::cli::copies::CopiesError;
use crate::cli::{CommandResult, Outcome};
use scaleproof_core::files;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{Detection, Detector, Manifest, Runtime};
use scaleproof_photo::photo::Photo;

#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    looking: Looking,
    /// Boxes below this confidence are not printed.
    #[arg(long, default_value_t = 0.3)]
    confidence: f64,
    /// Folder for copies of the photos with the boxes, labels and confidences drawn in.
    #[arg(long, value_name = "DIR")]
    save: Option<PathBuf>,
    /// One JSON object a line.
    #[arg(long)]
    json: bool,
}

/// `detectors check --json`: one object a line for each detection.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct DetectionLine<'a> {
    detector: &'a str,
    file: String,
    label: &'a str,
    /// Where the manifest's `[class_map]` has another name for the label.
    #[serde(skip_serializing_if = "Option::is_none")]
    counts_as: Option<&'a str>,
    /// Confidence, 0 to 1.
    score: f64,
    /// Left, top, right, bottom, pixels.
    box_px: BoxPx,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    if !(0.0..=1.0).contains(&args.confidence) {
        return Err(format!("--confidence is {}: give a number from 0 to 1", args.confidence).into());
    }
    let (detectors, photos) = args.looking.open()?;
    let mut saved = Saved::new(&args)?;
    let runtime = Runtime::load()?;
    for (number, (manifest, weights)) in detectors.iter().enumerate() {
        let mut detector = Detector::open(runtime, manifest, weights)?;
        for (index, (path, photo)) in args.looking.photos.iter().zip(&photos).enumerate() {
            // Reduced as `score` reduces it, so that both say the same.
            let image = photo.rgb(photo.reduction(manifest.least_px(photo.width, photo.height)))?;
            let mut found = detector.detect_reduced(&image, photo.width, photo.height)?;
            found.retain(|d| d.score >= args.confidence);
            if let Some(marks) = saved.marks.get_mut(index) {
                marks.extend(found.iter().map(|d| (number, d.box_px, text(manifest, d))));
            }
            if !args.json {
                writeln!(out, "{} on {}: {} found", manifest.title, path.display(), found.len())?;
            }
            for d in &found {
                let label = manifest.labels.name(d.label).unwrap_or("?");
                let counts_as = manifest.counts_as(d.label).filter(|counted| *counted != label);
                let file = path.display().to_string();
                let line = DetectionLine {
                    detector: &manifest.name,
                    file,
                    label,
                    counts_as,
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
    saved.write(&photos, out, args.json)?;
    Ok(Outcome::Done)
}

/// The copies for `--save`; nothing without it.
struct Saved {
    paths: Vec<PathBuf>,
    /// By the photo's number: detector, box and text of each detection.
    marks: Vec<Vec<(usize, BoxPx, String)>>,
}

impl Saved {
    fn new(args: &Args) -> Result<Saved, CopiesError> {
        let paths = match &args.save {
            None => Vec::new(),
            Some(folder) => drawn::places(folder, &args.looking.photos)?,
        };
        Ok(Saved {
            marks: vec![Vec::new(); paths.len()],
            paths,
        })
    }

    /// Draws and writes the copies; with `json` their paths are not printed, as each line there is a detection.
    fn write(&self, photos: &[Photo], out: &mut dyn Write, json: bool) -> Result<()> {
        for ((path, photo), marks) in self.paths.iter().zip(photos).zip(&self.marks) {
            let mut image = photo.rgb(1)?;
            for (detector, box_px, text) in marks {
                drawn::draw_box(&mut image, *box_px, text, drawn::colour(*detector));
            }
            files::replace_atomically(path, &drawn::jpeg(&image)?)?;
            if !json {
                writeln!(out, "{}", path.display())?;
            }
        }
        Ok(())
    }
}

/// As in "yolox_nano: car 0.87".
fn text(manifest: &Manifest, d: &Detection) -> String {
    let label = manifest.labels.name(d.label).unwrap_or("?");
    format!("{}: {label} {:.2}", manifest.name, d.score)
}

fn row(line: &DetectionLine) -> String {
    let b = line.box_px;
    let counted = line
        .counts_as
        .map_or(String::new(), |name| format!("  counts as {name}"));
    format!(
        "  {:<14} {:.3}  [{:.0}, {:.0}, {:.0}, {:.0}]{counted}",
        line.label, line.score, b.x1, b.y1, b.x2, b.y2
    )
}
