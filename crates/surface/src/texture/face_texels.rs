//! Texels of each triangle, as attacks on the neural mesh renderer store them (Kato et al. 2018): `n × n × n` colours a triangle.

use std::path::Path;
use std::sync::Arc;

use super::{SurfacePoint, TextureError};
use crate::mesh::Mesh;
use crate::pattern::numpy;
use scaleproof_core::files;

/// Size of the largest file: a million triangles of 4 × 4 × 4 colours fit, and the usual 23,000 of 6 × 6 × 6 twenty times.
const MOST_BYTES: u64 = 1 << 30;
/// Largest number of texels along a side: renderers work with 2 to 8.
const MOST_SIDE: u64 = 64;

#[derive(Debug, Clone)]
pub struct FaceTexels {
    /// Texels along a side of the cube, and along an edge of the triangle.
    pub(super) side: usize,
    /// Colours, sRGB from 0 to 1: triangle, then the places along the cube's three axes.
    texels: Arc<[[f32; 3]]>,
}

impl FaceTexels {
    /// Reads `[1,] triangles, n, n, n, 3` numbers: floats from 0 to 1 or bytes. Returns the file's SHA-256, too.
    ///
    /// # Errors
    /// An unreadable or damaged file, another shape or kind of numbers, as many triangles as another mesh has.
    pub fn load(path: &Path, mesh: &Mesh) -> Result<(Self, String), TextureError> {
        let bytes = files::read_at_most(path, MOST_BYTES)?;
        let texels = Self::parse(&bytes, mesh.triangles().len()).map_err(|reason| TextureError::Unusable {
            path: path.to_owned(),
            reason,
        })?;
        Ok((texels, files::sha256_hex(&bytes)))
    }

    fn parse(bytes: &[u8], triangles: usize) -> Result<Self, String> {
        let (file, stored_bytes) = numpy::open(bytes)?;
        let side = side(file.shape(), triangles)?;
        let values = numpy::colours(file, triangles * side.pow(3) * 3, stored_bytes)?;
        Ok(Self {
            side,
            texels: values.as_chunks::<3>().0.into(),
        })
    }

    /// Interpolates between the eight colours around a point, as the renderer does it: the share of each corner is the place along one
    /// axis, from the first colour to the last. Colours of other triangles take no part.
    pub(super) fn colour(&self, at: &SurfacePoint) -> [u8; 3] {
        let places = at.within().map(|weight| weight * (self.side - 1) as f64);
        let lower = places.map(|place| (place as usize).min(self.side.saturating_sub(2)));
        let mut sum = [0.0; 3];
        for corner in 0..8_usize {
            let (mut share, mut index) = (1.0, at.triangle);
            for axis in 0..3 {
                let step = corner >> axis & 1;
                let upper_share = places[axis] - lower[axis] as f64;
                share *= if step == 1 { upper_share } else { 1.0 - upper_share };
                index = index * self.side + (lower[axis] + step).min(self.side - 1);
            }
            let texel = self.texels.get(index).copied().unwrap_or([1.0; 3]);
            (0..3).for_each(|c| sum[c] += share * f64::from(texel[c]));
        }
        sum.map(|value| (255.0 * value.clamp(0.0, 1.0)).round() as u8)
    }
}

/// Returns the number of texels along a side of the cube.
fn side(shape: &[u64], triangles: usize) -> Result<usize, String> {
    let (faces, side) = match *shape {
        [1, faces, a, b, c, 3] | [faces, a, b, c, 3] if a == b && b == c && (1..=MOST_SIDE).contains(&a) => (faces, a),
        _ => {
            return Err(format!(
                "its shape is {shape:?}, and textures of triangles have [1,] triangles, n, n, n, 3 numbers with n up to {MOST_SIDE}"
            ));
        }
    };
    if faces == triangles as u64 {
        Ok(side as usize)
    } else {
        Err(format!(
            "it is for a mesh of {faces} triangles and this one has {triangles}; give the mesh that it was made for"
        ))
    }
}
