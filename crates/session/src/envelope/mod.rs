//! The ground truth box of a photo: the model's envelope, projected through the pose and the lens, cut at the photo's border.
//!
//! Three envelopes, from the smallest model up: the **box** of the model's size, the convex **hull** of its mesh, the **mesh** itself. A model
//! that is wholly in the photo has the same truth box from hull and mesh, up to how distortion curves the hull's long
//! edges. They differ at the photo's border, where the hull's box also holds what only bridges a hollow. `chart envelope` measures
//! them; the scene chooses, and without a mesh it can only choose the box.
//!
//! Nothing hides the model: ground and tags are not subtracted, as in a simulator's box of the whole outline.

mod cone;
mod visible;

use std::path::{Path, PathBuf};

use nalgebra::Point3;

use scaleproof_core::geometry::{BoxPx, Rigid, convex_hull};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Envelope, ScaleModel};
use scaleproof_surface::mesh::{Mesh, MeshError, MeshPlacement};
use visible::Pieces;

/// The mesh's box may differ from the scene's by this share of each side, as it may when panels are printed.
const TOLERANCE: f64 = 0.03;

/// Why the mesh of a scene cannot be its envelope.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EnvelopeError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(
        "{path} reaches {reach}: correct size_mm, or export the mesh in mm in the model frame (x to the front, y to the left, z up, origin on \
         the ground under the model's centre)",
        path = path.display()
    )]
    NotTheModel {
        path: PathBuf,
        /// From where to where, and how far the scene's model does.
        reach: String,
    },
}

/// Why a photo with a pose has no truth box.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoTruth {
    #[error("the camera is inside the model's box: step back")]
    InsideModel,
    #[error("part of the model is behind the camera or beyond the camera model: step back")]
    BeyondCamera,
    #[error("the model is not in the photo")]
    OutOfPhoto,
}

/// What is projected, in the model frame, mm. Made once, used for every photo.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvelopeShape {
    size_mm: [f64; 3],
    shape: Shape,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// Points, and the edges and triangles between them.
    Surface {
        points: Vec<Point3<f64>>,
        edges: Vec<[usize; 2]>,
        triangles: Vec<[usize; 3]>,
    },
    /// The hull of these points, drawn anew in each photo: the hull of a projection is the projection of the hull.
    Hull(Vec<Point3<f64>>),
}

impl EnvelopeShape {
    /// The envelope that a scene names; `folder` is the scene file's, from which the mesh's path counts.
    ///
    /// # Errors
    /// A mesh that cannot be read, or that is not as large as the model and in its place.
    pub fn open(model: &ScaleModel, folder: &Path) -> Result<Self, EnvelopeError> {
        match &model.envelope {
            Envelope::Box => Ok(Self::of_box(model)),
            Envelope::Hull(mesh) => Ok(Self::hull(&load(&folder.join(mesh), model)?, model)),
            Envelope::Mesh(mesh) => Ok(Self::surface(&load(&folder.join(mesh), model)?, model)),
        }
    }

    /// The box of the model's size.
    pub fn of_box(model: &ScaleModel) -> Self {
        Self::surface(&Mesh::cuboid(model.size_mm), model)
    }

    /// The convex hull of a mesh in the model frame.
    pub fn hull(mesh: &Mesh, model: &ScaleModel) -> Self {
        Self {
            size_mm: model.size_mm,
            shape: Shape::Hull(mesh.points().to_vec()),
        }
    }

    /// A mesh in the model frame as it is.
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

    /// The box around what the photo holds of the model. In pixels from the photo's corner, as detectors and COCO
    /// count; [`Camera::project`] counts from the middle of the first pixel. `pose` is `T_camera_model`.
    ///
    /// # Errors
    /// A camera inside the model's box, a model partly where the lens model says nothing, a model out of the photo.
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

    /// True inside the model's box.
    fn holds(&self, p: &Point3<f64>) -> bool {
        let [length, width, height] = self.size_mm;
        p.x.abs() < length / 2.0 && p.y.abs() < width / 2.0 && (0.0..height).contains(&p.z)
    }
}

/// The hull that the camera sees of some points in its frame: a polygon at depth 1, before the lens bends it.
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

/// A mesh in the model frame, held against the scene. A `.glb`, which is in metres of the full-size car as often as of the model, is
/// scaled to the scene's length and put on the ground; the other formats are taken as they lie.
pub fn load(path: &Path, model: &ScaleModel) -> Result<Mesh, EnvelopeError> {
    let is_gltf = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
    let placement = MeshPlacement {
        length_mm: is_gltf.then_some(model.size_mm[0]),
        ..MeshPlacement::default()
    };
    let mesh = Mesh::load(path, &placement)?;
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
            let reach = format!(
                "from {:.1} to {:.1} mm along the model's {axis}, but the scene's model from {from:.1} to {to:.1} mm",
                low[i], high[i]
            );
            return Err(EnvelopeError::NotTheModel {
                path: path.to_owned(),
                reach,
            });
        }
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};
    use scaleproof_core::geometry::rigid;

    fn model() -> ScaleModel {
        ScaleModel {
            name: "m".into(),
            scale: 10.0,
            class: "car".parse().unwrap(),
            size_mm: [400.0, 200.0, 100.0],
            envelope: Envelope::Box,
        }
    }

    /// A camera on the model's left at 1100 mm, looking level at its middle; the photo moved by `shift_mm` at the model.
    fn from_the_left(shift_mm: f64, distance_mm: f64) -> Rigid {
        // Camera x = -model x, camera y = -model z, camera z = -model y.
        let rotation = Matrix3::new(-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, -1.0, 0.0);
        rigid::from_matrix(rotation, Vector3::new(shift_mm, 50.0, distance_mm))
    }

    fn camera() -> Camera {
        // The axis meets the photo's very middle.
        Camera::pinhole(1000, 800, 1000.0, 1000.0, 499.5, 399.5)
    }

    /// The boxes of the box itself, of its hull and of its mesh, which must be one.
    fn boxes(pose: &Rigid, camera: &Camera) -> Vec<Result<[f64; 4], NoTruth>> {
        let (model, mesh) = (model(), Mesh::cuboid(model().size_mm));
        let outlines = [
            EnvelopeShape::of_box(&model),
            EnvelopeShape::hull(&mesh, &model),
            EnvelopeShape::surface(&mesh, &model),
        ];
        let rounded = |b: BoxPx| [b.x1, b.y1, b.x2, b.y2].map(|v| (v * 1000.0).round() / 1000.0);
        outlines
            .iter()
            .map(|o| o.box_in_photo(pose, camera).map(rounded))
            .collect()
    }

    #[test]
    fn the_near_side_sets_the_box() {
        // The near side is 1000 mm away: 400 mm × 100 mm there are 400 × 100 px.
        let expected = Ok([300.0, 350.0, 700.0, 450.0]);
        assert_eq!(boxes(&from_the_left(0.0, 1100.0), &camera()), vec![expected; 3]);
    }

    #[test]
    fn a_model_cut_by_the_border_has_the_box_of_its_visible_part() {
        // The near side's right end, at x = 700 + 400, is out of the photo; the far side starts at 500 + 200 / 1.2.
        let expected = Ok([666.667, 350.0, 1000.0, 450.0]);
        assert_eq!(boxes(&from_the_left(400.0, 1100.0), &camera()), vec![expected; 3]);
        // All of the near side is out of the photo. The end of the model leaves it at 1040 mm, where 50 mm are 48.077 px; the
        // cut box of the whole model would be 50 px to each side.
        let expected = Ok([933.333, 351.923, 1000.0, 448.077]);
        assert_eq!(boxes(&from_the_left(720.0, 1100.0), &camera()), vec![expected; 3]);
    }

    #[test]
    fn a_model_that_fills_the_photo_has_the_photo_s_box() {
        // 20 mm before the side: 20 mm of it fill 1000 px, and no edge of it is in the photo.
        let expected = Ok([0.0, 0.0, 1000.0, 800.0]);
        assert_eq!(boxes(&from_the_left(0.0, 120.0), &camera()), vec![expected; 3]);
    }

    #[test]
    fn a_model_outside_the_photo_has_no_box() {
        let none = vec![Err(NoTruth::OutOfPhoto); 3];
        assert_eq!(boxes(&from_the_left(5000.0, 1100.0), &camera()), none);
        let behind = boxes(&from_the_left(0.0, -1100.0), &camera());
        assert_eq!(behind[0], Err(NoTruth::OutOfPhoto));
        assert_eq!(behind[1], Err(NoTruth::BeyondCamera));
        let inside = from_the_left(0.0, 50.0);
        assert_eq!(boxes(&inside, &camera()), vec![Err(NoTruth::InsideModel); 3]);
    }

    /// A camera over the front end that looks along the model: part of it is behind the camera.
    #[test]
    fn a_model_partly_behind_the_camera_has_the_box_of_the_rest() {
        // Camera x = model y, camera y = -model z, camera z = model x turned: looks to the rear from x = 150, z = 130.
        let rotation = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0);
        let pose = rigid::from_matrix(rotation, Vector3::new(0.0, 130.0, 150.0));
        let found = boxes(&pose, &camera());
        // The roof's rear edge, 350 mm away and 30 mm below the axis; the roof reaches the photo's lower border and both sides.
        assert_eq!(found[0], Ok([0.0, 485.714, 1000.0, 800.0]));
        assert_eq!(found[0], found[2]);
        assert_eq!(
            found[1],
            Err(NoTruth::BeyondCamera),
            "a hull is drawn of what is before the camera only"
        );
    }

    #[test]
    fn a_lens_that_ends_within_the_photo_is_no_truth() {
        // Directions beyond 1.15 do not exist: 770 px from the centre of a photo that is 1000 px to each side.
        let lens = Camera::pinhole(2000, 2000, 1000.0, 1000.0, 999.5, 999.5).with_distortion(&[-0.25]);
        let near = boxes(&from_the_left(0.0, 250.0), &lens);
        assert_eq!(near, vec![Err(NoTruth::BeyondCamera); 3]);
        assert!(boxes(&from_the_left(0.0, 1100.0), &lens).iter().all(Result::is_ok));
    }
}
