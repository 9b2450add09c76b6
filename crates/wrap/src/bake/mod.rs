//! Baking of a texture of any kind into one image on texture coordinates, as simulators need it.
//!
//! The mesh's own coordinates are kept if possible ([`own`]), else its paint is unwrapped and packed ([`packing`]). Each texel is the mean of the
//! colours on its place of the surface (`fill.rs`). [`write_obj`] and [`write_glb`] write the mesh with these coordinates.

mod baked;
mod error;
mod face;
mod fill;
mod glb;
mod model;
mod obj;
mod own;
mod packing;
mod triangles;

pub use baked::Baked;

pub use error::BakeError;
pub(crate) use error::SIDE_PX;

pub use face::BakedFace;
pub(crate) use face::{FlatChart, alone};

pub use glb::write as write_glb;
pub use model::TexturedModel;
pub use obj::write as write_obj;
pub use own::NotKept;
pub use triangles::TriangleImage;

use image::RgbImage;
use nalgebra::Matrix3;

use crate::unwrap;
use crate::unwrap::UnwrapRequest;
use scaleproof_surface::mesh::{Mesh, doubled_area};
use scaleproof_surface::texture::{SurfacePoint, Texture};

/// Mesh, texture and size of a baked image.
pub struct BakeRequest<'a> {
    pub mesh: &'a Mesh,
    /// Indices of the paint's materials; all if empty.
    pub materials: &'a [usize],
    pub texture: &'a Texture,
    /// Width and height of the image.
    pub size_px: [u32; 2],
    /// True to unwrap the paint even if the mesh's own coordinates could be kept.
    pub unwrap: bool,
}

/// Bakes a texture.
pub fn bake(request: &BakeRequest) -> Result<Baked, BakeError> {
    let BakeRequest { mesh, size_px, .. } = *request;
    let [width, height] = size_px;
    if size_px.iter().any(|px| !SIDE_PX.contains(px)) {
        return Err(BakeError::BadSize { width, height });
    }
    let paint: Vec<usize> = mesh.painted(request.materials).collect();
    if paint.is_empty() {
        return Err(BakeError::NoPaint);
    }
    let kept = if request.unwrap {
        Err(NotKept::Asked)
    } else {
        own::charts(mesh, &paint)
    };
    let (charts, unwrapped) = match kept {
        Ok(charts) => (charts, None),
        Err(why) => {
            let flat = flattened(mesh, request.materials, &paint)?;
            (packing::into_image(&flat, size_px, packing::ROOM)?, Some(why))
        }
    };
    let image = fill::fill(mesh, request.texture, &charts, size_px);
    Ok(finished(mesh, image, charts, unwrapped))
}

fn finished(mesh: &Mesh, image: RgbImage, charts: Vec<Vec<BakedFace>>, unwrapped: Option<NotKept>) -> Baked {
    let count = charts.len();
    let mut faces: Vec<BakedFace> = charts.into_iter().flatten().collect();
    faces.sort_by_key(|face| face.triangle);
    let (texels, mm2) = faces.iter().fold((0.0, 0.0), |(texels, mm2), face| {
        let corners = face.weights.map(|weights| {
            let triangle = face.triangle;
            SurfacePoint { triangle, weights }.place_mm(mesh)
        });
        (texels + face.texels(), mm2 + 0.5 * doubled_area(&corners).norm())
    });
    let texels = texels * f64::from(image.width()) * f64::from(image.height());
    Baked {
        texel_mm: (mm2 / texels.max(1.0)).sqrt(),
        image,
        faces,
        charts: count,
        unwrapped,
    }
}

/// Flattens the paint into pieces. A triangle in no piece, since it has no area or is duplicated, becomes a piece of its own.
fn flattened(mesh: &Mesh, materials: &[usize], paint: &[usize]) -> Result<Vec<FlatChart>, BakeError> {
    let request = UnwrapRequest {
        hidden_too: true,
        ..UnwrapRequest::default()
    };
    let unwrapped = unwrap::unwrap(mesh, materials, &request, &mut |_| ())?;
    let face = |face: unwrap::FlatFace| {
        let mut baked = BakedFace {
            triangle: face.triangle,
            weights: face.weights,
            uv: face.flat_mm,
        };
        // Unwrapping flips faces whose back is outside; the mesh's own order of corners defines the lit side of a face.
        if Matrix3::from_fn(|r, c| face.weights[r][c]).determinant() < 0.0 {
            baked.weights.swap(1, 2);
            baked.uv.swap(1, 2);
        }
        baked
    };
    let mut charts: Vec<FlatChart> = unwrapped
        .charts
        .into_iter()
        .map(|chart| chart.faces.into_iter().map(face).collect())
        .collect();
    let mut is_there = vec![false; mesh.triangles().len()];
    for face in charts.iter().flatten() {
        is_there[face.triangle] = true;
    }
    let missing = paint.iter().filter(|t| !is_there[**t]);
    charts.extend(missing.map(|t| vec![alone(mesh, *t)]));
    Ok(charts)
}
