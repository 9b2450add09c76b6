//! `scaleproof detectors check`: what do the detectors find in some photos?

use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::{Looking, WithWeights};
use crate::cli::results::Programs;
use crate::cli::{CommandResult, Outcome, Result};
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{Detection, Detector, Manifest, ProgramDetector, ProgramPhoto, Runtime};
use scaleproof_photo::copies;
use scaleproof_photo::draw::{self, LabelAnchor, Lettering, Pen, RgbImage};
use scaleproof_photo::{Photo, PhotoError};

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    looking: Looking,
    #[command(flatten)]
    programs: Programs,
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

pub(super) fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
    if !(0.0..=1.0).contains(&args.confidence) {
        return Err(format!("--confidence is {}: give a number from 0 to 1", args.confidence).into());
    }
    let (names, programs) = args.programs.among(&args.looking.detectors)?;
    let photos = args.looking.photos()?;
    let networks = if names.is_empty() && !programs.is_empty() {
        Vec::new()
    } else {
        args.looking.networks(&names)?
    };
    let programs = args.programs.started(programs)?;
    // With --save: where the copy of each photo goes, and what is drawn in it.
    let places = |folder: &PathBuf| copies::places(folder, &args.looking.photos, "save", copy_name);
    let places = args.save.as_ref().map(places).transpose()?.unwrap_or_default();
    let mut marks: Vec<Vec<Mark>> = vec![Vec::new(); places.len()];
    let networks = networks.iter().map(Looker::Network);
    for (number, looker) in networks.chain(programs.iter().map(Looker::Program)).enumerate() {
        let manifest = &looker.manifest();
        let mut look = looker.opened()?;
        for (index, (path, photo)) in args.looking.photos.iter().zip(&photos).enumerate() {
            let mut found = look(path, photo)?;
            found.retain(|d| d.score >= args.confidence);
            if let Some(marks) = marks.get_mut(index) {
                marks.extend(found.iter().map(|d| (number, d.box_px, text(manifest, d))));
            }
            if !args.json {
                writeln!(out, "{} on {}: {} found", manifest.title, path.display(), found.len())?;
            }
            let label_of = |d: &Detection| manifest.labels.name(d.label).unwrap_or("?");
            let width = found
                .iter()
                .map(|d| label_of(d).chars().count())
                .max()
                .unwrap_or(0)
                .max(14);
            for d in &found {
                let label = label_of(d);
                let line = DetectionLine {
                    detector: &manifest.name,
                    file: path.display().to_string(),
                    label,
                    counts_as: manifest.counts_as(d.label).filter(|counted| *counted != label),
                    score: d.score,
                    box_px: d.box_px,
                };
                let words = if args.json {
                    serde_json::to_string(&line)?
                } else {
                    row(&line, width)
                };
                writeln!(out, "{words}")?;
            }
        }
    }
    for ((place, photo), marks) in places.iter().zip(&photos).zip(&marks) {
        copies::write(place, &drawn(photo, marks)?)?;
        // As JSON each line is a detection.
        if !args.json {
            writeln!(out, "{}", place.display())?;
        }
    }
    Ok(Outcome::Done)
}

/// Detector of photos: a network or a program.
enum Looker<'a> {
    Network(&'a WithWeights),
    Program(&'a ProgramDetector),
}

/// From a photo and its path to what is found in it.
type Look<'a> = Box<dyn FnMut(&Path, &Photo) -> Result<Vec<Detection>> + 'a>;

impl<'a> Looker<'a> {
    fn manifest(&self) -> Manifest {
        match self {
            Looker::Network((manifest, _)) => manifest.clone(),
            Looker::Program(program) => Manifest::of_foreign(program.card()),
        }
    }

    fn opened(self) -> Result<Look<'a>> {
        Ok(match self {
            Looker::Network((manifest, weights)) => {
                let mut detector = Detector::open(Runtime::load()?, manifest, weights)?;
                Box::new(move |_, photo| {
                    // Reduced as `score` reduces it, so that both say the same.
                    let image = photo.rgb(photo.reduction(manifest.least_px(photo.width, photo.height)))?;
                    Ok(detector.detect_reduced(&image, photo.width, photo.height)?)
                })
            }
            Looker::Program(program) => Box::new(|path, photo| {
                let pixels = program.takes_pixels().then(|| photo.rgb(1)).transpose()?;
                Ok(program.detect(&ProgramPhoto {
                    path,
                    file: &path.display().to_string(),
                    size: [photo.width, photo.height],
                    pixels: pixels.as_ref(),
                })?)
            }),
        })
    }
}

/// Colours of the detectors, in their order; told apart by the colour-blind (Okabe & Ito 2008).
const COLOURS: [[u8; 3]; 6] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [213, 94, 0],
    [204, 121, 167],
];

/// A box in a photo: the number of its detector, and what it is called.
type Mark = (usize, BoxPx, String);

/// The name of a copy, numbered where two photos have the same name.
fn copy_name(stem: &str, number: u32) -> String {
    let number = if number == 1 { "" } else { &format!("_{number}") };
    format!("{stem}_detections{number}.jpg")
}

fn drawn(photo: &Photo, marks: &[Mark]) -> Result<RgbImage, PhotoError> {
    let mut image = photo.rgb(1)?;
    let (width_px, size_px) = draw::readable_px(&image);
    for (detector, box_px, text) in marks {
        let colour = COLOURS[detector % COLOURS.len()];
        // A box counts from the image's edge, a drawing from the middle of its first pixel.
        let [left, top, right, bottom] = [box_px.x1, box_px.y1, box_px.x2, box_px.y2].map(|v| v - 0.5);
        draw::rectangle(&mut image, [left, top], [right, bottom], Pen { colour, width_px });
        let (colour, ground) = ([0; 3], colour);
        let lettering = Lettering {
            colour,
            ground,
            size_px,
        };
        draw::label(&mut image, [left, top], LabelAnchor::BottomLeft, text, lettering);
    }
    Ok(image)
}

/// As in "yolox_nano: car 0.87".
fn text(manifest: &Manifest, d: &Detection) -> String {
    let label = manifest.labels.name(d.label).unwrap_or("?");
    format!("{}: {label} {:.2}", manifest.name, d.score)
}

fn row(line: &DetectionLine, width: usize) -> String {
    let b = line.box_px;
    let counted = line
        .counts_as
        .map_or(String::new(), |name| format!("  counts as {name}"));
    format!(
        "  {:<width$} {:.3}  [{:.0}, {:.0}, {:.0}, {:.0}]{counted}",
        line.label, line.score, b.x1, b.y1, b.x2, b.y2
    )
}
