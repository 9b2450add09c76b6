//! The settings of a render, and paints.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Matrix3;
use serde_json::{Value, json};

use super::Panorama;
use crate::{FramePaint, FramesError, encode_rgb, light};
use scaleproof_core::files;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_surface::mesh::{Mesh, Wrap};
use scaleproof_surface::pattern::Pattern;
use scaleproof_wrap::bake::TriangleImage;

/// Default roughness of the paint's coat.
pub const ROUGHNESS: f64 = 0.5;

/// Settings of a render.
#[derive(Debug, Clone)]
pub struct RenderRequest {
    pub mesh: Mesh,
    pub mesh_file: PathBuf,
    /// Rows of the rotation from the mesh file's frame into the model frame.
    pub turn: Matrix3<f64>,
    /// Indices of the materials that are the paint; all when empty.
    pub materials: Vec<usize>,
    pub lights: Vec<Panorama>,
    pub viewpoints: Vec<Viewpoint>,
    pub colours: Vec<RenderPaint>,
    pub size_px: [u32; 2],
    /// Horizontal.
    pub field_of_view_deg: f64,
    /// Roughness of the paint's coat, as in Blender's Principled BSDF: 0 reflects like glass, 1 is matt.
    pub roughness: f64,
    /// Light paths a pixel.
    pub samples: u32,
    /// Clean the noise of few light paths away (Intel Open Image Denoise). Such images no longer add up as light does.
    pub denoise: bool,
    pub seed: u32,
    /// Positions are taken at this many points along each side of a pixel.
    pub factor: u32,
    /// Threads; 0 is all cores. The same images come out.
    pub threads: u32,
    /// The command that makes the frames.
    pub made_by: String,
}

/// Paint that the model is rendered in.
#[derive(Debug, Clone)]
pub enum RenderPaint {
    /// 8-bit sRGB of the diffuse reflectance.
    Flat([u8; 3]),
    /// World-aligned pattern: the stem of its file, the pattern, the width of one repeat in mm.
    Pattern(String, Pattern, f64),
    /// Texture: the stem of its file, and the image.
    Texture(String, Arc<TriangleImage>),
    /// The mesh file's own materials.
    Original,
}

impl RenderPaint {
    pub(super) fn name(&self) -> String {
        match self {
            Self::Flat(rgb) => light::to_hex(*rgb),
            Self::Pattern(name, ..) | Self::Texture(name, _) => name.clone(),
            Self::Original => "original".to_owned(),
        }
    }

    pub(super) fn paint(&self) -> FramePaint {
        let file = self.file().unwrap_or_default();
        match self {
            Self::Flat(rgb) => FramePaint::FlatRgb(*rgb),
            Self::Pattern(_, _, tile_mm) => FramePaint::Pattern {
                file,
                tile_mm: *tile_mm,
            },
            Self::Texture(..) => FramePaint::Texture { file },
            Self::Original => FramePaint::Original,
        }
    }

    pub(super) fn file(&self) -> Option<String> {
        let folder = match self {
            Self::Pattern(..) => "patterns",
            Self::Texture(..) => "textures",
            Self::Flat(_) | Self::Original => return None,
        };
        Some(format!("{folder}/{}.png", self.name()))
    }

    /// Encodes the pattern or texture: the file below the folder of the frames, and its content.
    pub(super) fn stored(&self) -> Result<Option<(String, Vec<u8>)>, FramesError> {
        let png = match self {
            Self::Pattern(_, pattern, _) => pattern.to_png()?,
            Self::Texture(_, texture) => encode_rgb(&texture.image)?,
            Self::Flat(_) | Self::Original => return Ok(None),
        };
        Ok(self.file().map(|file| (file, png)))
    }

    /// Returns all that decides about the paint's pixels.
    pub fn identity(&self) -> Value {
        match self {
            Self::Pattern(name, pattern, tile_mm) => {
                json!({"name": name, "sha256": pattern.sha256(), "tile_mm": tile_mm})
            }
            Self::Texture(name, texture) => {
                json!({"name": name, "sha256": files::sha256_hex(&texture.bytes()), "wrap": extension(texture.wrap)})
            }
            Self::Flat(_) | Self::Original => json!(self.name()),
        }
    }

    /// Returns rows of cells from the top in linear light, and the size of one repeat, or the image in `folder` and where these triangles lie in it;
    /// nothing for the mesh's own materials.
    pub(super) fn to_script(&self, triangles: &[usize], folder: &Path) -> Value {
        let (cells, tile_mm): (Vec<Vec<[f64; 3]>>, _) = match self {
            Self::Original => return Value::Null,
            Self::Texture(_, texture) => {
                let file = absolute(&folder.join(self.file().unwrap_or_default()));
                let uv = triangles.iter().map(|t| texture.coordinates[*t].unwrap_or_default());
                let uv: Vec<_> = uv.collect();
                let texture = json!({"file": file, "extension": extension(texture.wrap), "uv": uv});
                return json!({"cells": null, "tile_mm": null, "texture": texture});
            }
            Self::Flat(rgb) => (vec![vec![light::linear_of(*rgb)]], [1.0, 1.0]),
            Self::Pattern(_, pattern, tile_mm) => {
                let rows = pattern.cells().rows();
                let height_mm = tile_mm * f64::from(pattern.rows()) / f64::from(pattern.columns());
                let cells = rows.map(|row| row.map(|p| light::linear_of(p.0)).collect());
                (cells.collect(), [*tile_mm, height_mm])
            }
        };
        json!({"cells": cells, "tile_mm": tile_mm, "texture": null})
    }
}

/// Returns the absolute path as text, for the script.
pub(super) fn absolute(path: &Path) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    whole.to_string_lossy().into_owned()
}

/// Returns Blender's name of a wrap.
fn extension(wrap: Wrap) -> &'static str {
    match wrap {
        Wrap::Repeat => "REPEAT",
        Wrap::MirroredRepeat => "MIRROR",
        Wrap::ClampToEdge => "EXTEND",
    }
}
