//! The model that a command works on: its mesh, which of it is paint, its size.

use std::error::Error;
use std::path::PathBuf;

use crate::mesh::{Mesh, MeshError, MeshPlacement};
use crate::print::template::check_scale;
use crate::print::wrap::{WrapError, check_size};
use crate::scene::Scene;

/// The model.
#[derive(clap::Args)]
pub(crate) struct ModelArgs {
    /// The model's surface: .glb, .obj, .stl or .ply; without it, the box of the scene's model
    #[arg(long, value_name = "FILE", required_unless_present = "scene")]
    pub mesh: Option<PathBuf>,
    /// The materials that are the paint; all without it
    #[arg(long, value_name = "NAME", num_args = 1.., requires = "mesh")]
    material: Vec<String>,
    /// The scene whose model this is: its size is held against the mesh's
    #[arg(long, value_name = "TOML")]
    pub scene: Option<PathBuf>,
    /// Scale the mesh to this length from front to rear, in mm
    #[arg(long, value_name = "MM", requires = "mesh", allow_negative_numbers = true)]
    length_mm: Option<f64>,
    /// Where the front is in the mesh file: +x, -x, +y, -y, +z or -z [default: +z in a .glb, else +x]
    #[arg(long, value_name = "AXIS", requires = "mesh", allow_hyphen_values = true)]
    mesh_front: Option<String>,
    /// Where the top is in the mesh file [default: +y in a .glb, else +z]
    #[arg(long, value_name = "AXIS", requires = "mesh", allow_hyphen_values = true)]
    mesh_up: Option<String>,
    /// The model is 1:SCALE (named in the captions) [default: the scene's, else 10]
    #[arg(long, allow_negative_numbers = true)]
    scale: Option<f64>,
}

/// A model: its surface in the model frame, which materials are paint, its scale.
pub(crate) struct Model {
    pub mesh: Mesh,
    pub materials: Vec<usize>,
    pub scale: f64,
}

impl ModelArgs {
    pub(crate) fn load(&self) -> Result<Model, Box<dyn Error>> {
        let scene = self.scene.as_deref().map(Scene::open).transpose()?;
        let mesh = match (&self.mesh, &scene) {
            (Some(file), _) => Mesh::load(file, &self.placement()?)?,
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
        Ok(Model {
            materials: mesh.materials_named(&self.material)?,
            mesh,
            scale,
        })
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

    /// What was said about the mesh besides its file, as arguments again.
    pub(crate) fn described(&self) -> String {
        let mut text = String::new();
        if !self.material.is_empty() {
            text += &format!(" --material {}", self.material.join(" "));
        }
        if let Some(length_mm) = self.length_mm {
            text += &format!(" --length-mm {length_mm}");
        }
        for (key, axis) in [("front", &self.mesh_front), ("up", &self.mesh_up)] {
            if let Some(axis) = axis {
                text += &format!(" --mesh-{key} {axis}");
            }
        }
        text
    }
}

/// What to do about an error of the library.
pub(crate) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(WrapError::OtherSize { .. }) = error.downcast_ref() {
        return Some("; give --length-mm, or --mesh-front and --mesh-up if the mesh lies otherwise, or correct size_mm of the scene".into());
    }
    match error.downcast_ref()? {
        MeshError::NoModel { .. } => Some(" (--length-mm)".into()),
        MeshError::LifeSize { .. } => Some("; the option is --length-mm".into()),
        _ => None,
    }
}
