//! `scaleproof texture`: textures as images for simulators, and as previews.

use std::io::Write;

use crate::cli::answer::{told, written};
use crate::cli::args::textures::{BakeArgs, Command, GREY, ShowArgs};
use crate::cli::print::textures::{Baked, Shown};
use crate::cli::resolve::attack::render::{azimuths, size};
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_core::spelling::count;
use scaleproof_frames::encode_rgb;
use scaleproof_frames::shaded::{FIELD_OF_VIEW_DEG, ShadedModel, side_by_side};
use scaleproof_surface::model::Model;
use scaleproof_surface::texture::{MappedImages, Texture};
use scaleproof_wrap::bake::{BakeRequest, TexturedModel, bake, write_glb, write_obj};

/// Runs `scaleproof texture …`.
pub fn run(command: &Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Bake(args) => run_bake(args, out),
        Command::Show(args) => run_show(args, out),
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
        vec![(args.output.clone(), encode_rgb(&side_by_side(&views, 4))?)]
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

/// Returns the textures of what is not paint, from the mesh's file: one for all; if a material has no image, one for each material, grey for these.
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
