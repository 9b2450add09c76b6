//! The mesh in memory: corners, triangles, materials.

use std::path::Path;

use nalgebra::{Point3, Vector3};

use super::error::MeshError;
use super::frame::FileFrame;
use super::image::Look;
use scaleproof_core::spelling;

/// The longest side of a model that is printed, mm. A file in metres is below, one in micrometres or damaged is above.
const LONGEST_SIDE_MM: std::ops::RangeInclusive<f64> = 10.0..=5000.0;
/// Longest side of a scale model whose length is not given, mm: a bus at 1:10 is 1.2 m.
const LONGEST_UNMEASURED_MM: f64 = 1500.0;

/// Triangles of a surface with a material and texture coordinates each, model frame, mm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) triangles: Vec<Triangle>,
    pub(super) materials: Vec<String>,
    /// Look of each material; empty when none has any.
    pub(super) looks: Vec<Option<Look>>,
    /// Texture coordinates of each triangle; empty when the file has none.
    pub(super) coordinates: Vec<Option<TextureCoordinates>>,
    pub(super) frame: FileFrame,
}

/// The places of a triangle's corners in its image: u to the right, v up, the image fills the unit square.
pub type TextureCoordinates = [[f64; 2]; 3];

/// Three corners, counter-clockwise seen from outside, and a material, as indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Triangle {
    pub corners: [usize; 3],
    pub material: usize,
}

impl Triangle {
    /// Returns the [`edges`] of its corners.
    pub fn edges(&self) -> [[usize; 2]; 3] {
        edges(self.corners)
    }
}

/// Returns the edges of a triangle from its first corner on, each with its corners in rising order.
pub fn edges([a, b, c]: [usize; 3]) -> [[usize; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
}

impl Mesh {
    /// Makes a box on the ground in the model frame, of one material called `box`; `size_mm` is length, width, height.
    pub fn cuboid(size_mm: [f64; 3]) -> Self {
        let corner = |i: usize| {
            let side = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
            let height = if i >> 2 & 1 == 1 { size_mm[2] } else { 0.0 };
            Point3::new(side(0) * size_mm[0], side(1) * size_mm[1], height)
        };
        // Each face counter-clockwise seen from outside: -x, +x, -y, +y, -z, +z.
        let faces: [[usize; 4]; 6] = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let halves = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        Self {
            points: (0..8).map(corner).collect(),
            triangles: halves.map(|corners| Triangle { corners, material: 0 }).collect(),
            materials: vec!["box".to_owned()],
            ..Self::default()
        }
    }

    /// Returns every corner of the triangles once, model frame, mm.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// Returns the places of a triangle's corners in its image; `None` where the file does not say.
    pub fn coordinates(&self, triangle: usize) -> Option<TextureCoordinates> {
        self.coordinates.get(triangle).copied().flatten()
    }

    /// Returns the look of a material; `None` where the file does not say.
    pub fn look(&self, material: usize) -> Option<&Look> {
        self.looks.get(material).and_then(Option::as_ref)
    }

    /// Returns the corners of a triangle, model frame, mm.
    pub fn corners_mm(&self, triangle: &Triangle) -> [Point3<f64>; 3] {
        triangle.corners.map(|i| self.points[i])
    }

    /// Returns the corners of the triangle with this index, model frame, mm.
    pub fn triangle_mm(&self, index: usize) -> [Point3<f64>; 3] {
        self.corners_mm(&self.triangles[index])
    }

    /// Returns the outward normal of the triangle with this index, as long as twice its area in mm².
    pub fn normal_mm2(&self, index: usize) -> Vector3<f64> {
        doubled_area(&self.triangle_mm(index))
    }

    /// Returns the indices of the triangles of some materials; all triangles when none is named.
    pub fn painted(&self, materials: &[usize]) -> impl Iterator<Item = usize> + Clone {
        let is_paint = move |i: &usize| materials.is_empty() || materials.contains(&self.triangles[*i].material);
        (0..self.triangles.len()).filter(is_paint)
    }

    /// Maps a point of the model frame, mm, to the frame and unit of the mesh's file.
    pub fn in_file(&self, point_mm: &Point3<f64>) -> Point3<f64> {
        self.frame.to_file(point_mm)
    }

    /// Returns the names of the materials, in the file's order.
    pub fn materials(&self) -> &[String] {
        &self.materials
    }

    /// Returns the indices of the materials of these names.
    pub fn materials_named(&self, names: &[String]) -> Result<Vec<usize>, MeshError> {
        let unknown = |name: &&String| !self.materials.contains(name);
        if let Some(name) = names.iter().find(unknown) {
            let mut known: Vec<_> = self.materials.iter().map(|m| format!("'{m}'")).collect();
            known.dedup();
            return Err(MeshError::NoSuchMaterial {
                name: name.clone(),
                known: known.join(", "),
                hint: self.hint(name),
            });
        }
        // Materials with different images may have one name.
        let is_named = |material: &usize| names.contains(&self.materials[*material]);
        Ok((0..self.materials.len()).filter(is_named).collect())
    }

    /// Returns a hint on a name that no material has: a file, several names with commas, or one that is misspelt.
    fn hint(&self, name: &str) -> String {
        let is_several = name.contains(',')
            && name
                .split(',')
                .all(|part| self.materials.iter().any(|m| m == part.trim()));
        if Path::new(name).extension().is_some_and(|ending| ending == "txt") {
            format!("; and there is no file {name}")
        } else if is_several {
            "; several names stand with blanks between them".to_owned()
        } else {
            spelling::hint(name, self.materials.iter().map(String::as_str))
        }
    }

    /// Returns the lowest and the highest corner of the box around the whole mesh, model frame, mm.
    pub fn bounds_mm(&self) -> (Point3<f64>, Point3<f64>) {
        let start = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
        self.points
            .iter()
            .fold(start, |(low, high), p| (low.inf(p), high.sup(p)))
    }

    /// Refuses a mesh that is no model for a table: a file in another unit, or damaged.
    pub fn check_is_model(&self) -> Result<(), MeshError> {
        let size = self.size_mm();
        if LONGEST_SIDE_MM.contains(&size.into_iter().fold(0.0, f64::max)) {
            return Ok(());
        }
        let size_mm = size.map(rounded);
        Err(MeshError::NoModel { size_mm })
    }

    /// Refuses the car itself, as a glTF in metres usually is, where a model of 1:`scale` is needed and its length is not given.
    pub fn check_is_scale_model(&self, scale: f64) -> Result<(), MeshError> {
        let size = self.size_mm();
        if size.into_iter().all(|mm| mm <= LONGEST_UNMEASURED_MM) {
            return Ok(());
        }
        let size_mm = size.map(rounded);
        let at_scale = rounded(size_mm[0] / scale);
        Err(MeshError::LifeSize {
            size_mm,
            at_scale,
            scale,
        })
    }

    /// Returns length, width and height of the box around the whole mesh, mm.
    pub fn size_mm(&self) -> [f64; 3] {
        let (low, high) = self.bounds_mm();
        (high - low).into()
    }
}

/// Returns the outward normal of a triangle, not normalised: as long as twice its area.
pub fn doubled_area(corners: &[Point3<f64>; 3]) -> Vector3<f64> {
    (corners[1] - corners[0]).cross(&(corners[2] - corners[0]))
}

/// Rounds to a micrometre, for sentences.
fn rounded(mm: f64) -> f64 {
    (mm * 1000.0).round() / 1000.0
}
