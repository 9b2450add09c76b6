//! The paint's surface as Blender gets it: triangles with their sides and texture coordinates.

use serde_json::{Value, json};

use super::RenderError;
use super::request::RenderRequest;
use crate::frames::drawn::{number, paint_sides};
use scaleproof_surface::mesh::doubled_area;

/// The paint's triangles with the side and the place in the pattern of each corner, in repeats, as the printed panels have them
/// ([`Side`](scaleproof_surface::pattern::world_aligned::Side)); and which triangles of the mesh these are. Those without area show nothing and are
/// left out.
pub(super) fn surface(request: &RenderRequest) -> Result<(Value, Vec<usize>), RenderError> {
    let mesh = &request.mesh;
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut index = std::collections::HashMap::new();
    let (mut triangles, mut sides, mut uv_mm, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, side) in paint_sides(mesh, &request.materials).into_iter().enumerate() {
        let triangle = &mesh.triangles()[i];
        let corners = mesh.corners_mm(triangle);
        let Some(side) = side.filter(|_| doubled_area(&corners).norm() >= 1e-9) else {
            continue;
        };
        indices.push(i);
        sides.push(number(side));
        uv_mm.push(corners.map(|p| side.project(&p)));
        triangles.push(std::array::from_fn::<usize, 3, _>(|i| {
            *index.entry(triangle.corners[i]).or_insert_with(|| {
                points.push(corners[i].coords.into());
                points.len() - 1
            })
        }));
    }
    if triangles.is_empty() {
        return Err(RenderError::NoPaint);
    }
    let surface = json!({"points_mm": points, "triangles": triangles, "sides": sides, "uv_mm": uv_mm});
    Ok((surface, indices))
}
