//! Fewer triangles for the same surface, as a scan has millions: edges are collapsed in the order of their quadric error (Garland and Heckbert 1997),
//! by meshoptimizer.

use std::collections::HashMap;

use meshopt::{SimplifyOptions, VertexDataAdapter, simplify, typed_to_bytes};
use nalgebra::Point3;

use super::triangles::{Mesh, Triangle};

/// A mesh with fewer triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Simplified {
    pub mesh: Mesh,
    /// Distance by which the surface moved, mm: the square root of the largest quadric error of a collapse. An estimate, not a bound.
    pub moved_mm: f64,
}

/// Key that tells corners of triangles apart: the place, the material and, where they count, the texture coordinates.
type Key = (usize, usize, Option<[u64; 2]>);

impl Mesh {
    /// Returns about `most` triangles of the same surface, moved by `within_mm` or less, so there may be more of them. The corners that are left stay
    /// where they are, and borders between materials stay borders. With `keep_coordinates`, so do the seams of the texture; without it, the result
    /// has no texture coordinates.
    #[must_use]
    pub fn simplified(&self, most: usize, within_mm: f64, keep_coordinates: bool) -> Simplified {
        let mut vertices = Vertices::default();
        let indices: Vec<u32> = (0..self.triangles.len())
            .flat_map(|i| self.keys(i, keep_coordinates))
            .map(|key| vertices.index(key))
            .collect();
        let places: Vec<[f32; 3]> = vertices
            .keys
            .iter()
            .map(|key| self.points[key.0].coords.cast().into())
            .collect();
        // Fails only where a vertex is not twelve bytes.
        let Ok(adapter) = VertexDataAdapter::new(typed_to_bytes(&places), size_of::<[f32; 3]>(), 0) else {
            return Simplified {
                mesh: self.clone(),
                moved_mm: 0.0,
            };
        };
        let mut moved_mm = 0.0;
        let options = SimplifyOptions::ErrorAbsolute;
        let kept = simplify(
            &indices,
            &adapter,
            3 * most,
            within_mm as f32,
            options,
            Some(&mut moved_mm),
        );
        Simplified {
            mesh: self.of_corners(&kept, &vertices.keys),
            moved_mm: moved_mm.into(),
        }
    }

    fn keys(&self, triangle: usize, keep_coordinates: bool) -> [Key; 3] {
        let Triangle { corners, material } = self.triangles[triangle];
        let coordinates = self.coordinates(triangle).filter(|_| keep_coordinates);
        std::array::from_fn(|i| (corners[i], material, coordinates.map(|uv| uv[i].map(f64::to_bits))))
    }

    /// Returns the mesh of these corners, three for each triangle, and of the points that they have.
    fn of_corners(&self, corners: &[u32], keys: &[Key]) -> Self {
        let mut moved = HashMap::new();
        let mut mesh = Self {
            points: Vec::new(),
            triangles: Vec::with_capacity(corners.len() / 3),
            coordinates: Vec::new(),
            ..self.frame_and_materials()
        };
        for corners in corners.chunks_exact(3) {
            let keys = [
                keys[corners[0] as usize],
                keys[corners[1] as usize],
                keys[corners[2] as usize],
            ];
            let points = &mut mesh.points;
            let corners =
                keys.map(|(point, ..)| *moved.entry(point).or_insert_with(|| pushed(points, self.points[point])));
            let material = keys[0].1;
            mesh.triangles.push(Triangle { corners, material });
            mesh.coordinates
                .push(match keys.map(|(.., uv)| uv.map(|uv| uv.map(f64::from_bits))) {
                    [Some(a), Some(b), Some(c)] => Some([a, b, c]),
                    _ => None,
                });
        }
        if mesh.coordinates.iter().all(Option::is_none) {
            mesh.coordinates.clear();
        }
        mesh
    }

    fn frame_and_materials(&self) -> Self {
        Self {
            materials: self.materials.clone(),
            looks: self.looks.clone(),
            frame: self.frame.clone(),
            ..Self::default()
        }
    }
}

fn pushed(points: &mut Vec<Point3<f64>>, point: Point3<f64>) -> usize {
    points.push(point);
    points.len() - 1
}

#[derive(Default)]
struct Vertices {
    keys: Vec<Key>,
    index: HashMap<Key, u32>,
}

impl Vertices {
    fn index(&mut self, key: Key) -> u32 {
        *self.index.entry(key).or_insert_with(|| {
            self.keys.push(key);
            (self.keys.len() - 1) as u32
        })
    }
}
