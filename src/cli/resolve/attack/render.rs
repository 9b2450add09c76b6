//! Request of `attack render`, resolved from its arguments.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::cli::Result;
use crate::cli::args::attack::render::RenderArgs;
use crate::cli::args::model::ModelArgs;
use crate::cli::print::tile_mm;
use crate::cli::resolve::texture::load_texture;
use scaleproof_core::geometry::angle::wrap_360;
use scaleproof_frames::light;
use scaleproof_frames::render::{Panorama, ROUGHNESS, RenderPaint, RenderRequest};
use scaleproof_pose::scene::Viewpoint;
use scaleproof_surface::model::Model;
use scaleproof_surface::pattern::Pattern;
use scaleproof_wrap::bake::TriangleImage;

impl RenderArgs {
    pub fn request(&self) -> Result<RenderRequest> {
        let model = self.model.load()?;
        let mesh_file = mesh_file(&model)?;
        let viewpoints = Viewpoint::combinations(&azimuths(&self.azimuth_deg)?, &self.pitch_deg, &self.distance_mm);
        Ok(RenderRequest {
            turn: model.turn,
            colours: self.colours(&model)?,
            mesh: model.mesh,
            materials: model.materials,
            lights: self
                .light
                .iter()
                .map(|text| text.parse())
                .collect::<Result<Vec<Panorama>, _>>()?,
            viewpoints,
            size_px: size(&self.size_px)?,
            field_of_view_deg: self.field_of_view_deg,
            roughness: self.roughness,
            samples: self.samples,
            denoise: self.denoise,
            seed: self.seed,
            factor: self.position_factor,
            threads: self.threads,
            made_by: self.made_by(&mesh_file, &self.model.filled()?),
            mesh_file,
        })
    }

    pub fn colours(&self, model: &Model) -> Result<Vec<RenderPaint>> {
        let mut colours = Vec::new();
        for text in &self.flat {
            colours.push(RenderPaint::Flat(hex(text)?));
        }
        for path in &self.pattern {
            let name = path
                .file_stem()
                .map(|s| s.to_string_lossy().into_owned())
                .unwrap_or_default();
            let pattern = Pattern::load(path)?;
            let tile_mm = tile_mm(self.tile_mm, path, &pattern)?;
            colours.push(RenderPaint::Pattern(name, pattern, tile_mm));
        }
        for text in &self.texture {
            let (name, path) = named(text);
            colours.push(textured(name, path, model)?);
        }
        Ok(colours)
    }

    /// The arguments that decide about the pixels, with files by their names only.
    pub fn made_by(&self, mesh_file: &Path, model: &ModelArgs) -> String {
        let some = |texts: &[String]| (!texts.is_empty()).then(|| texts.join(" "));
        let numbers = |values: &[f64]| some(&values.iter().map(f64::to_string).collect::<Vec<_>>());
        let patterns: Vec<String> = self.pattern.iter().map(|path| file_name(path)).collect();
        let textures: Vec<String> = self.texture.iter().map(|text| file_name(named(text).1)).collect();
        let given = options([
            ("light", some(&self.light)),
            ("azimuth-deg", some(&self.azimuth_deg)),
            ("pitch-deg", numbers(&self.pitch_deg)),
            ("distance-mm", numbers(&self.distance_mm)),
            ("flat", some(&self.flat)),
            ("pattern", some(&patterns)),
            (
                "tile-mm",
                self.tile_mm.filter(|_| !patterns.is_empty()).map(|mm| mm.to_string()),
            ),
            ("texture", some(&textures)),
            (
                "roughness",
                (self.roughness != ROUGHNESS).then(|| self.roughness.to_string()),
            ),
        ]);
        format!(
            "attack render --mesh {}{}{given}{} --size-px {} --field-of-view-deg {} --samples {} --seed {} --position-factor {}",
            file_name(mesh_file),
            described(model),
            if self.denoise { " --denoise" } else { "" },
            self.size_px,
            self.field_of_view_deg,
            self.samples,
            self.seed,
            self.position_factor
        )
    }
}

/// A texture's name and file; without a name it is called as its file is.
pub fn named(text: &str) -> (String, &Path) {
    let path = Path::new(text);
    match text.split_once('=') {
        Some((name, file)) if !path.exists() => (name.to_owned(), Path::new(file)),
        _ => (
            path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            path,
        ),
    }
}

pub fn textured(name: String, path: &Path, model: &Model) -> Result<RenderPaint> {
    let texture = load_texture(path, model)?.texture;
    let image = TriangleImage::new(&model.mesh, &model.materials, &texture)?;
    Ok(RenderPaint::Texture(name, Arc::new(image)))
}

pub fn azimuths(texts: &[String]) -> Result<Vec<f64>> {
    let read = |text: &String| {
        directions(text).ok_or_else(|| {
            format!(
                "azimuth '{text}' is not understood; write degrees, as in 0 45 90, or a step of a whole part of the circle, as in every45"
            )
        })
    };
    Ok(texts.iter().map(read).collect::<Result<Vec<_>, _>>()?.concat())
}

/// An azimuth, or one every so many degrees.
fn directions(text: &str) -> Option<Vec<f64>> {
    let Some(step) = text.strip_prefix("every") else {
        let degrees: f64 = text.parse().ok()?;
        return degrees.is_finite().then(|| vec![wrap_360(degrees)]);
    };
    let step: f64 = step.parse().ok()?;
    let count = 360.0 / step;
    let is_whole = (1.0..=360.0).contains(&count) && (count - count.round()).abs() <= 1e-9;
    is_whole.then(|| (0..count.round() as usize).map(|i| i as f64 * step).collect())
}

pub fn size(text: &str) -> Result<[u32; 2]> {
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    match (width.parse(), height.parse()) {
        (Ok(width), Ok(height)) => Ok([width, height]),
        _ => Err(format!("the size '{text}' is not understood; write pixels, as in 256 or 256x192").into()),
    }
}

pub fn hex(text: &str) -> Result<[u8; 3]> {
    light::from_hex(text)
        .ok_or_else(|| format!("colour '{text}' is not understood; write six hexadecimal digits, as in 808080").into())
}

pub fn hexes(texts: &[String]) -> Result<Vec<[u8; 3]>> {
    texts.iter().map(|text| hex(text)).collect()
}

pub fn mesh_file(model: &Model) -> Result<PathBuf, String> {
    let file = model.file.clone();
    file.ok_or_else(|| "a model without a mesh cannot be rendered: give --mesh, or a scene that names one".to_owned())
}

pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Options with values, as arguments again.
pub fn options<const N: usize>(given: [(&str, Option<String>); N]) -> String {
    let given = given.into_iter().filter_map(|(option, value)| Some((option, value?)));
    given.map(|(option, value)| format!(" --{option} {value}")).collect()
}

/// Returns the options about a mesh other than its file, as arguments.
pub fn described(model: &ModelArgs) -> String {
    let material = (!model.material.is_empty()).then(|| model.material.join(" "));
    options([
        ("material", material),
        ("faces", model.faces.as_ref().map(|path| path.display().to_string())),
        ("length-mm", model.length_mm.map(|mm| mm.to_string())),
        ("mesh-front", model.mesh_front.clone()),
        ("mesh-up", model.mesh_up.clone()),
    ])
}
