//! Textured mesh for writing: every triangle with its coordinates in the baked image, and the appearance of the other materials.

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::Point3;

use super::Baked;
use crate::unwrap::WHOLE;
use scaleproof_core::files;
use scaleproof_surface::mesh::{ImageSource, Look, Mesh, TextureCoordinates, Wrap};
use scaleproof_surface::texture::SurfacePoint;

/// Colour of materials without one in the file.
const GREY: [f64; 3] = [0.2; 3];

/// Mesh with a material and coordinates for each face.
pub struct TexturedModel {
    pub faces: Vec<TexturedFace>,
    /// Materials, in the mesh's order.
    pub skins: Vec<Skin>,
    /// Image files; the first is the baked one.
    pub images: Vec<Arc<[u8]>>,
}

pub struct TexturedFace {
    /// Corners in the model frame, mm.
    pub places_mm: [Point3<f64>; 3],
    pub coordinates: Option<TextureCoordinates>,
    pub skin: usize,
}

pub struct Skin {
    /// Unique name without blanks.
    pub name: String,
    /// Base colour, linear light.
    pub factor: [f64; 3],
    /// Index of its image, and wrap modes beyond the image's borders.
    pub image: Option<(usize, [Wrap; 2])>,
}

impl TexturedModel {
    /// Creates the model; `png`: the baked image's file. Images of other materials that cannot be read are left out: their base colour stays.
    pub fn new(mesh: &Mesh, materials: &[usize], baked: &Baked, png: &[u8]) -> Self {
        let mut model = Self {
            faces: Vec::with_capacity(mesh.triangles().len()),
            skins: Vec::new(),
            images: vec![png.into()],
        };
        for material in 0..mesh.materials().len() {
            let skin = model.skin(mesh, material, materials.is_empty() || materials.contains(&material));
            model.skins.push(skin);
        }
        let mut painted = baked.faces.iter().peekable();
        for (i, triangle) in mesh.triangles().iter().enumerate() {
            let mut face = |weights: [[f64; 3]; 3], coordinates| {
                model.faces.push(TexturedFace {
                    places_mm: weights.map(|weights| SurfacePoint { triangle: i, weights }.place_mm(mesh)),
                    coordinates,
                    skin: triangle.material,
                });
            };
            if painted.peek().is_some_and(|face| face.triangle == i) {
                while let Some(part) = painted.next_if(|face| face.triangle == i) {
                    face(part.weights, Some(part.uv));
                }
            } else {
                face(WHOLE, mesh.coordinates(i))
            }
        }
        model
    }

    fn skin(&mut self, mesh: &Mesh, material: usize, is_paint: bool) -> Skin {
        let name = self.free_name(&mesh.materials()[material]);
        let (factor, image) = match mesh.look(material) {
            _ if is_paint => ([1.0; 3], Some((0, [Wrap::ClampToEdge; 2]))),
            Some(look) => (look.factor, self.image(look)),
            None => (GREY, None),
        };
        Skin { name, factor, image }
    }

    /// Returns the index of a material's image; reads it if it is new.
    fn image(&mut self, look: &Look) -> Option<(usize, [Wrap; 2])> {
        let bytes: Arc<[u8]> = match look.image.as_ref()? {
            ImageSource::Inside(bytes, range) => bytes.get(range.clone())?.into(),
            ImageSource::File(path) => files::read(path).ok()?.into(),
            ImageSource::Refused(_) => return None,
        };
        let known = self.images.iter().position(|image| *image == bytes);
        let index = known.unwrap_or_else(|| {
            self.images.push(bytes);
            self.images.len() - 1
        });
        Some((index, look.wrap))
    }

    /// Returns a unique name without blanks: programs read a material's name up to its first blank, or the whole line.
    fn free_name(&self, name: &str) -> String {
        let plain = name.replace(|c: char| c.is_whitespace() || c.is_control(), "_");
        let is_taken = |name: &String| self.skins.iter().any(|skin| skin.name == *name);
        let numbered = (2..).map(|n| format!("{plain}_{n}"));
        let mut all = std::iter::once(plain.clone()).chain(numbered);
        all.find(|name| !is_taken(name)).unwrap_or(plain)
    }
}

pub(super) fn ending(image: &[u8]) -> &'static str {
    if image.starts_with(&[0xff, 0xd8]) { "jpg" } else { "png" }
}

/// Distinct values in the order of their first occurrence.
#[derive(Default)]
pub(super) struct Distinct<const N: usize> {
    pub values: Vec<[f32; N]>,
    index: HashMap<[u32; N], usize>,
}

impl<const N: usize> Distinct<N> {
    /// Returns the index of a value, rounded to the formats' 32 bits; adds it if it is new.
    pub(super) fn index_of(&mut self, value: [f64; N]) -> usize {
        let value = value.map(|v| v as f32 + 0.0);
        let values = &mut self.values;
        *self.index.entry(value.map(f32::to_bits)).or_insert_with(|| {
            values.push(value);
            values.len() - 1
        })
    }
}
