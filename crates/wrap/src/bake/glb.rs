//! Writing of binary glTF 2.0 with embedded images. Its frame is the format's: front to +z, up to +y; a unit of the mesh's file is a metre.

use nalgebra::Matrix3;
use serde_json::{Value, json};

use super::model::{Distinct, TexturedModel, ending};
use scaleproof_surface::mesh::{Mesh, Wrap};

/// OpenGL constants used by the format.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const NEAREST: u32 = 9728;

/// Parts of the file that accumulate while it is written.
#[derive(Default)]
struct Parts {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

/// Returns the file. `turn`: the rotation from the mesh file's frame into the model frame.
pub fn write(mesh: &Mesh, model: &TexturedModel, turn: &Matrix3<f64>) -> Vec<u8> {
    // The model's x is the front, y the left, z the top.
    let to_gltf = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0) * turn;
    let mut parts = Parts::default();
    let mut primitives = Vec::new();
    let (mut materials, mut textures, mut samplers) = (Vec::new(), Vec::new(), Vec::new());
    for (i, skin) in model.skins.iter().enumerate() {
        let [r, g, b] = skin.factor;
        let mut look = json!({"baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5});
        if let Some((image, wrap)) = skin.image {
            let index = textures.len();
            look["baseColorTexture"] = json!({"index": index});
            textures.push(json!({"source": image, "sampler": index}));
            let [s, t] = wrap.map(constant);
            samplers.push(match image {
                // Cells have sharp borders.
                0 => json!({"magFilter": NEAREST, "minFilter": NEAREST, "wrapS": s, "wrapT": t}),
                _ => json!({"wrapS": s, "wrapT": t}),
            });
        }
        // A shell is visible from both sides, as in the previews.
        materials.push(json!({"name": skin.name, "pbrMetallicRoughness": look, "doubleSided": true}));
        primitives.extend(parts.primitive(mesh, model, i, &to_gltf));
    }
    let mut image = |file: &[u8]| {
        let kind = if ending(file) == "jpg" { "jpeg" } else { "png" };
        json!({"bufferView": parts.view(file), "mimeType": format!("image/{kind}")})
    };
    let images: Vec<Value> = model.images.iter().map(|file| image(file)).collect();
    let tree = json!({
        "asset": {"version": "2.0", "generator": concat!("scaleproof ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": materials,
        "textures": textures,
        "samplers": samplers,
        "images": images,
        "accessors": parts.accessors,
        "bufferViews": parts.views,
        "buffers": [{"byteLength": parts.bytes.len()}],
    });
    container(tree.to_string().into_bytes(), parts.bytes)
}

impl Parts {
    /// Adds the faces of a material as a primitive; `None` if it has none.
    fn primitive(&mut self, mesh: &Mesh, model: &TexturedModel, skin: usize, to_gltf: &Matrix3<f64>) -> Option<Value> {
        let mut corners = Distinct::<5>::default();
        let mut indices = Vec::new();
        for face in model.faces.iter().filter(|face| face.skin == skin) {
            for (i, place) in face.places_mm.iter().enumerate() {
                let [x, y, z]: [f64; 3] = (to_gltf * mesh.in_file(place).coords).into();
                // The format's v points down.
                let [u, v] = face.coordinates.map_or([0.0, 1.0], |uv| uv[i]);
                indices.push(corners.index_of([x, y, z, u, 1.0 - v]) as u32);
            }
        }
        if indices.is_empty() {
            return None;
        }
        let corners = corners.values;
        let axis = |i: usize| corners.iter().map(move |corner| corner[i]);
        let places: Vec<f32> = corners.iter().flat_map(|[x, y, z, ..]| [*x, *y, *z]).collect();
        let position = self.accessor(&bytes_of(&places), FLOAT, "VEC3", corners.len());
        self.accessors[position]["min"] = json!([0, 1, 2].map(|i| axis(i).fold(f32::INFINITY, f32::min)));
        self.accessors[position]["max"] = json!([0, 1, 2].map(|i| axis(i).fold(f32::NEG_INFINITY, f32::max)));
        let uv: Vec<f32> = corners.iter().flat_map(|[.., u, v]| [*u, *v]).collect();
        let uv = self.accessor(&bytes_of(&uv), FLOAT, "VEC2", corners.len());
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let order = self.accessor(&bytes, UNSIGNED_INT, "SCALAR", indices.len());
        Some(json!({"attributes": {"POSITION": position, "TEXCOORD_0": uv}, "indices": order, "material": skin}))
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.accessors
            .push(json!({"bufferView": view, "componentType": component, "type": kind, "count": count}));
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }
}

fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn constant(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::MirroredRepeat => 33648,
        Wrap::ClampToEdge => 33071,
    }
}

/// Assembles header, JSON chunk and binary chunk (glTF 2.0, section 4.4).
fn container(mut tree: Vec<u8>, bytes: Vec<u8>) -> Vec<u8> {
    tree.resize(tree.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + tree.len() + 8 + bytes.len();
    let mut file = b"glTF".to_vec();
    let word = |file: &mut Vec<u8>, n: usize| file.extend((n as u32).to_le_bytes());
    word(&mut file, 2);
    word(&mut file, total);
    for (name, chunk) in [(b"JSON", tree), (b"BIN\0", bytes)] {
        word(&mut file, chunk.len());
        file.extend(name);
        file.extend(chunk);
    }
    file
}
