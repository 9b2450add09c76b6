//! A mesh while its file is read.

use std::collections::HashMap;
use std::path::PathBuf;

use nalgebra::Point3;

use super::image::Look;
use super::polygon;
use super::triangles::{Mesh, Triangle};

/// Size of the largest file, bytes: larger ones are no model for a table. A triangle takes 50 bytes in a binary STL.
pub const MAX_BYTES: usize = 200_000_000;
/// Largest number of triangles: more take minutes to print and show nothing more.
pub const MAX_TRIANGLES: usize = 1_000_000;
/// Largest coordinate: more is damage. A thousand kilometres in mm.
const MAX_COORDINATE: f64 = 1e9;

/// Reason why a mesh file is refused, without its name.
pub(super) enum Trouble {
    Damaged(String),
    TooManyTriangles,
}

impl Trouble {
    pub(super) fn damaged(reason: impl ToString) -> Self {
        Self::Damaged(reason.to_string())
    }
}

/// A mesh while its file is read, in the file's frame and unit.
#[derive(Default)]
pub(super) struct Soup {
    /// Folder of the file.
    pub(super) folder: PathBuf,
    pub(super) mesh: Mesh,
    /// Indices of the materials of each name.
    named: HashMap<String, Vec<usize>>,
    /// Index of each place read so far, by the bits of its coordinates.
    index: HashMap<[u64; 3], usize>,
}

/// A corner of a face: its place and its texture coordinates.
pub(super) type Corner = (Point3<f64>, Option<[f64; 2]>);

impl Soup {
    /// Creates an empty mesh of a file in this folder.
    pub(super) fn new(folder: PathBuf) -> Soup {
        Soup {
            folder,
            ..Soup::default()
        }
    }

    pub(super) fn material(&mut self, name: &str, look: Option<Look>) -> usize {
        let (named, mesh) = (self.named.entry(name.to_owned()).or_default(), &mut self.mesh);
        let known = named.iter().find(|material| mesh.looks[**material] == look);
        known.copied().unwrap_or_else(|| {
            named.push(mesh.materials.len());
            mesh.materials.push(name.to_owned());
            mesh.looks.push(look);
            mesh.materials.len() - 1
        })
    }

    pub(super) fn triangle(&mut self, corners: [Corner; 3], material: usize) -> Result<(), Trouble> {
        if self.mesh.triangles.len() >= MAX_TRIANGLES {
            return Err(Trouble::TooManyTriangles);
        }
        let is_bad = |c: &&f64| c.is_nan() || c.abs() > MAX_COORDINATE;
        if let Some(bad) = corners.iter().flat_map(|(p, _)| p.iter()).find(is_bad) {
            return Err(Trouble::Damaged(format!("a coordinate is {bad}")));
        }
        self.mesh.coordinates.push(match corners.map(|(_, uv)| uv) {
            [Some(a), Some(b), Some(c)] => Some([a, b, c]),
            _ => None,
        });
        let corners = corners.map(|(p, _)| self.point(p));
        self.mesh.triangles.push(Triangle { corners, material });
        Ok(())
    }

    /// Adds a face of a mesh file, of any outline that does not cross itself. A message calls it by `name` and `number`.
    pub(super) fn face(
        &mut self,
        corners: &[Corner],
        material: usize,
        name: &str,
        number: usize,
    ) -> Result<(), Trouble> {
        let places: Vec<_> = corners.iter().map(|(place, _)| *place).collect();
        let triangles = polygon::triangles(&places);
        let triangles = triangles.map_err(|why| Trouble::Damaged(format!("the face {name} {number} {why}")))?;
        let mut corners = triangles.into_iter().map(|triangle| triangle.map(|i| corners[i]));
        corners.try_for_each(|corners| self.triangle(corners, material))
    }

    pub(super) fn point(&mut self, p: Point3<f64>) -> usize {
        // Adding zero makes one zero of -0 and 0.
        let key = [p.x + 0.0, p.y + 0.0, p.z + 0.0].map(f64::to_bits);
        let points = &mut self.mesh.points;
        *self.index.entry(key).or_insert_with(|| {
            points.push(p);
            points.len() - 1
        })
    }
}

pub(super) fn corner(points: &[Point3<f64>], index: usize) -> Result<Point3<f64>, Trouble> {
    points
        .get(index)
        .copied()
        .ok_or_else(|| Trouble::Damaged(format!("a face names corner {index} of {}", points.len())))
}
