//! A mesh as it is written: every triangle with the coordinates of the baked image, and what the other materials look like.

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::Point3;

use super::Baked;
use crate::unwrap::WHOLE;
use scaleproof_core::files;
use scaleproof_surface::mesh::{ImageSource, Look, Mesh, TextureCoordinates, Wrap};
use scaleproof_surface::texture::SurfacePoint;

/// Materials of which the file says nothing.
const GREY: [f64; 3] = [0.2; 3];

/// A mesh with a material and coordinates for each face.
pub struct TexturedModel {
    pub faces: Vec<TexturedFace>,
    /// As in the mesh.
    pub skins: Vec<Skin>,
    /// The baked one is the first.
    pub images: Vec<Arc<[u8]>>,
}

pub struct TexturedFace {
    /// Model frame, mm.
    pub places_mm: [Point3<f64>; 3],
    pub coordinates: Option<TextureCoordinates>,
    pub skin: usize,
}

pub struct Skin {
    /// Unique, without blanks.
    pub name: String,
    /// Linear light.
    pub factor: [f64; 3],
    /// Its image, and what lies beyond its borders.
    pub image: Option<(usize, [Wrap; 2])>,
}

impl TexturedModel {
    /// `png`: the baked image's file. The images of other materials that cannot be read are left out: their factor stays.
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

    /// The index of a material's image, which is read where it is new.
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

    /// Programs take a material's name up to its first blank, or its whole line.
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

/// Different values in the order in which they came first.
#[derive(Default)]
pub(super) struct Distinct<const N: usize> {
    pub values: Vec<[f32; N]>,
    index: HashMap<[u32; N], usize>,
}

impl<const N: usize> Distinct<N> {
    /// As 32 bits, which is what these formats have.
    pub(super) fn index_of(&mut self, value: [f64; N]) -> usize {
        let value = value.map(|v| v as f32 + 0.0);
        let values = &mut self.values;
        *self.index.entry(value.map(f32::to_bits)).or_insert_with(|| {
            values.push(value);
            values.len() - 1
        })
    }
}
