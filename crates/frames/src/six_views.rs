//! A model from its six sides, with its paint in a colour of its own: to see whether the axes and the paint of a mesh are right.

use image::{Rgb, RgbImage};

use crate::Pinhole;
use crate::raster::Raster;
use crate::shaded::{FIELD_OF_VIEW_DEG, ShadedModel, distance_of_whole, pose_around, side_by_side};
use scaleproof_core::geometry::Rigid;
use scaleproof_photo::draw::{LabelAnchor, Lettering, label};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::texture::Texture;

/// Azimuth and pitch from which each side is seen, in degrees. From above and from below the front is up in the image; straight down no side
/// is up.
const SIDES: [(&str, f64, f64); 6] = [
    ("front", 0.0, 0.0),
    ("left", 90.0, 0.0),
    ("top", 180.0, 89.0),
    ("rear", 180.0, 0.0),
    ("right", 270.0, 0.0),
    (BELOW, 0.0, -89.0),
];
/// Width and height of a view, pixels.
const SIZE_PX: [u32; 2] = [400, 300];
/// Share of a view's height that the ball around the model takes.
const FILLED: f64 = 0.92;
const BELOW: &str = "bottom";
const COLUMNS: usize = 3;
const PAINT: [u8; 3] = [240, 130, 20];
const REST: [u8; 3] = [110; 3];

/// Returns the pose of each view, from so far that the whole model is in it, and the camera.
fn poses(mesh: &Mesh) -> (Vec<(&'static str, Rigid)>, Pinhole) {
    let pinhole = Pinhole::with_field_of_view(SIZE_PX, FIELD_OF_VIEW_DEG);
    let distance_mm = distance_of_whole(mesh, FILLED, &pinhole, SIZE_PX);
    let pose = |(name, azimuth, pitch)| (name, pose_around(mesh, azimuth, pitch, distance_mm));
    (SIDES.map(pose).to_vec(), pinhole)
}

/// Returns the share that each material has of what is seen from all sides but from below, where no car is painted; the sum is 1.
pub fn seen_shares(mesh: &Mesh) -> Vec<f64> {
    let (poses, pinhole) = poses(mesh);
    let mut seen = vec![0.0; mesh.materials().len()];
    for (_, pose) in poses.into_iter().filter(|(name, _)| *name != BELOW) {
        let Some(raster) = Raster::image(mesh, &pose, &pinhole, SIZE_PX.map(|px| px as usize)) else {
            continue;
        };
        let pixels = (0..i64::from(SIZE_PX[1])).flat_map(|y| (0..i64::from(SIZE_PX[0])).map(move |x| (x, y)));
        for hit in pixels.filter_map(|(x, y)| raster.at(x, y)) {
            seen[mesh.triangles()[hit.triangle].material] += 1.0;
        }
    }
    let all: f64 = seen.iter().sum();
    seen.iter().map(|pixels| pixels / all.max(1.0)).collect()
}

/// Draws the six views on one image, each with its name. `paint` are materials; none stands for all.
pub fn six_views(mesh: &Mesh, paint: &[usize]) -> RgbImage {
    let [painted, rest] = [PAINT, REST].map(Texture::Flat);
    let is_paint = |material: usize| paint.is_empty() || paint.contains(&material);
    let materials = 0..mesh.materials().len();
    let model = ShadedModel {
        mesh,
        textures: materials.map(|m| if is_paint(m) { &painted } else { &rest }).collect(),
    };
    let (poses, pinhole) = poses(mesh);
    let [width, height] = SIZE_PX;
    let lettering = Lettering {
        size_px: 18.0,
        colour: [0; 3],
        ground: [255; 3],
    };
    let view = |(name, pose): &(&str, Rigid)| match model.draw(pose, &pinhole, SIZE_PX) {
        Some(mut view) => {
            label(&mut view, [6.0, 6.0], LabelAnchor::TopLeft, name, lettering);
            view
        }
        None => RgbImage::from_pixel(width, height, Rgb([255; 3])),
    };
    side_by_side(&Vec::from_iter(poses.iter().map(view)), COLUMNS)
}
