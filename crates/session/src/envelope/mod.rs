//! Ground truth box of a photo: the model's envelope, projected through the pose and the lens, clipped to the photo's border.
//!
//! Three envelopes, from the coarsest model up: the **box** of the model's size, the convex **hull** of its mesh, the **mesh** itself. A model that
//! is wholly in the photo has the same box from hull and mesh, except that distortion curves the hull's long edges. They differ at the photo's
//! border, where the hull's box also contains parts that only bridge a hollow. `chart envelope` measures the differences; the scene chooses, and
//! without a mesh only the box is possible.
//!
//! Nothing hides the model: ground and tags are not subtracted, as in a simulator's box of the whole outline.

pub mod cone;
mod error;
mod visible;

pub use error::{EnvelopeError, NoTruth};

use std::path::Path;

use nalgebra::Point3;

use scaleproof_core::files;
use scaleproof_core::geometry::{BoxPx, Rigid, convex_hull};
use scaleproof_core::message::bail;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Envelope, ScaleModel};
use scaleproof_surface::mesh::{Mesh, MeshPlacement, is_gltf, propose_axes};
use visible::Pieces;

/// Maximum difference between the mesh's box and the scene's, as a share of each side, as for printed panels.
const TOLERANCE: f64 = 0.03;

/// Shape to project, in the model frame, mm. Made once, used for every photo.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvelopeShape {
    size_mm: [f64; 3],
    shape: Shape,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// Points, with the edges and triangles between them.
    Surface {
        points: Vec<Point3<f64>>,
        edges: Vec<[usize; 2]>,
        triangles: Vec<[usize; 3]>,
    },
    /// Convex hull of these points, computed in each photo: the hull of a projection is the projection of the hull.
    Hull(Vec<Point3<f64>>),
}

impl EnvelopeShape {
    /// Loads the envelope that a scene names; `folder` is the scene file's, to which the mesh's path is relative.
    pub fn open(model: &ScaleModel, folder: &Path) -> Result<Self, EnvelopeError> {
        match &model.envelope {
            Envelope::Box => Ok(Self::of_box(model)),
            Envelope::Hull(mesh) => Ok(Self::hull(&load(&folder.join(mesh), model)?, model)),
            Envelope::Mesh(mesh) => Ok(Self::surface(&load(&folder.join(mesh), model)?, model)),
        }
    }

    pub fn of_box(model: &ScaleModel) -> Self {
        Self::surface(&Mesh::cuboid(model.size_mm), model)
    }

    /// Returns the convex hull of a mesh in the model frame.
    pub fn hull(mesh: &Mesh, model: &ScaleModel) -> Self {
        Self {
            size_mm: model.size_mm,
            shape: Shape::Hull(mesh.points().to_vec()),
        }
    }

    /// Returns a mesh in the model frame, unchanged.
    pub fn surface(mesh: &Mesh, model: &ScaleModel) -> Self {
        let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.corners).collect();
        let sides = triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
        let mut edges: Vec<_> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        Self {
            size_mm: model.size_mm,
            shape: Shape::Surface {
                points: mesh.points().to_vec(),
                edges,
                triangles,
            },
        }
    }

    /// Returns the box around the part of the model in the photo. In pixels from the photo's corner, as detectors and COCO count; [`Camera::project`]
    /// counts from the centre of the first pixel. `pose` is `T_camera_model`.
    pub fn box_in_photo(&self, pose: &Rigid, camera: &Camera) -> Result<BoxPx, NoTruth> {
        if self.holds(&pose.inverse_transform_point(&Point3::origin())) {
            return Err(NoTruth::InsideModel);
        }
        let pieces = match &self.shape {
            Shape::Surface {
                points,
                edges,
                triangles,
            } => Pieces {
                points: points.iter().map(|p| pose * p).collect(),
                edges: edges.into(),
                triangles: triangles.into(),
            },
            Shape::Hull(points) => flat_hull(points.iter().map(|p| pose * p))?,
        };
        visible::box_of(&pieces, camera)
    }

    fn holds(&self, p: &Point3<f64>) -> bool {
        let [length, width, height] = self.size_mm;
        p.x.abs() < length / 2.0 && p.y.abs() < width / 2.0 && (0.0..height).contains(&p.z)
    }
}

/// Returns the hull of points of the camera frame as a polygon at depth 1, before distortion.
fn flat_hull(points: impl Iterator<Item = Point3<f64>>) -> Result<Pieces<'static>, NoTruth> {
    let flat = points.map(|p| (p.z > 0.0).then(|| [p.x / p.z, p.y / p.z]));
    let hull = convex_hull(flat.collect::<Option<_>>().ok_or(NoTruth::BeyondCamera)?);
    let count = hull.len();
    Ok(Pieces {
        points: hull.iter().map(|[x, y]| Point3::new(*x, *y, 1.0)).collect(),
        edges: (0..count).map(|i| [i, (i + 1) % count]).collect(),
        triangles: (2..count).map(|i| [0, i - 1, i]).collect(),
    })
}

/// Returns the placement of a scene's mesh from its file in the model frame. If the scene states the axes, or for a `.glb`, whose metres are the
/// full-size car's as often as the model's, the mesh is scaled to the scene's length and put on the ground; other meshes keep their position.
pub fn placement(path: &Path, model: &ScaleModel) -> MeshPlacement {
    let axes = model.mesh.axes;
    MeshPlacement {
        front: axes.map(|[front, _]| front),
        up: axes.map(|[_, up]| up),
        length_mm: (is_gltf(path) || axes.is_some()).then_some(model.size_mm[0]),
    }
}

/// Returns a sentence about a vehicle's mesh without stated axes whose shape suggests another orientation than its format; with the file's name.
pub fn lies_otherwise(path: &Path, model: &ScaleModel) -> Option<String> {
    if model.mesh.axes.is_some() || !model.class.are_vehicles() {
        return None;
    }
    let mesh = Mesh::load(path, &placement(path, model)).ok()?;
    let [front, up] = MeshPlacement::usual(path);
    let shape = propose_axes(&mesh, [None, None]).ok()?;
    ([shape.front, shape.up] != [front, up]).then(|| {
        let (file, new_front, new_up) = (files::name_of(path), shape.front, shape.up);
        format!(
            "{file} lies with its front to {front} and its top to {up}, and by its shape they are {new_front} and {new_up}, so that truth boxes may be of a \
             model that is turned: write mesh_front = \"{new_front}\" and mesh_up = \"{new_up}\" into the scene, or, if it is right as it lies, \
             mesh_front = \"{front}\" and mesh_up = \"{up}\""
        )
    })
}

/// Loads a mesh into the model frame by its [`placement`], and compares its size with the scene's.
pub fn load(path: &Path, model: &ScaleModel) -> Result<Mesh, EnvelopeError> {
    let mesh = Mesh::load(path, &placement(path, model))?;
    let (low, high) = mesh.bounds_mm();
    let [length, width, height] = model.size_mm;
    let sides = [
        ("length (x)", -length / 2.0, length / 2.0),
        ("width (y)", -width / 2.0, width / 2.0),
        ("height (z)", 0.0, height),
    ];
    for (i, (axis, from, to)) in sides.into_iter().enumerate() {
        let slack = TOLERANCE * (to - from);
        if (low[i] - from).abs() > slack || (high[i] - to).abs() > slack {
            bail!(
                "{} reaches from {:.1} to {:.1} mm along the model's {axis}, but the scene's model from {from:.1} to {to:.1} mm: correct size_mm, say where its \
                 front and its top are by mesh_front and mesh_up, or export the mesh in mm in the model frame (x to the front, y to the left, z up, origin on \
                 the ground under the model's centre)",
                path.display(),
                low[i],
                high[i]
            );
        }
    }
    Ok(mesh)
}
