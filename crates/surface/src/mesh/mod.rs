//! The model's surface: triangles with a material and texture coordinates each, read from `.glb`, `.obj`, `.stl` or `.ply` and put into the
//! model frame.
//!
//! One file per format; [`place`](MeshPlacement) brings what they give into the model frame: origin on the ground under the
//! model's centre, x to its front, y to its left, z up; mm.

mod axes;
mod faces;
mod glb;
mod gltf_data;
mod gltf_look;
mod image;
mod mtl;
mod obj;
mod paint;
mod placement;
mod ply;
mod polygon;
#[cfg(feature = "full")]
mod simplify;
mod stl;
mod text;

pub use axes::{AxesDoubt, AxesProposal, propose_axes};
pub use faces::FaceList;
pub use image::{ImageSource, Look, Wrap};
pub use paint::{PaintDoubt, propose_paint};
pub use placement::{MeshPlacement, is_gltf};
pub use scaleproof_core::geometry::SignedAxis;
#[cfg(feature = "full")]
pub use simplify::Simplified;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use nalgebra::{Point3, Vector3};

use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::NoDirection;
use scaleproof_core::geometry::length::shown;
use scaleproof_core::spelling;

/// Size of the largest file, bytes: larger ones are no model for a table. A triangle takes 50 bytes in a binary STL.
pub const MAX_BYTES: usize = 200_000_000;
/// Largest number of triangles: more take minutes to print and show nothing more.
pub const MAX_TRIANGLES: usize = 1_000_000;
/// The longest side of a model that is printed, mm. A file in metres is below, one in micrometres or damaged is above.
const LONGEST_SIDE_MM: std::ops::RangeInclusive<f64> = 10.0..=5000.0;
/// Longest side of a scale model whose length is not given, mm: a bus at 1:10 is 1.2 m.
const LONGEST_UNMEASURED_MM: f64 = 1500.0;
/// Largest coordinate: more is damage. A thousand kilometres in mm.
const MAX_COORDINATE: f64 = 1e9;

/// Reason why there is no mesh. Each variant says what to change.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{path} is no mesh this program reads; give a .glb, .obj, .stl or .ply file", path = path.display())]
    UnknownFormat { path: PathBuf },
    #[error("{path} cannot be read as a mesh ({reason}); export it again", path = path.display())]
    Damaged { path: PathBuf, reason: String },
    #[error("{path} has no faces; export the model's surface as triangles", path = path.display())]
    NoFaces { path: PathBuf },
    #[error("{path} is too large ({what}); simplify the mesh", path = path.display())]
    TooLarge { path: PathBuf, what: String },
    #[error("the mesh has no material '{name}'; it has {known}{hint}")]
    NoSuchMaterial { name: String, known: String, hint: String },
    #[error("the list of faces {path} cannot be used ({reason}); it holds the numbers of triangles, counted from 0 in the mesh file's order", path = path.display())]
    FaceList { path: PathBuf, reason: String },
    #[error(transparent)]
    Direction(#[from] NoDirection),
    #[error("front and up of the mesh lie along the same axis; give two different ones")]
    FrontIsUp,
    #[error(
        "the mesh's length cannot be set to {} mm; give the model's length from front to rear in mm, as in 455",
        shown(*value)
    )]
    BadLength { value: f64 },
    #[error(
        "the model would be {} × {} × {} mm (length × width × height), and its longest side must be 10 to 5000 mm; correct \
         size_mm of the scene, or give the model's length", size_mm[0], size_mm[1], size_mm[2]
    )]
    NoModel { size_mm: [f64; 3] },
    #[error(
        "the mesh is {} × {} × {} mm by its file, rather a thing itself than its scale model; give the model's \
         length, as in {at_scale} (1:{scale}) or, if the file is right, {}", size_mm[0], size_mm[1], size_mm[2], size_mm[0]
    )]
    LifeSize {
        size_mm: [f64; 3],
        at_scale: f64,
        scale: f64,
    },
    #[error("the mesh has no length along its front, so it cannot be scaled; check which way its front is")]
    NoLength,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    points: Vec<Point3<f64>>,
    triangles: Vec<Triangle>,
    materials: Vec<String>,
    /// Look of each material; empty when none has any.
    looks: Vec<Option<Look>>,
    /// Texture coordinates of each triangle; empty when the file has none.
    coordinates: Vec<Option<TextureCoordinates>>,
    frame: placement::FileFrame,
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
    /// Reads a file and puts it into the model frame. Corners at the same place become one.
    pub fn load(path: &Path, placement: &MeshPlacement) -> Result<Self, MeshError> {
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        let read = match extension.as_ref().and_then(|e| e.to_str()) {
            Some("glb") => glb::read,
            Some("obj") => obj::read,
            Some("stl") => stl::read,
            Some("ply") => ply::read,
            _ => return Err(MeshError::UnknownFormat { path: path.to_owned() }),
        };
        let bytes = files::read(path)?;
        let too_large = |what| MeshError::TooLarge {
            path: path.to_owned(),
            what,
        };
        if bytes.len() > MAX_BYTES {
            return Err(too_large(format!("{} MB", bytes.len() / 1_000_000)));
        }
        let mut soup = Soup {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            ..Soup::default()
        };
        let read = read(&bytes, &mut soup);
        let mut mesh = soup.mesh;
        if mesh.coordinates.iter().all(Option::is_none) {
            mesh.coordinates.clear();
        }
        match read {
            Ok(()) if mesh.triangles.is_empty() => Err(MeshError::NoFaces { path: path.to_owned() }),
            Ok(()) => placement.apply(mesh, path),
            Err(Trouble::TooManyTriangles) => Err(too_large(format!("more than {MAX_TRIANGLES} triangles"))),
            Err(Trouble::Damaged(reason)) => Err(MeshError::Damaged {
                path: path.to_owned(),
                reason: reason.replace('\n', " "),
            }),
        }
    }

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

    /// Gives some triangles materials of their own, one for each material that they were of, and returns these.
    #[must_use]
    pub fn with_paint(mut self, faces: &FaceList) -> (Self, Vec<usize>) {
        let count = self.materials.len();
        let mut of_old = vec![None; count];
        self.looks.resize(count, None);
        for face in &faces.indices {
            let Some(triangle) = self.triangles.get_mut(*face) else {
                continue;
            };
            let old = triangle.material;
            // The face was listed before, and has its own material.
            let Some(of_old) = of_old.get_mut(old) else { continue };
            triangle.material = *of_old.get_or_insert_with(|| {
                self.materials.push(format!("{} (paint)", self.materials[old]));
                self.looks.push(self.looks[old].clone());
                self.materials.len() - 1
            });
        }
        let paint = (count..self.materials.len()).collect();
        (self, paint)
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

enum Trouble {
    Damaged(String),
    TooManyTriangles,
}

impl Trouble {
    fn damaged(reason: impl ToString) -> Self {
        Self::Damaged(reason.to_string())
    }
}

/// A mesh while its file is read, in the file's frame and unit.
#[derive(Default)]
struct Soup {
    /// Folder of the file.
    folder: PathBuf,
    mesh: Mesh,
    /// Indices of the materials of each name.
    named: HashMap<String, Vec<usize>>,
    /// Index of each place read so far, by the bits of its coordinates.
    index: HashMap<[u64; 3], usize>,
}

/// A corner of a face: its place and its texture coordinates.
type Corner = (Point3<f64>, Option<[f64; 2]>);

impl Soup {
    fn material(&mut self, name: &str, look: Option<Look>) -> usize {
        let (named, mesh) = (self.named.entry(name.to_owned()).or_default(), &mut self.mesh);
        let known = named.iter().find(|material| mesh.looks[**material] == look);
        known.copied().unwrap_or_else(|| {
            named.push(mesh.materials.len());
            mesh.materials.push(name.to_owned());
            mesh.looks.push(look);
            mesh.materials.len() - 1
        })
    }

    fn triangle(&mut self, corners: [Corner; 3], material: usize) -> Result<(), Trouble> {
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
    fn face(&mut self, corners: &[Corner], material: usize, name: &str, number: usize) -> Result<(), Trouble> {
        let places: Vec<_> = corners.iter().map(|(place, _)| *place).collect();
        let triangles = polygon::triangles(&places);
        let triangles = triangles.map_err(|why| Trouble::Damaged(format!("the face {name} {number} {why}")))?;
        let mut corners = triangles.into_iter().map(|triangle| triangle.map(|i| corners[i]));
        corners.try_for_each(|corners| self.triangle(corners, material))
    }

    fn point(&mut self, p: Point3<f64>) -> usize {
        // Adding zero makes one zero of -0 and 0.
        let key = [p.x + 0.0, p.y + 0.0, p.z + 0.0].map(f64::to_bits);
        let points = &mut self.mesh.points;
        *self.index.entry(key).or_insert_with(|| {
            points.push(p);
            points.len() - 1
        })
    }
}

fn corner(points: &[Point3<f64>], index: usize) -> Result<Point3<f64>, Trouble> {
    points
        .get(index)
        .copied()
        .ok_or_else(|| Trouble::Damaged(format!("a face names corner {index} of {}", points.len())))
}
