//! The paint's surface as Blender gets it: triangles with their sides and texture coordinates.

use serde_json::{Value, json};

use super::RenderError;
use super::request::RenderRequest;
use scaleproof_surface::mesh::doubled_area;
use scaleproof_surface::pattern::world_aligned::Side;

/// The paint's triangles with the side and the place in the pattern of each corner, in repeats, as the printed panels have them
/// ([`Side`]); and which triangles of the mesh these are. Those without area show nothing and are left out.
pub(super) fn surface(request: &RenderRequest) -> Result<(Value, Vec<usize>), RenderError> {
    let mesh = &request.mesh;
    let is_paint = |material: usize| request.materials.is_empty() || request.materials.contains(&material);
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut index = std::collections::HashMap::new();
    let (mut triangles, mut sides, mut uv_mm, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, triangle) in mesh
        .triangles()
        .iter()
        .enumerate()
        .filter(|(_, t)| is_paint(t.material))
    {
        let corners = mesh.corners_mm(triangle);
        let normal = doubled_area(&corners);
        if normal.norm() < 1e-9 {
            continue;
        }
        indices.push(i);
        let side = Side::facing(&normal);
        sides.push(1 + Side::ALL.iter().position(|s| *s == side).unwrap_or_default());
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
