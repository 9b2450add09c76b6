//! The model that a command works on: its mesh, which of it is paint, its size.
//!
//! Here alone is decided what wins: an option that is given; else what the scene says, if the mesh is the scene's; else what the format says.

use std::error::Error;
use std::path::{Path, PathBuf};

use super::vehicle;
use crate::cli::args::model::ModelArgs;
use crate::cli::{Result, units};
use scaleproof_core::spelling::count;
use scaleproof_plot::lettering;
use scaleproof_pose::scene::{ScaleModel, Scene};
use scaleproof_print::template::check_scale;
use scaleproof_session::envelope;
use scaleproof_surface::mesh::{Mesh, MeshError, MeshPlacement};
use scaleproof_surface::model::{self, Model, ModelError, ModelRequest};

impl ModelArgs {
    pub fn load(&self) -> Result<Model> {
        self.load_or(None)
    }

    /// Loads the model; where neither `--mesh` nor the scene names a mesh, the one that brings the texture is taken, if there is one.
    pub fn load_or(&self, textured: Option<&Path>) -> Result<Model> {
        let scene = self.scene.as_deref().map(Scene::open).transpose()?;
        let request = self.request(scene.as_ref(), textured)?;
        let model = request.read().map_err(|e| match e {
            ModelError::Message(e) => Box::<dyn Error>::from(e),
            ModelError::Mesh(e) => e.into(),
        })?;
        if model.file.is_some() {
            let class = scene.as_ref().map(|scene| &scene.model.class);
            units::note(vehicle::on_its_side(class, model.mesh.size_mm()));
        }
        note_repeated(request.faces.as_deref(), model.repeated_faces);
        Ok(model)
    }

    fn request(&self, scene: Option<&Scene>, textured: Option<&Path>) -> Result<ModelRequest> {
        let filled = self.with_what_the_scene_says(scene);
        let mesh = filled.mesh.clone().or(textured.map(Path::to_owned));
        let placement = filled.placement()?;
        match (&mesh, scene) {
            (None, Some(_)) if let Some(option) = self.of_a_mesh() => {
                return Err(format!("{option} is about a mesh; give --mesh too").into());
            }
            (None, None) => return Err("give --mesh, --scene, or both".into()),
            _ => {}
        }
        let scale = self.scale.or(scene.map(|s| s.model.scale)).unwrap_or(10.0);
        if filled.length_mm.is_none() && scene.is_none() {
            check_scale(scale)?;
        }
        Ok(ModelRequest {
            is_scenes: self.mesh.is_none() && filled.mesh.is_some(),
            mesh,
            placement,
            materials: filled.material,
            faces: filled.faces,
            size_mm: scene.map(|scene| scene.model.size_mm),
            scale,
        })
    }

    /// These options, with what the scene says of its mesh where nothing is given. Of another mesh than its own a scene says nothing.
    pub fn filled(&self) -> Result<ModelArgs> {
        let scene = self.scene.as_deref().map(Scene::open).transpose()?;
        Ok(self.with_what_the_scene_says(scene.as_ref()))
    }

    fn with_what_the_scene_says(&self, scene: Option<&Scene>) -> ModelArgs {
        let mut filled = self.clone();
        let (Some(scene), Some(path)) = (scene, &self.scene) else {
            return filled;
        };
        let Some(mesh) = scene.model.envelope.mesh().map(|mesh| path.with_file_name(mesh)) else {
            return filled;
        };
        if self
            .mesh
            .as_ref()
            .is_some_and(|given| *given != mesh && !scaleproof_core::files::is_same(given, &mesh))
        {
            return filled;
        }
        let placement = envelope::placement(&mesh, &scene.model);
        filled.mesh.get_or_insert(mesh);
        filled.length_mm = self.length_mm.or(placement.length_mm);
        let [front, up] = [placement.front, placement.up].map(|axis| axis.map(|axis| axis.to_string()));
        filled.mesh_front = self.mesh_front.clone().or(front);
        filled.mesh_up = self.mesh_up.clone().or(up);
        if self.material.is_empty() && self.faces.is_none() {
            (filled.material, filled.faces) = paint_of(&scene.model, path);
        }
        filled
    }

    /// An option that was given and says nothing without a mesh.
    pub fn of_a_mesh(&self) -> Option<&'static str> {
        let given = [
            ("--material", !self.material.is_empty()),
            ("--faces", self.faces.is_some()),
            ("--length-mm", self.length_mm.is_some()),
            ("--mesh-front", self.mesh_front.is_some()),
            ("--mesh-up", self.mesh_up.is_some()),
        ];
        given.iter().find_map(|(option, is_given)| is_given.then_some(*option))
    }

    /// Returns the placement of the mesh file in the model frame.
    fn placement(&self) -> Result<MeshPlacement, MeshError> {
        let axis = |text: &Option<String>| text.as_deref().map(str::parse).transpose();
        Ok(MeshPlacement {
            front: axis(&self.mesh_front)?,
            up: axis(&self.mesh_up)?,
            length_mm: self.length_mm,
        })
    }
}

pub fn paint_of(model: &ScaleModel, scene_file: &Path) -> (Vec<String>, Option<PathBuf>) {
    let (materials, faces) = model.mesh.paint.named();
    (materials.to_vec(), faces.map(|path| scene_file.with_file_name(path)))
}

/// Returns a mesh with its paint told from the rest, and the materials that are paint; says which triangles are listed again.
pub fn painted(mesh: Mesh, materials: &[String], faces: Option<&Path>) -> Result<(Mesh, Vec<usize>), MeshError> {
    let painted = model::painted(mesh, materials, faces)?;
    note_repeated(faces, painted.repeated_faces);
    Ok((painted.mesh, painted.materials))
}

/// Says that a list of triangles names some again.
fn note_repeated(faces: Option<&Path>, repeated: usize) {
    if let Some(path) = faces.filter(|_| repeated > 0) {
        say!(
            "note: in {}, a face is named again {}",
            path.display(),
            count(repeated, "time")
        );
    }
}

/// Leaves out triangles of a scan, and says so.
pub fn simplify(model: &mut Model, keep_coordinates: bool) {
    if let Some(reduction) = model.simplify(keep_coordinates) {
        say!(
            "note: {} triangles of the mesh were simplified to {}, which moves its surface by about {} mm",
            reduction.before,
            reduction.after,
            lettering::number((reduction.moved_mm * 1000.0).ceil() / 1000.0)
        );
    }
}
