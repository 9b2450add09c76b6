//! A mesh as a pinhole camera sees it, as images of a frame: masks, and positions of the paint.

use std::path::{Path, PathBuf};

use image::{GrayImage, Luma};

use crate::raster::{Raster, outline};
use crate::{Frame, FramesError, Pinhole, Positions, encode_grey, encode_positions};
use scaleproof_core::geometry::{BoxPx, Rigid};
use scaleproof_surface::mesh::{Mesh, Triangle, doubled_area};
use scaleproof_surface::pattern::world_aligned::Side;

/// Masks and positions of a frame.
pub struct DrawnMesh {
    pub object_mask: GrayImage,
    pub paint_mask: GrayImage,
    /// The surface point at factor² places of each pixel, row by row of the finer image; without meaning where there is no paint.
    pub positions: Vec<[f64; 3]>,
    pub sides: GrayImage,
    pub box_xyxy_px: Option<BoxPx>,
}

impl DrawnMesh {
    /// Encodes the images as the files that a frame names, below a folder.
    pub fn files(
        &self,
        folder: &Path,
        frame: &Frame,
        positions: &Positions,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>, FramesError> {
        let mut files = vec![
            (folder.join(&frame.object_mask), encode_grey(&self.object_mask)?),
            (folder.join(&frame.paint_mask), encode_grey(&self.paint_mask)?),
        ];
        if let (Some(file), Some(sides)) = (&frame.positions, &frame.sides) {
            let places = self.positions.iter().copied();
            let encoded = encode_positions(places, self.sides.dimensions().into(), positions)?;
            files.push((folder.join(file), encoded));
            files.push((folder.join(sides), encode_grey(&self.sides)?));
        }
        Ok(files)
    }
}

/// Finds the side of the model that each triangle of the paint belongs to; `None` for what is no paint. No `materials` are all.
pub fn paint_sides(mesh: &Mesh, materials: &[usize]) -> Vec<Option<Side>> {
    let is_paint = |t: &Triangle| materials.is_empty() || materials.contains(&t.material);
    let side = |t: &Triangle| is_paint(t).then(|| Side::facing(&doubled_area(&mesh.corners_mm(t))));
    mesh.triangles().iter().map(side).collect()
}

/// Returns the value of a side in `sides` images: 1 + its index in [`Side::ALL`].
pub fn side_number(side: Side) -> u8 {
    1 + side as u8
}

/// Returns the mask level (0 to 255) of a pixel of whose `factor`² places `count` are covered.
pub fn level(count: u32, factor: u32) -> u8 {
    (255.0 * f64::from(count) / f64::from(factor * factor)).round() as u8
}

/// Clips the mesh's box to an image of this size; `None` when nothing is left.
pub fn clip_box(around: &BoxPx, size_px: [u32; 2]) -> Option<BoxPx> {
    let [width, height] = size_px.map(f64::from);
    Some(around.clipped(width, height)).filter(BoxPx::is_solid)
}

/// Draws a mesh at the centres of `factor`² parts of each pixel; `paint` is the side of each triangle ([`paint_sides`]). `None` when part of the mesh
/// is not before the camera.
pub fn draw(
    mesh: &Mesh,
    paint: &[Option<Side>],
    pose: &Rigid,
    pinhole: &Pinhole,
    size_px: [u32; 2],
    factor: u32,
) -> Option<DrawnMesh> {
    let [width, height] = size_px;
    let fine = size_px.map(|px| px * factor);
    let raster = Raster::image(mesh, pose, &pinhole.finer(factor), fine.map(|px| px as usize))?;
    let mut positions = Vec::with_capacity(fine.iter().map(|px| *px as usize).product());
    let mut sides = GrayImage::new(fine[0], fine[1]);
    let (mut object, mut painted) = (GrayImage::new(width, height), GrayImage::new(width, height));
    for (x, y, side) in sides.enumerate_pixels_mut() {
        let at = (i64::from(x), i64::from(y));
        let mut place = [0.0; 3];
        if let Some(hit) = raster.at(at.0, at.1) {
            object.get_pixel_mut(x / factor, y / factor).0[0] += 1;
            if let Some(paint) = paint.get(hit.triangle).copied().flatten() {
                painted.get_pixel_mut(x / factor, y / factor).0[0] += 1;
                place = raster.point(at.0, at.1, &hit).coords.into();
                *side = Luma([side_number(paint)]);
            }
        }
        positions.push(place);
    }
    for pixel in object.pixels_mut().chain(painted.pixels_mut()) {
        pixel.0[0] = level(pixel.0[0].into(), factor);
    }
    Some(DrawnMesh {
        object_mask: object,
        paint_mask: painted,
        positions,
        sides,
        box_xyxy_px: outline(mesh, pose, pinhole).and_then(|around| clip_box(&around, size_px)),
    })
}
