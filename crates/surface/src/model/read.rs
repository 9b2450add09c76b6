//! A model is read: its mesh is placed and checked against what is known of it.

use std::path::{Path, PathBuf};

use nalgebra::Matrix3;

use super::vehicle;
use crate::mesh::{FaceList, Mesh, MeshError, MeshPlacement, propose_axes};
use scaleproof_core::files;
use scaleproof_core::geometry::length::number;
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::spelling::quoted;

/// Largest difference between mesh and scene, as a share of a side.
const SIZE_TOLERANCE: f64 = 0.03;
/// A mesh with more triangles of paint than this is simplified, since cutting it into pieces takes minutes and gives the same pieces.
#[cfg(feature = "full")]
const MOST_TRIANGLES: usize = 30_000;
/// Number of triangles that are left, where the surface allows it.
#[cfg(feature = "full")]
const SIMPLIFIED: usize = 12_000;
/// Distance by which a simplified surface may move, mm: about the thickness of paper.
#[cfg(feature = "full")]
const PAPER_MM: f64 = 0.1;

/// A model that is to be read: a mesh's file and what is known of it, or a box.
#[derive(Debug, Clone, Default)]
pub struct ModelRequest {
    /// File of the mesh; without one, the model is the box of `size_mm`.
    pub mesh: Option<PathBuf>,
    /// The mesh was named by a scene.
    pub is_scenes: bool,
    pub placement: MeshPlacement,
    /// Names of the materials that are paint; empty for all.
    pub materials: Vec<String>,
    /// File that lists the triangles that are paint.
    pub faces: Option<PathBuf>,
    /// Length, width and height by the scene.
    pub size_mm: Option<[f64; 3]>,
    /// The model is 1:`scale`.
    pub scale: f64,
}

/// A model: its surface in the model frame, which materials are paint, its scale.
#[derive(Debug, Clone)]
pub struct Model {
    pub mesh: Mesh,
    /// The mesh's file; `None` of a box.
    pub file: Option<PathBuf>,
    /// Rotation from the frame of that file into the model frame.
    pub turn: Matrix3<f64>,
    pub materials: Vec<usize>,
    pub scale: f64,
    /// Number of triangles that the list of the paint names again.
    pub repeated_faces: usize,
}

/// A mesh whose materials tell its paint from the rest.
pub struct PaintedMesh {
    pub mesh: Mesh,
    /// Materials that are paint; empty for all.
    pub materials: Vec<usize>,
    /// Number of triangles that the list names again.
    pub repeated_faces: usize,
}

/// Result of leaving out triangles.
#[cfg(feature = "full")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduction {
    /// Numbers of triangles.
    pub before: usize,
    pub after: usize,
    /// Largest distance by which the surface moved.
    pub moved_mm: f64,
}

/// Reason why a model cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    #[error(transparent)]
    Message(#[from] Message),
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl ModelRequest {
    /// Reads the mesh and checks it against its shape, the scene's size and the scale.
    ///
    /// # Errors
    /// Neither a mesh nor a size; a file that is no mesh; one that lies otherwise than it is said to, or has another size.
    pub fn read(&self) -> Result<Model, ModelError> {
        let (mesh, turn) = match (&self.mesh, self.size_mm) {
            (Some(file), _) => (Mesh::load(file, &self.placement)?, self.placement.rotation(file)?),
            (None, Some(size_mm)) => (Mesh::cuboid(size_mm), Matrix3::identity()),
            (None, None) => bail!("the model has neither a mesh nor a size"),
        };
        if let Some(file) = &self.mesh {
            self.check_axes(file, &mesh)?;
        }
        if let Some(size_mm) = self.size_mm {
            check_size(&mesh, size_mm)?;
        }
        mesh.check_is_model()?;
        if self.placement.length_mm.is_none() && self.size_mm.is_none() {
            mesh.check_is_scale_model(self.scale)?;
        }
        let painted = painted(mesh, &self.materials, self.faces.as_deref())?;
        Ok(Model {
            mesh: painted.mesh,
            file: self.mesh.clone(),
            turn,
            materials: painted.materials,
            scale: self.scale,
            repeated_faces: painted.repeated_faces,
        })
    }

    /// Refuses a mesh that lies otherwise than its format says, by its shape, while nobody has said how it lies.
    fn check_axes(&self, file: &Path, mesh: &Mesh) -> Result<(), Message> {
        let said = [self.placement.front, self.placement.up];
        if said.iter().all(Option::is_some) {
            return Ok(());
        }
        let [front, up] = MeshPlacement::usual(file);
        let [front, up] = [said[0].unwrap_or(front), said[1].unwrap_or(up)];
        let other = propose_axes(mesh, said)
            .ok()
            .filter(|found| [found.front, found.up] != [front, up]);
        let name = file.display();
        let Some(shape) = other else {
            return vehicle::lies_oddly(mesh.size_mm()).map_or(Ok(()), |odd| {
                Err(
                    message!("{name}, with its front to {front} and its top to {up}, is {odd}")
                        .hint("give both ‹mesh_front› and ‹mesh_up›, as they are in the file"),
                )
            });
        };
        let (new_front, new_up) = (shape.front, shape.up);
        let remedy = if self.is_scenes {
            format!("write mesh_front = \"{new_front}\" and mesh_up = \"{new_up}\" into the scene")
        } else {
            format!(
                "give ‹mesh_front› {new_front} ‹mesh_up› {new_up}, or say it once: scaleproof scene new ‹mesh› {} ‹length_mm› MM -o scene.toml",
                quoted(&name.to_string())
            )
        };
        bail!(
            "{name} would lie with its front to {front} and its top to {up}, and by its shape they are {new_front} and {new_up}";
            hint: "{remedy} (if it is right as it lies, give ‹mesh_front› {front} ‹mesh_up› {up})"
        )
    }
}

/// Refuses a mesh that differs in size from the scene's model.
fn check_size(mesh: &Mesh, scene_mm: [f64; 3]) -> Result<(), Message> {
    let mesh_mm = mesh.size_mm();
    let differs = |(a, b): (f64, f64)| (a - b).abs() > SIZE_TOLERANCE * b;
    if mesh_mm.into_iter().zip(scene_mm).any(differs) {
        let text = |size: [f64; 3]| size.map(|mm| number((mm * 10.0).round() / 10.0)).join(" × ");
        let (mesh_mm, scene_mm) = (text(mesh_mm), text(scene_mm));
        bail!(
            "the mesh is {mesh_mm} mm (length × width × height) but the scene's model is {scene_mm} mm";
            hint: "give ‹length_mm›, or ‹mesh_front› and ‹mesh_up› if the mesh lies otherwise, or correct size_mm of the scene"
        );
    }
    Ok(())
}

/// Tells the paint of a mesh by the names of its materials, none for all, or by a file that lists its triangles.
///
/// # Errors
/// No material of this name; a file that lists other triangles than the mesh has.
pub fn painted(mesh: Mesh, materials: &[String], faces: Option<&Path>) -> Result<PaintedMesh, MeshError> {
    let Some(path) = faces else {
        return Ok(PaintedMesh {
            materials: mesh.materials_named(materials)?,
            mesh,
            repeated_faces: 0,
        });
    };
    let faces = FaceList::load(path, &mesh)?;
    let (mesh, materials) = mesh.with_paint(&faces);
    Ok(PaintedMesh {
        mesh,
        materials,
        repeated_faces: faces.repeated,
    })
}

impl Model {
    /// `a model of 455 × 186 × 128 mm`
    pub fn in_words(&self) -> String {
        let [length, width, height] = self.mesh.size_mm();
        format!("a model of {length:.0} × {width:.0} × {height:.0} mm")
    }

    /// Returns true for the mesh's own file.
    pub fn is_of_file(&self, path: &Path) -> bool {
        let own = self.file.as_deref();
        own.is_some_and(|own| own == path || files::is_same(own, path))
    }

    /// Leaves out triangles of a scan, which has more of them than pieces need, where the surface stays the same for scissors and paper.
    #[cfg(feature = "full")]
    pub fn simplify(&mut self, keep_coordinates: bool) -> Option<Reduction> {
        let painted = self.mesh.painted(&self.materials).count();
        if painted <= MOST_TRIANGLES {
            return None;
        }
        let before = self.mesh.triangles().len();
        let simplified = self
            .mesh
            .simplified(before * SIMPLIFIED / painted, PAPER_MM, keep_coordinates);
        self.mesh = simplified.mesh;
        Some(Reduction {
            before,
            after: self.mesh.triangles().len(),
            moved_mm: simplified.moved_mm,
        })
    }
}
