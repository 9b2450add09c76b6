//! `scaleproof scene`: make a scene file, and say what one says.

mod show;

use std::io::Write;
use std::path::PathBuf;

use clap::{Subcommand, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;

use super::answer::{told, written};
use super::full::SceneMesh;
use super::taken::{Taken, Wanted};
use super::{CommandResult, units};
use scaleproof_core::geometry::length::parse_sides_mm;
use scaleproof_core::{files, spelling};
use scaleproof_pose::scene::{Bins, Classes, Envelope, MeshFacts, ScaleModel, Scene, TagFamily, TagRing};
pub(super) use show::Shown;

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Write a scene.toml: the model, by its size or its mesh, and tags that `print tags` then prints
    ///
    /// Of a mesh the front, the top, the unit and the paint are found by its shape, its materials and its length, written into the scene, and shown
    /// in an image of six views beside it. Where two answers are equally good, the command asks. What you give wins over what is found.
    New(Box<NewArgs>),
    /// Say what a scene.toml says: the model, its mesh and paint, the tags, the bins
    Show(show::Args),
}

#[derive(clap::Args)]
pub(crate) struct NewArgs {
    /// How the tags stand; ring: tent cards in a circle, the first before the model's front, and flat tags along the model's sides
    #[arg(long, value_enum, default_value = "ring")]
    preset: Preset,
    /// Radius of the ring in mm; a scene of a mesh may go without tags
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    radius_mm: Option<f64>,
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
    model_size_mm: Option<[f64; 3]>,
    #[command(flatten)]
    mesh: SceneMesh,
    /// What the model is called [default: as the mesh's file, else model]
    #[arg(long)]
    name: Option<String>,
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
    match command {
        Command::New(args) => new(*args, out),
        Command::Show(args) => show::run(&args, out),
    }
}

fn new(args: NewArgs, out: &mut dyn Write) -> CommandResult {
    let path = &args.output;
    // A scene may have been measured and typed in by hand; that is not lost to a second `new`.
    if path.exists() {
        return Err(format!("{} is there already; give another name or remove it", path.display()).into());
    }
    let taken = match args.model_size_mm {
        _ if args.mesh.is_given() => Some(args.mesh.take(Wanted {
            class: &args.class,
            scale: args.scale,
            output: path,
        })?),
        Some(_) => None,
        None => return Err(NO_MODEL.into()),
    };
    let words = told_of(&args, taken.as_ref())?;
    let stem = taken.as_ref().and_then(|taken| taken.envelope.mesh()?.file_stem());
    let name = args
        .name
        .unwrap_or_else(|| stem.map_or("model".into(), |stem| stem.to_string_lossy().into_owned()));
    let (size_mm, envelope, mesh, preview) = match taken {
        Some(taken) => (taken.size_mm, taken.envelope, taken.mesh, Some(taken.preview)),
        None => (
            args.model_size_mm.unwrap_or_default(),
            Envelope::Box,
            MeshFacts::default(),
            None,
        ),
    };
    let model = ScaleModel {
        name,
        scale: args.scale,
        class: args.class,
        size_mm,
        envelope,
        mesh,
    };
    let bins = Bins {
        azimuth_deg: args.bins_azimuth_deg,
        pitch_deg: args.bins_pitch_deg,
        distance_mm: args.bins_distance_mm,
    };
    // Of a mesh it has been said already.
    let is_typed = model.envelope == Envelope::Box;
    let doubt = units::model(model.class.labels(), model.size_mm, model.scale).filter(|_| is_typed);
    let Preset::Ring = args.preset;
    let scene = match args.radius_mm {
        None => Scene {
            model,
            bins,
            tags: Vec::new(),
        },
        Some(radius_mm) => TagRing {
            model,
            bins,
            radius_mm,
            count: args.tags,
            tag_mm: args.tag_mm,
            family: args.family,
            tilt_deg: args.tilt_deg,
        }
        .scene()?,
    };
    let text = scene.to_toml();
    // Only a scene that can be read is written.
    Scene::parse(&text, path)?;
    let mut files = vec![(path.clone(), text.into_bytes())];
    files.extend(preview);
    files::write_beside(&[path], &files)?;
    units::note(doubt);
    let tags = scene.tags.len();
    told(args.json, written(&files, Answer { tags }), words, out)
}

const NO_MODEL: &str = "give the model's --mesh with its --length-mm, or its --model-size-mm";

fn told_of(args: &NewArgs, taken: Option<&Taken>) -> Result<String, &'static str> {
    let (path, count) = (args.output.display(), args.tags);
    let tags = match args.radius_mm {
        Some(radius) => format!(
            "{count} tent cards on a ring of {radius} mm and {count} flat tags; print them with `scaleproof print tags`"
        ),
        None if taken.is_some() => "no tags yet; for photos give --radius-mm too".to_owned(),
        None => return Err("give the radius of the ring of tags by --radius-mm, as in 400"),
    };
    let first = format!("{path}: {tags}");
    Ok(
        [vec![first], taken.map(|taken| taken.words.clone()).unwrap_or_default()]
            .concat()
            .join("\n"),
    )
}

/// `scene new --json`; `files` are the scene and, of a mesh, the image of its six views.
#[derive(Serialize, JsonSchema)]
pub(super) struct Answer {
    /// How many.
    tags: usize,
}
