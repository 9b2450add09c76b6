//! Texture as one image in which every triangle of the paint lies whole, for renderers that take only such images.

use std::sync::Arc;

use image::RgbImage;

use super::{BakeError, FlatChart, alone, fill, packing};
use scaleproof_surface::mesh::{Mesh, TextureCoordinates, Wrap};
use scaleproof_surface::texture::Texture;

/// Sides of the image made of a texture without one. The body of a 1:10 car gets texels of 0.2 mm at most.
const SIDES_PX: [u32; 4] = [512, 1024, 2048, 4096];
/// Number of the image's texels along a texel of the texture.
const FINER: f64 = 4.0;
/// Ratio of the image's area to that of the triangles.
const ROOM: f64 = 2.0;
/// Maximum side of an image that is kept; a larger one is resampled: renderers need 16 bytes per texel.
const LARGEST_PX: u32 = 8192;

/// Image with the place of each triangle of the paint in it.
#[derive(Debug, Clone)]
pub struct TriangleImage {
    pub image: Arc<RgbImage>,
    /// Wrap mode beyond its borders.
    pub wrap: Wrap,
    pub coordinates: Vec<Option<TextureCoordinates>>,
}

impl TriangleImage {
    /// Keeps an image on texture coordinates; draws any other texture into a new image, each triangle separately.
    pub fn new(mesh: &Mesh, materials: &[usize], texture: &Texture) -> Result<Self, BakeError> {
        let paint: Vec<usize> = mesh.painted(materials).collect();
        if paint.is_empty() {
            return Err(BakeError::NoPaint);
        }
        if let Texture::Images(images) = texture
            && let Some(only) = images.only_image(&paint)
            && only.image.width().max(only.image.height()) <= LARGEST_PX
        {
            let at = paint.iter().zip(only.coordinates);
            return Ok(Self {
                image: only.image,
                wrap: only.wrap,
                coordinates: by_triangle(mesh, at.map(|(triangle, uv)| (*triangle, uv))),
            });
        }
        let alone: Vec<FlatChart> = paint.iter().map(|triangle| vec![alone(mesh, *triangle)]).collect();
        let size_px = [side_px(mesh, &paint, texture); 2];
        let charts = packing::into_image(&alone, size_px, 0.0)?;
        Ok(Self {
            image: Arc::new(fill::fill(mesh, texture, &charts, size_px)),
            wrap: Wrap::ClampToEdge,
            coordinates: by_triangle(mesh, charts.iter().flatten().map(|face| (face.triangle, face.uv))),
        })
    }

    /// Returns size, coordinates and pixels as bytes.
    pub fn bytes(&self) -> Vec<u8> {
        let (width, height) = self.image.dimensions();
        let mut bytes: Vec<u8> = [width, height].iter().flat_map(|px| px.to_le_bytes()).collect();
        let uv = self.coordinates.iter().flatten().flatten().flatten();
        bytes.extend(uv.flat_map(|v| v.to_le_bytes()));
        bytes.extend_from_slice(self.image.as_raw());
        bytes
    }
}

/// Returns a side of the image at which each texel of the texture is resolved, up to the largest.
fn side_px(mesh: &Mesh, paint: &[usize], texture: &Texture) -> u32 {
    let texels = paint.iter().map(|triangle| {
        let mm2 = 0.5 * mesh.normal_mm2(*triangle).norm();
        let texel_mm = texture.texel_mm(mesh, *triangle);
        // A triangle needs a few texels for its border.
        16.0 + texel_mm.map_or(0.0, |mm| mm2 * (FINER / mm).powi(2))
    });
    let side = (ROOM * texels.sum::<f64>()).sqrt();
    let [.., largest] = SIDES_PX;
    SIDES_PX
        .into_iter()
        .find(|px| f64::from(*px) >= side)
        .unwrap_or(largest)
}

fn by_triangle(
    mesh: &Mesh,
    places: impl Iterator<Item = (usize, TextureCoordinates)>,
) -> Vec<Option<TextureCoordinates>> {
    let mut coordinates = vec![None; mesh.triangles().len()];
    for (triangle, uv) in places {
        coordinates[triangle] = Some(uv);
    }
    coordinates
}
