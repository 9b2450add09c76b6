//! `scaleproof colour`: what the printer makes of colours, read in a photo of the chart.

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;
use schemars::JsonSchema;
use serde::Serialize;

use super::{CommandResult, Outcome, Result, photos, progress};
use scaleproof_core::files;
use scaleproof_photo::Photo;
use scaleproof_pose::tags::AprilTagC;
use scaleproof_print::colour_chart::read::{ChartReading, FAMILIES, Quality, average, read};
use scaleproof_print::printer::{Printer, PrinterFile};
use scaleproof_surface::pattern::printed::PrintedColours;

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Read the chart of `print chart` in photos of it
    ///
    /// Several photos of one print are averaged. Colours are relative to the paper's white under the photo's light; the
    /// camera's own tone curve and colours cannot be separated from the printer's and stay in them.
    Read(ReadArgs),
}

#[derive(clap::Args)]
pub(crate) struct ReadArgs {
    /// Photos of one print (JPEG or PNG), or folders of them; they are never changed
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// The printer file to put the colours in; the lengths of one that is there are kept
    #[arg(short, long, value_name = "TOML")]
    output: Option<PathBuf>,
    /// One JSON object instead of a summary
    #[arg(long)]
    json: bool,
}

/// A photo in `--json`.
#[derive(Serialize, JsonSchema)]
struct PhotoLine {
    file: String,
    sha256: String,
    #[serde(flatten)]
    quality: Quality,
    /// Mean ΔE2000 of its patches from the mean of all photos.
    delta_e_from_mean: f64,
}

/// `colour read --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer<'a> {
    photos: Vec<PhotoLine>,
    /// The table `[colour]` of printer.toml.
    colour: &'a PrintedColours,
}

/// Runs `scaleproof colour …`.
pub(crate) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    let Command::Read(mut args) = command;
    args.photos = photos::of(&args.photos)?;
    // A file that is there already must be a printer file, or it would be lost.
    let there = args.output.as_deref().filter(|path| path.exists());
    there.iter().for_each(|path| files::inputs::own(path));
    let old = there.map(PrinterFile::load).transpose()?;
    let mut tags = AprilTagC::new(&FAMILIES)?;
    let readings = progress::photos("reading", args.photos.len()).during(|bar| {
        let readings = args.photos.iter().map(|path| {
            let reading = read(&Photo::open(path)?, &mut tags)?;
            bar.inc(1);
            Ok(reading.map_err(|e| format!("{}: {e}", path.display()))?)
        });
        readings.collect::<Result<Vec<ChartReading>>>()
    })?;
    let (colours, disagreements) = average(&readings, concat!("scaleproof ", env!("CARGO_PKG_VERSION")))?;
    if let Some(path) = &args.output {
        let file = PrinterFile {
            printer: old.as_ref().map_or(Printer::EXACT, |file| file.printer),
            colours: Some(colours.clone()),
        };
        files::write_atomically(path, file.to_toml()?.as_bytes())?;
    }
    if args.json {
        let photos = args.photos.iter().zip(&readings).zip(&disagreements);
        let line = |((path, reading), off): ((&PathBuf, &ChartReading), &f64)| PhotoLine {
            file: path.display().to_string(),
            sha256: reading.sha256.clone(),
            quality: reading.quality,
            delta_e_from_mean: *off,
        };
        let answer = Answer {
            photos: photos.map(line).collect(),
            colour: &colours,
        };
        writeln!(out, "{}", serde_json::to_string(&answer)?)?;
    } else {
        summarise(&args, &readings, &disagreements, &colours, out)?;
        if let Some(path) = &args.output {
            let replaced = old.is_some_and(|file| file.colours.is_some());
            let verb = if replaced { "new colours in" } else { "written to" };
            let path = path.display();
            writeln!(
                out,
                "{verb} {path}; next: scaleproof pattern check P.png --printer {path}"
            )?;
        }
    }
    Ok(Outcome::Done)
}

fn summarise(
    args: &ReadArgs,
    readings: &[ChartReading],
    disagreements: &[f64],
    colours: &PrintedColours,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    for ((path, reading), off) in args.photos.iter().zip(readings).zip(disagreements) {
        let q = &reading.quality;
        let name = path.display();
        let light = format!("light {:?} within {:.1} %", q.light, 100.0 * q.light_error).to_lowercase();
        let flat = format!("patches of {:.0} px, flat within {:.2} mm", q.patch_px, q.off_mm);
        writeln!(
            out,
            "{name}: chart {}, {flat}, {light}, ΔE2000 {off:.2} from the mean",
            colours.chart
        )?;
        if let count @ 1.. = q.at_zero {
            say!("note: {count} patches of {name} have a channel at 0; they may be darker or more saturated than read");
        }
    }
    let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    writeln!(
        out,
        "mean ΔE2000 between asked and printed: {:.1}\n\
         gamut: {:.0} cubic CIELAB units, {:.0} % of sRGB; darkest {}, most saturated {}\n\
         greys between the levels are met within ΔE2000 {:.1} by interpolating\n\
         Relative to the paper's white in this light; the camera's own tone curve and colours are in the figures and cannot be separated \
         from the printer's.",
        colours.delta_e_mean,
        colours.gamut_volume_lab,
        100.0 * colours.gamut_share_of_srgb,
        hex(colours.darkest_rgb),
        hex(colours.most_saturated_rgb),
        colours.interpolation_delta_e_mean
    )
}
