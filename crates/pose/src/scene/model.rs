//! The printed scale model: size, class, mesh and paint.

use std::path::{Path, PathBuf};

use nalgebra::Point3;

use super::classes::Classes;
use super::envelope::Envelope;
use scaleproof_core::geometry::SignedAxis;

/// The printed scale model.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaleModel {
    /// Name of the model.
    pub name: String,
    /// 10 for a 1:10 model.
    pub scale: f64,
    /// The labels that count as the model when a detector gives one of them, e.g. `car`.
    pub class: Classes,
    /// Length (x), width (y), height (z) of the printed model in mm.
    pub size_mm: [f64; 3],
    /// The shape whose projection is the ground truth box.
    pub envelope: Envelope,
    /// Orientation of the envelope's mesh in its file, and the painted part of it.
    pub mesh: MeshFacts,
}

/// Properties of a mesh file besides its path: found once by `scene new --mesh`, then used by every command.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MeshFacts {
    /// Directions of the front and the top in the file. With them the mesh is turned, scaled to the model's length and put on the ground under its
    /// centre; without them a `.glb` is oriented as glTF says and other files are in the model frame, in mm.
    pub axes: Option<[SignedAxis; 2]>,
    /// The surface that a print covers.
    pub paint: Paint,
}

#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Paint {
    #[default]
    All,
    Materials(Vec<String>),
    /// The triangles whose indices this file lists; its path is relative to the scene file's folder.
    Faces(PathBuf),
}

impl Paint {
    /// Returns the names of the materials, and the file that lists triangles; neither if all of the mesh is paint.
    pub fn named(&self) -> (&[String], Option<&Path>) {
        match self {
            Paint::All => (&[], None),
            Paint::Materials(names) => (names, None),
            Paint::Faces(path) => (&[], Some(path)),
        }
    }
}

impl ScaleModel {
    /// Replaces the paths of the mesh and of the list of its painted triangles by `place` of them.
    #[must_use]
    pub fn with_files(mut self, place: impl Fn(PathBuf) -> PathBuf) -> Self {
        self.envelope = self.envelope.with_mesh(&place);
        if let Paint::Faces(path) = self.mesh.paint {
            self.mesh.paint = Paint::Faces(place(path));
        }
        self
    }

    /// Returns the files that the scene names, with paths relative to its folder: the mesh, and the list of its painted triangles.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let (_, faces) = self.mesh.paint.named();
        self.envelope.mesh().into_iter().chain(faces)
    }

    /// Returns the target point of viewpoints: the centre of the model's box, model frame, mm.
    pub fn target_mm(&self) -> Point3<f64> {
        Point3::new(0.0, 0.0, self.size_mm[2] / 2.0)
    }

    /// Returns the eight corners of the model's box, model frame, mm. Corner `i` has its x, y, z on the far side if bit 0, 1, 2 of `i` is set.
    pub fn box_corners_mm(&self) -> [Point3<f64>; 8] {
        let [length, width, height] = self.size_mm;
        std::array::from_fn(|i| {
            let side = |bit: usize, size: f64| if i >> bit & 1 == 1 { size / 2.0 } else { -size / 2.0 };
            let up = if i >> 2 & 1 == 1 { height } else { 0.0 };
            Point3::new(side(0, length), side(1, width), up)
        })
    }

    /// Returns true if the model's box, grown by `grown_mm` on each side, cuts the line from a camera to a point; both in the model frame, mm (slabs:
    /// Kay & Kajiya 1986).
    pub fn hides(&self, point: Point3<f64>, camera: Point3<f64>, grown_mm: f64) -> bool {
        let [length, width, height] = self.size_mm;
        let (lows, highs) = ([-length / 2.0, -width / 2.0, 0.0], [length / 2.0, width / 2.0, height]);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let (from, by) = (camera[axis], point[axis] - camera[axis]);
            let (low, high) = (lows[axis] - grown_mm, highs[axis] + grown_mm);
            if by.abs() < 1e-9 {
                if from < low || from > high {
                    return false;
                }
                continue;
            }
            let (a, b) = ((low - from) / by, (high - from) / by);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        enter < leave
    }
}
