//! The model that a command works on: its mesh, which of it is paint, its size.
//!
//! Here alone is decided what wins: an option that is given; else what the scene says, if the mesh is the scene's; else what the format says.

use std::path::{Path, PathBuf};

use nalgebra::Matrix3;

use super::vehicle;
use crate::cli::{Result, units};
use scaleproof_core::spelling::{count, quoted};
use scaleproof_plot::lettering;
use scaleproof_pose::scene::{ScaleModel, Scene};
use scaleproof_print::template::check_scale;
use scaleproof_print::wrap::check_size;
use scaleproof_session::envelope;
use scaleproof_surface::mesh::{FaceList, Mesh, MeshError, MeshPlacement, SignedAxis, propose_axes};

/// A mesh with more triangles of paint than this is simplified, since cutting it into pieces takes minutes and gives the same pieces.
const MOST_TRIANGLES: usize = 30_000;
/// So many are left, where the surface allows it.
const SIMPLIFIED: usize = 12_000;
/// By how much a simplified surface may move, mm: about the thickness of paper.
const PAPER_MM: f64 = 0.1;

/// The model.
#[derive(clap::Args, Clone)]
pub(crate) struct ModelArgs {
    /// The model's surface: .glb, .obj, .stl or .ply; without it, the scene's mesh, or the box of its model
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// The materials that are the paint; without it, the scene's paint, or all
    #[arg(long, value_name = "NAME", num_args = 1.., conflicts_with = "faces")]
    pub(super) material: Vec<String>,
    /// The triangles that are the paint: a file with their numbers, counted from 0 in the mesh file's order, white space between them
    #[arg(long, value_name = "FILE")]
    pub(super) faces: Option<PathBuf>,
    /// The scene whose model this is (`scene new --mesh`): its mesh, axes, paint, size and scale are taken, and an option that is given wins over
    /// what it says. Another mesh than the scene's is held against its size
    #[arg(long, value_name = "TOML")]
    pub scene: Option<PathBuf>,
    /// Scale the mesh to this length from front to rear, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) length_mm: Option<f64>,
    /// Where the front is in the mesh file: +x, -x, +y, -y, +z or -z [default: as the scene says; else +z in a .glb, +x in others]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub(super) mesh_front: Option<String>,
    /// Where the top is in the mesh file [default: as the scene says; else +y in a .glb, +z in others]
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
    /// From the frame of that file into the model frame.
    pub turn: Matrix3<f64>,
    pub materials: Vec<usize>,
    pub scale: f64,
    /// The options, with what the scene says where nothing is given.
    pub said: ModelArgs,
}

impl Model {
    /// `a model of 455 × 186 × 128 mm`
    pub(crate) fn in_words(&self) -> String {
        let [length, width, height] = self.mesh.size_mm();
        format!("a model of {length:.0} × {width:.0} × {height:.0} mm")
    }

    /// Whether this is the mesh's own file.
    pub(super) fn is_of_file(&self, path: &Path) -> bool {
        let own = self.file.as_deref();
        own.is_some_and(|own| own == path || scaleproof_core::files::is_same(own, path))
    }

    /// Leaves out triangles of a scan, which has more of them than pieces need, where the surface stays the same for scissors and paper.
    pub(super) fn simplify(&mut self, keep_coordinates: bool) {
        let painted = self.mesh.painted(&self.materials).count();
        if painted <= MOST_TRIANGLES {
            return;
        }
        let all = self.mesh.triangles().len();
        let most = all * SIMPLIFIED / painted;
        let simplified = self.mesh.simplified(most, PAPER_MM, keep_coordinates);
        self.mesh = simplified.mesh;
        say!(
            "note: {all} triangles of the mesh were simplified to {}, which moves its surface by about {} mm",
            self.mesh.triangles().len(),
            lettering::number((simplified.moved_mm * 1000.0).ceil() / 1000.0)
        );
    }
}

impl ModelArgs {
    pub(crate) fn load(&self) -> Result<Model> {
        self.load_or(None)
    }

    /// Loads the model; where neither `--mesh` nor the scene names a mesh, the one that brings the texture is taken, if there is one.
    pub(crate) fn load_or(&self, textured: Option<&Path>) -> Result<Model> {
        let scene = self.scene.as_deref().map(Scene::open).transpose()?;
        let filled = self.with_what_the_scene_says(scene.as_ref());
        let file = filled.mesh.as_deref().or(textured);
        let placement = filled.placement()?;
        let (mesh, turn) = match (file, &scene) {
            (Some(file), _) => (Mesh::load(file, &placement)?, placement.rotation(file)?),
            (None, Some(_)) if let Some(option) = self.of_a_mesh() => {
                return Err(format!("{option} is about a mesh; give --mesh too").into());
            }
            (None, Some(scene)) => (Mesh::cuboid(scene.model.size_mm), Matrix3::identity()),
            (None, None) => return Err("give --mesh, --scene, or both".into()),
        };
        if let Some(file) = file {
            let is_scenes = self.mesh.is_none() && filled.mesh.is_some();
            ask_about_axes((file, &mesh), [placement.front, placement.up], is_scenes)?;
        }
        if let Some(scene) = &scene {
            check_size(&mesh, scene.model.size_mm)?;
        }
        mesh.check_is_model()?;
        let scale = self.scale.or(scene.as_ref().map(|s| s.model.scale)).unwrap_or(10.0);
        if filled.length_mm.is_none() && scene.is_none() {
            check_scale(scale)?;
            mesh.check_is_scale_model(scale)?;
        }
        if file.is_some() {
            let class = scene.as_ref().map(|scene| &scene.model.class);
            units::note(vehicle::on_its_side(class, mesh.size_mm()));
        }
        let (mesh, materials) = painted(mesh, &filled.material, filled.faces.as_deref())?;
        let file = file.map(Path::to_owned);
        Ok(Model {
            mesh,
            file,
            turn,
            materials,
            scale,
            said: filled,
        })
    }

    /// These options, with what the scene says of its mesh where nothing is given. Of another mesh than its own a scene says nothing.
    pub(crate) fn filled(&self) -> Result<ModelArgs> {
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
    fn placement(&self) -> Result<MeshPlacement, MeshError> {
        let axis = |text: &Option<String>| text.as_deref().map(str::parse).transpose();
        Ok(MeshPlacement {
            front: axis(&self.mesh_front)?,
            up: axis(&self.mesh_up)?,
            length_mm: self.length_mm,
        })
    }
}

pub(crate) fn paint_of(model: &ScaleModel, scene_file: &Path) -> (Vec<String>, Option<PathBuf>) {
    let (materials, faces) = model.mesh.paint.named();
    (materials.to_vec(), faces.map(|path| scene_file.with_file_name(path)))
}

/// The mesh and which of its materials are paint; none stands for all.
pub(crate) fn painted(mesh: Mesh, materials: &[String], faces: Option<&Path>) -> Result<(Mesh, Vec<usize>), MeshError> {
    let Some(path) = faces else {
        let materials = mesh.materials_named(materials)?;
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

/// Refuses a mesh that lies otherwise than its format says, by its shape, while nobody has said how it lies. `is_scenes`: it is named by a scene.
fn ask_about_axes((file, mesh): (&Path, &Mesh), said: [Option<SignedAxis>; 2], is_scenes: bool) -> Result<(), String> {
    if said.iter().all(Option::is_some) {
        return Ok(());
    }
    let [front, up] = MeshPlacement::usual(file);
    let [front, up] = [said[0].unwrap_or(front), said[1].unwrap_or(up)];
    let other = propose_axes(mesh, said)
        .ok()
        .filter(|found| [found.front, found.up] != [front, up]);
    let Some(shape) = other else {
        return units::lies_as_a_vehicle(mesh.size_mm()).map_or(Ok(()), |odd| {
            let file = file.display();
            Err(format!(
                "{file}, with its front to {front} and its top to {up}, is {odd}: give both --mesh-front and --mesh-up, as they are in the file"
            ))
        });
    };
    let (file, new_front, new_up) = (file.display(), shape.front, shape.up);
    let remedy = if is_scenes {
        format!("write mesh_front = \"{new_front}\" and mesh_up = \"{new_up}\" into the scene")
    } else {
        let quoted = quoted(&file.to_string());
        format!(
            "give --mesh-front {new_front} --mesh-up {new_up}, or say it once: scaleproof scene new --mesh {quoted} --length-mm MM -o scene.toml"
        )
    };
    Err(format!(
        "{file} would lie with its front to {front} and its top to {up}, and by its shape they are {new_front} and {new_up}: {remedy} (if it is right as \
         it lies, give --mesh-front {front} --mesh-up {up})"
    ))
}
