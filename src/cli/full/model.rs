//! The model that a command works on: its mesh, which of it is paint, its size.

use std::path::{Path, PathBuf};

use crate::cli::Result;
use scaleproof_core::spelling::count;
use scaleproof_pose::scene::Scene;
use scaleproof_print::print::template::check_scale;
use scaleproof_print::print::wrap::check_size;
use scaleproof_surface::mesh::{FaceList, Mesh, MeshError, MeshPlacement};

/// The model.
#[derive(clap::Args)]
pub(crate) struct ModelArgs {
    /// The model's surface: .glb, .obj, .stl or .ply; without it, the box of the scene's model
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// The materials that are the paint; all without it
    #[arg(long, value_name = "NAME", num_args = 1.., conflicts_with = "faces")]
    pub(super) material: Vec<String>,
    /// The triangles that are the paint: a file with their numbers, counted from 0 in the mesh file's order, white space between them
    #[arg(long, value_name = "FILE")]
    pub(super) faces: Option<PathBuf>,
    /// The scene whose model this is: its size is held against the mesh's
    #[arg(long, value_name = "TOML")]
    pub scene: Option<PathBuf>,
    /// Scale the mesh to this length from front to rear, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) length_mm: Option<f64>,
    /// Where the front is in the mesh file: +x, -x, +y, -y, +z or -z [default: +z in a .glb, else +x]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub(super) mesh_front: Option<String>,
    /// Where the top is in the mesh file [default: +y in a .glb, else +z]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub(super) mesh_up: Option<String>,
    /// The model is 1:SCALE (named in the captions) [default: the scene's, else 10]
    #[arg(long, allow_negative_numbers = true)]
    pub scale: Option<f64>,
}

/// A model: its surface in the model frame, which materials are paint, its scale.
pub(crate) struct Model {
    pub mesh: Mesh,
    /// The mesh's file; `None` of a scene's box.
    pub file: Option<PathBuf>,
    pub materials: Vec<usize>,
    pub scale: f64,
}

impl Model {
    /// `a model of 455 × 186 × 128 mm`
    pub(crate) fn in_words(&self) -> String {
        let [length, width, height] = self.mesh.size_mm();
        format!("a model of {length:.0} × {width:.0} × {height:.0} mm")
    }
}

impl ModelArgs {
    pub(crate) fn load(&self) -> Result<Model> {
        self.load_or(None)
    }

    /// Loads the model; without `--mesh`, the mesh that brings the texture is taken, if there is one.
    pub(crate) fn load_or(&self, textured: Option<&Path>) -> Result<Model> {
        let scene = self.scene.as_deref().map(Scene::open).transpose()?;
        let file = self.mesh.as_deref().or(textured);
        let mesh = match (file, &scene) {
            (Some(file), _) => Mesh::load(file, &self.placement()?)?,
            (None, Some(_)) if let Some(option) = self.of_a_mesh() => {
                return Err(format!("{option} is about a mesh; give --mesh too").into());
            }
            (None, Some(scene)) => Mesh::cuboid(scene.model.size_mm),
            (None, None) => return Err("give --mesh, --scene, or both".into()),
        };
        if let Some(scene) = &scene {
            check_size(&mesh, scene.model.size_mm)?;
        }
        mesh.check_is_model()?;
        let scale = self.scale.or(scene.as_ref().map(|s| s.model.scale)).unwrap_or(10.0);
        if self.length_mm.is_none() && scene.is_none() {
            check_scale(scale)?;
            mesh.check_is_scale_model(scale)?;
        }
        let (mesh, materials) = self.painted(mesh)?;
        Ok(Model {
            mesh,
            file: file.map(Path::to_owned),
            materials,
            scale,
        })
    }

    /// The mesh and which of its materials are paint.
    fn painted(&self, mesh: Mesh) -> Result<(Mesh, Vec<usize>), MeshError> {
        let Some(path) = &self.faces else {
            let materials = mesh.materials_named(&self.material)?;
            return Ok((mesh, materials));
        };
        let faces = FaceList::load(path, &mesh)?;
        if faces.repeated > 0 {
            say!(
                "note: in {}, a face is named again {}",
                path.display(),
                count(faces.repeated, "time")
            );
        }
        Ok(mesh.with_paint(&faces))
    }

    /// An option that was given and says nothing without a mesh.
    pub(crate) fn of_a_mesh(&self) -> Option<&'static str> {
        let given = [
            ("--material", !self.material.is_empty()),
            ("--faces", self.faces.is_some()),
            ("--length-mm", self.length_mm.is_some()),
            ("--mesh-front", self.mesh_front.is_some()),
            ("--mesh-up", self.mesh_up.is_some()),
        ];
        given.iter().find_map(|(option, is_given)| is_given.then_some(*option))
    }

    /// How the mesh file lies in the model frame.
    pub(crate) fn placement(&self) -> Result<MeshPlacement, MeshError> {
        let axis = |text: &Option<String>| text.as_deref().map(str::parse).transpose();
        Ok(MeshPlacement {
            front: axis(&self.mesh_front)?,
            up: axis(&self.mesh_up)?,
            length_mm: self.length_mm,
        })
    }
}

/// About a mesh that was turned by `--mesh-front`, or was not.
pub(crate) fn turned([length, width, _]: [f64; 3]) -> Option<String> {
    (width > length).then(|| format!("the model is {length:.0} mm long and {width:.0} mm wide: is --mesh-front right?"))
}

#[cfg(test)]
#[path = "../tests/model.rs"]
mod tests;
