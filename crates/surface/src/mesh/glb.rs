//! Binary glTF 2.0, with the transforms of its nodes applied: positions, texture coordinates and base colours. In metres, y up.

use gltf::mesh::Mode;
use gltf::{Document, Glb, Node, Primitive, Semantic};
use nalgebra::{Matrix4, Point3};

use super::gltf_data::Buffers;
use super::gltf_look::{Placing, looks};
use super::image::Look;
use super::soup::{Soup, Trouble, corner};

/// Length of the file's header: the magic word, the version, the length of the whole.
const HEADER: usize = 12;
/// Largest depth of the tree: deeper ones are circles.
const MAX_DEPTH: usize = 100;
/// Extensions that may be required, as they say nothing of where a surface is, or are handled where they matter: packed data, images.
const PASSED_OVER: [&str; 9] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "KHR_mesh_quantization",
    DRACO,
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];
const DRACO: &str = "KHR_draco_mesh_compression";
/// Extension by which a node has many copies of its mesh, each placed by an accessor.
const INSTANCES: &str = "EXT_mesh_gpu_instancing";
/// Name of the material of a primitive without one.
const NO_MATERIAL: &str = "none";

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let (document, chunk) = document(bytes)?;
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let roots = scene.ok_or_else(|| Trouble::damaged("it has no scene"))?;
    let buffers = Buffers::read(&document, chunk, &soup.folder);
    let looks = looks(&document, &buffers, &soup.folder);
    let file = File { buffers, looks };
    let mut budget = 100_000;
    for root in roots.nodes() {
        visit(&root, &Matrix4::identity(), 0, &mut budget, &file, soup)?;
    }
    Ok(())
}

struct File {
    buffers: Buffers,
    /// Look of each material.
    looks: Vec<Look>,
}

/// Returns the checked tree and the data beside it. Fields that the gltf crate trusts although damaged files have them wrong are checked first.
fn document(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), Trouble> {
    let length = bytes.get(8..).and_then(|rest| rest.first_chunk::<4>());
    let length = length.map_or(bytes.len(), |length| u32::from_le_bytes(*length) as usize);
    if length < HEADER {
        return Err(Trouble::damaged("its header gives no length"));
    }
    let rest = bytes.get(length..).unwrap_or_default();
    if rest.iter().any(|byte| *byte != 0) {
        let more = rest.len();
        return Err(Trouble::Damaged(format!(
            "{more} bytes follow the end that its header gives"
        )));
    }
    let glb = Glb::from_slice(bytes).map_err(Trouble::damaged)?;
    let mut root = gltf::json::deserialize::from_slice::<gltf::json::Root>(&glb.json).map_err(Trouble::damaged)?;
    let is_unknown = |name: &&String| !PASSED_OVER.iter().any(|known| name.starts_with(known));
    if let Some(name) = root.extensions_required.iter().find(is_unknown) {
        return Err(Trouble::Damaged(format!(
            "it takes the glTF extension {name}, which this program does not read; switch that off in the exporter"
        )));
    }
    root.extensions_required.clear();
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut accessors = primitives.flat_map(|p| p.attributes.values());
    if accessors.any(|accessor| accessor.value() >= root.accessors.len()) {
        return Err(Trouble::damaged("a surface names data that are not there"));
    }
    let document = Document::from_json(root).map_err(Trouble::damaged)?;
    Ok((document, glb.bin.map(|data| data.into_owned())))
}

/// Reads a node and those below it. `budget` is the number of nodes that may still be visited: a damaged tree can name a node again and again.
fn visit(
    node: &Node,
    parent: &Matrix4<f64>,
    depth: usize,
    budget: &mut usize,
    file: &File,
    soup: &mut Soup,
) -> Result<(), Trouble> {
    if depth > MAX_DEPTH || *budget == 0 {
        return Err(Trouble::damaged(
            "its nodes run in a circle, or are nested more than a hundred deep",
        ));
    }
    *budget -= 1;
    if node.mesh().is_some() && node.extension_value(INSTANCES).is_some() {
        return Err(Trouble::Damaged(format!(
            "it has copies of a mesh by {INSTANCES}, which this program does not read; switch instancing off in the exporter"
        )));
    }
    let own = Matrix4::from(node.transform().matrix()).cast::<f64>();
    let to_scene = parent * own;
    for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
        read_primitive(&primitive, &to_scene, file, soup)?;
    }
    node.children()
        .try_for_each(|child| visit(&child, &to_scene, depth + 1, budget, file, soup))
}

fn read_primitive(primitive: &Primitive, to_scene: &Matrix4<f64>, file: &File, soup: &mut Soup) -> Result<(), Trouble> {
    match primitive.mode() {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return Ok(()),
        Mode::Triangles => {}
        Mode::TriangleStrip | Mode::TriangleFan => {
            let reason = "it has triangle strips or fans; export plain triangles";
            return Err(Trouble::damaged(reason));
        }
    }
    let positions = primitive
        .get(&Semantic::Positions)
        .ok_or_else(|| Trouble::damaged("a surface has no positions"))?;
    if primitive.extension_value(DRACO).is_some() && positions.view().is_none() {
        return Err(Trouble::damaged(
            "its surfaces are packed by Draco; switch its compression off (Blender: glTF export, Data, Compression; gltf-pipeline: without \
             -d; gltf-transform: --compress false)",
        ));
    }
    let points = file.buffers.tuples::<3>(&positions)?;
    let points: Vec<_> = points.map(|p| to_scene.transform_point(&Point3::from(p))).collect();
    let coordinates = texture_coordinates(primitive, &file.buffers);
    let indices = match primitive.indices() {
        Some(accessor) => file.buffers.indices(&accessor)?,
        None => (0..points.len()).collect(),
    };
    let number = primitive.material().index();
    let name = match (primitive.material().name(), number) {
        (Some(name), _) => name.to_owned(),
        (None, Some(number)) => format!("material {number}"),
        (None, None) => NO_MATERIAL.to_owned(),
    };
    let look = number.and_then(|number| file.looks.get(number));
    let material = soup.material(&name, look.cloned());
    // A mirroring node turns every triangle inside out (glTF 2.0, section 3.7.4).
    let mirrored = to_scene.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
    for [a, b, c] in indices.as_chunks::<3>().0 {
        let whole = |i: usize| Ok((corner(&points, i)?, coordinates.get(i).copied()));
        let [a, b, c] = [whole(*a)?, whole(*b)?, whole(*c)?];
        soup.triangle(if mirrored { [a, c, b] } else { [a, b, c] }, material)?;
    }
    Ok(())
}

/// Returns the texture coordinates of the material's image, with v up; none where the file has none that can be read, since most commands need none.
fn texture_coordinates(primitive: &Primitive, buffers: &Buffers) -> Vec<[f64; 2]> {
    let placing = Placing::new(&primitive.material());
    let accessor = primitive.get(&Semantic::TexCoords(placing.set));
    let stored = accessor.and_then(|accessor| buffers.tuples::<2>(&accessor).ok());
    stored.into_iter().flatten().map(|pair| placing.place(pair)).collect()
}
