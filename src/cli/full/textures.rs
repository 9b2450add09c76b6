//! `scaleproof texture`: textures as images for simulators, and as previews.

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;
use schemars::JsonSchema;
use serde::Serialize;

use super::attack::{azimuths, size};
use crate::cli::answer::{told, written};
use crate::cli::args::model::ModelArgs;
use crate::cli::full::patch::{PlaceArgs, asked, placed};
use crate::cli::full::texture::TextureArgs;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_core::spelling::count;
use scaleproof_frames::encode_rgb;
use scaleproof_frames::shaded::{FIELD_OF_VIEW_DEG, ShadedModel, side_by_side};
use scaleproof_surface::model::Model;
use scaleproof_surface::texture::{MappedImages, Texture};
use scaleproof_wrap::bake::{BakeRequest, TexturedModel, bake, write_glb, write_obj};

/// What has no colour of its own in a preview.
const GREY: [u8; 3] = [96; 3];
/// Below patches alone.
const PAPER: [u8; 3] = [255; 3];

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Write a pattern or texture as one image on texture coordinates, and the mesh that uses it: for CARLA, Unreal, Unity or Blender
    ///
    /// The mesh's own coordinates are kept where they can hold an image; where they are missing, overlap or leave the image, the paint is
    /// unwrapped anew. Beside the image come a .obj in the frame and unit of the mesh's file, its .mtl, and a .glb.
    Bake(Box<BakeArgs>),
    /// Draw the model in a pattern or texture from all around, without Blender
    Show(Box<ShowArgs>),
}

/// A painted model.
#[derive(clap::Args)]
struct PaintedArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    texture: TextureArgs,
    #[command(flatten)]
    places: PlaceArgs,
}

#[derive(clap::Args)]
pub(crate) struct BakeArgs {
    #[command(flatten)]
    painted: PaintedArgs,
    /// Width and height of the image in pixels, as in 2048 or 2448x2432
    #[arg(long, value_name = "PX", default_value = "2048")]
    size: String,
    /// Unwrap the paint anew even where the mesh's own coordinates can be kept
    #[arg(long)]
    unwrap: bool,
    /// The image; the .obj, .mtl and .glb beside it are called the same
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
pub(crate) struct ShowArgs {
    #[command(flatten)]
    painted: PaintedArgs,
    /// Azimuths in degrees, as in 0 45 90, or every so many degrees, as in every45
    #[arg(long, value_name = "DEG", num_args = 1.., default_value = "every45", allow_negative_numbers = true)]
    azimuth_deg: Vec<String>,
    #[arg(long, value_name = "DEG", default_value_t = 20.0, allow_negative_numbers = true)]
    pitch_deg: f64,
    /// Width and height of each view in pixels, as in 480x360
    #[arg(long, value_name = "PX", default_value = "480x360")]
    size_px: String,
    /// One .png with all views, or a folder for an image of each
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Runs `scaleproof texture …`.
pub(crate) fn run(command: &Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Bake(args) => run_bake(args, out),
        Command::Show(args) => run_show(args, out),
    }
}

impl PaintedArgs {
    fn load(&self) -> Result<(Model, Texture)> {
        let model = self.model.load_or(self.texture.mesh())?;
        if self.places.patch.is_empty() {
            let texture = self.texture.load(&model)?.texture;
            return Ok((model, texture));
        }
        let below = match self.texture.file() {
            None => Texture::Flat(PAPER),
            Some(_) => self.texture.load(&model)?.texture,
        };
        // Finished textures in their places, over another texture.
        let patches = placed(&asked(&self.places)?);
        Ok((model, Texture::Patches(Box::new(below), patches)))
    }
}

fn run_bake(args: &BakeArgs, out: &mut dyn Write) -> CommandResult {
    let (model, texture) = args.painted.load()?;
    let request = BakeRequest {
        mesh: &model.mesh,
        materials: &model.materials,
        texture: &texture,
        size_px: size(&args.size)?,
        unwrap: args.unwrap,
    };
    let baked = progress::busy("baking").during(|_| bake(&request))?;
    let png = encode_rgb(&baked.image)?;
    let textured = TexturedModel::new(&model.mesh, &model.materials, &baked, &png);
    let glb = write_glb(&model.mesh, &textured, &model.turn);
    let mut files = vec![(args.output.clone(), png)];
    files.extend(write_obj(&model.mesh, &textured, &args.output));
    files.push((args.output.with_extension("glb"), glb));
    files::write_beside(&[&args.output], &files)?;
    let names: Vec<String> = files.iter().map(|(path, _)| path.display().to_string()).collect();
    let (width, height) = baked.image.dimensions();
    let coordinates = match baked.unwrapped {
        None => "on the mesh's own texture coordinates".to_owned(),
        Some(why) => format!("on new texture coordinates, {why}"),
    };
    let words = format!(
        "{}: {width} × {height} px {coordinates}; {}, {:.2} mm a texel\nthe mesh that uses it: {}",
        names[0],
        count(baked.charts, "chart"),
        baked.texel_mm,
        names[1..].join(", ")
    );
    let facts = Baked {
        size_px: request.size_px,
        charts: baked.charts,
        texel_mm: baked.texel_mm,
        unwrapped: baked.unwrapped.map(|why| why.to_string()),
    };
    told(args.json, written(&files, facts), words, out)
}

fn run_show(args: &ShowArgs, out: &mut dyn Write) -> CommandResult {
    let (model, texture) = args.painted.load()?;
    let size_px = size(&args.size_px)?;
    let azimuths = azimuths(&args.azimuth_deg)?;
    let rest = rest(&model);
    let is_paint = |material: &usize| model.materials.is_empty() || model.materials.contains(material);
    let materials = 0..model.mesh.materials().len();
    let shaded = ShadedModel {
        mesh: &model.mesh,
        textures: materials
            .map(|m| {
                if is_paint(&m) {
                    &texture
                } else {
                    rest.get(m).unwrap_or(&rest[0])
                }
            })
            .collect(),
    };
    let (views, distance_mm) = progress::steps("drawing", azimuths.len())
        .during(|bar| shaded.around(&azimuths, args.pitch_deg, size_px, || bar.inc(1)))?;
    let is_one = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    let files = if is_one || files::is_standard_output(&args.output) {
        vec![(args.output.clone(), encode_rgb(&side_by_side(&views))?)]
    } else {
        let named = azimuths.iter().zip(&views);
        let file = |(azimuth, view)| Ok((args.output.join(format!("az{azimuth}.png")), encode_rgb(view)?));
        named.map(file).collect::<Result<Vec<_>>>()?
    };
    if is_one || files::is_standard_output(&args.output) {
        files::write_all_atomically(&files)?;
    } else {
        files::replace_all_atomically(&args.output, &files)?;
    }
    let words = format!("{}: {}", args.output.display(), count(views.len(), "view"));
    let facts = Shown {
        azimuth_deg: azimuths,
        pitch_deg: args.pitch_deg,
        distance_mm,
        field_of_view_deg: FIELD_OF_VIEW_DEG,
    };
    told(args.json, written(&files, facts), words, out)
}

/// `texture bake --json`; `files` are the image, the `.obj`, the `.mtl`, images of other materials, the `.glb`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Baked {
    /// Width and height.
    size_px: [u32; 2],
    /// Parts of the image whose paint hangs together.
    charts: usize,
    /// Side of a texel on the model, where it has the mean area.
    texel_mm: f64,
    /// Why the mesh's own texture coordinates are not kept.
    unwrapped: Option<String>,
}

/// `texture show --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Shown {
    /// Of the views, in their order.
    azimuth_deg: Vec<f64>,
    /// Of all of them.
    pitch_deg: f64,
    /// From the camera to the middle of the box around the model, at which all look.
    distance_mm: f64,
    /// Horizontal.
    field_of_view_deg: f64,
}

/// What is not paint: as the mesh's file has it, one texture for all; where a material has no image, a texture for each material, grey for these.
fn rest(model: &Model) -> Vec<Texture> {
    let images = |materials: &[usize]| {
        MappedImages::from_mesh(&model.mesh, materials).map(|mapped| Texture::Images(mapped.images))
    };
    let all = 0..model.mesh.materials().len();
    let is_rest = |material: &usize| !model.materials.contains(material);
    let rest: Vec<usize> = all.clone().filter(is_rest).collect();
    match images(&rest) {
        Ok(whole) => vec![whole],
        Err(_) => all
            .map(|material| images(&[material]).unwrap_or(Texture::Flat(GREY)))
            .collect(),
    }
}
