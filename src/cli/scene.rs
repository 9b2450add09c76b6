//! `scaleproof scene`: make a scene file.

use std::io::Write;
use std::path::PathBuf;

use clap::{Subcommand, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;

use super::answer::{told, written};
use super::{CommandResult, units};
use scaleproof_core::geometry::length::parse_sides_mm;
use scaleproof_core::{files, spelling};
use scaleproof_pose::scene::{Bins, Classes, Envelope, ScaleModel, Scene, TagFamily, TagRing};

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Write a scene.toml for tags that `print tags` then prints
    New(NewArgs),
}

#[derive(clap::Args)]
pub(crate) struct NewArgs {
    /// How the tags stand; ring: tent cards in a circle, the first before the model's front, and flat tags along the model's sides
    #[arg(long, value_enum)]
    preset: Preset,
    /// Radius of the ring in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    radius_mm: f64,
    /// Tent cards in the ring, and as many flat tags
    #[arg(long, value_name = "N", default_value_t = 8)]
    tags: u32,
    /// Outer edge of a tag's black border in mm
    #[arg(long, value_name = "MM", default_value_t = 50.0, allow_negative_numbers = true)]
    tag_mm: f64,
    /// tag36h11, tag16h5, tag25h9, tagstandard41h12, tagstandard52h13, tagcircle21h7, tagcircle49h12 or tagcustom48h12
    #[arg(long, default_value = "tag36h11", value_parser = family)]
    family: TagFamily,
    /// Between the faces of the tent cards and the ground
    #[arg(long, value_name = "DEG", default_value_t = 60.0, allow_negative_numbers = true)]
    tilt_deg: f64,
    /// Length, width and height of the printed model in mm, as in 455x186x128
    #[arg(long, value_name = "LxWxH", value_parser = model_size, allow_hyphen_values = true)]
    model_size_mm: [f64; 3],
    /// What the model is called
    #[arg(long, default_value = "model")]
    name: String,
    /// The label that counts as the model, or several, as in car,truck
    #[arg(long, value_name = "LABEL,…", default_value = "car")]
    class: Classes,
    /// The model is 1:SCALE
    #[arg(long, default_value_t = 10.0, allow_negative_numbers = true)]
    scale: f64,
    /// Step of the azimuth bins in degrees
    #[arg(long, value_name = "DEG", default_value_t = 45.0, allow_negative_numbers = true)]
    bins_azimuth_deg: f64,
    /// Centres of the pitch bins in degrees
    #[arg(
        long,
        value_name = "DEG,…",
        value_delimiter = ',',
        default_value = "0,15,30",
        allow_hyphen_values = true
    )]
    bins_pitch_deg: Vec<f64>,
    /// Centres of the distance bins in mm
    #[arg(
        long,
        value_name = "MM,…",
        value_delimiter = ',',
        default_value = "500,1000,1500",
        allow_hyphen_values = true
    )]
    bins_distance_mm: Vec<f64>,
    /// The scene file to write
    #[arg(short, long, value_name = "TOML")]
    output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Preset {
    Ring,
}

pub(super) fn family(text: &str) -> Result<TagFamily, String> {
    let known = TagFamily::ALL.iter().find(|(_, name)| name.eq_ignore_ascii_case(text));
    known.map(|(family, _)| *family).ok_or_else(|| {
        let names: Vec<_> = TagFamily::ALL.iter().map(|(_, name)| *name).collect();
        let hint = spelling::hint(text, names.iter().copied());
        format!("use one of {}{hint}", names.join(", "))
    })
}

fn model_size(text: &str) -> Result<[f64; 3], String> {
    let sizes = parse_sides_mm(text);
    sizes.ok_or_else(|| "write length, width and height, as in 455x186x128".to_owned())
}

/// Runs `scaleproof scene …`.
pub(crate) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    let Command::New(args) = command;
    let path = &args.output;
    // A scene may have been measured and typed in by hand; that is not lost to a second `new`.
    if path.exists() {
        return Err(format!("{} is there already; give another name or remove it", path.display()).into());
    }
    let Preset::Ring = args.preset;
    let ring = TagRing {
        model: ScaleModel {
            name: args.name,
            scale: args.scale,
            class: args.class,
            size_mm: args.model_size_mm,
            envelope: Envelope::Box,
        },
        bins: Bins {
            azimuth_deg: args.bins_azimuth_deg,
            pitch_deg: args.bins_pitch_deg,
            distance_mm: args.bins_distance_mm,
        },
        radius_mm: args.radius_mm,
        count: args.tags,
        tag_mm: args.tag_mm,
        family: args.family,
        tilt_deg: args.tilt_deg,
    };
    let doubt = units::model(ring.model.class.labels(), ring.model.size_mm, ring.model.scale);
    let scene = ring.scene()?;
    let text = scene.to_toml();
    // What is written can be read.
    Scene::parse(&text, path)?;
    let new = [(path.clone(), text.into_bytes())];
    files::write_all_atomically(&new)?;
    units::note(doubt);
    let (path, count, radius) = (path.display(), args.tags, args.radius_mm);
    let words = format_args!(
        "{path}: {count} tent cards on a ring of {radius} mm and {count} flat tags; print them with `scaleproof print tags`"
    );
    let tags = scene.tags.len();
    told(args.json, written(&new, Answer { tags }), words, out)
}

/// `scene new --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct Answer {
    /// How many.
    tags: usize,
}
