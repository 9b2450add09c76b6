//! Binary glTF 2.0, with the transforms of its nodes applied: positions, texture coordinates and base colours. In metres, y up.

use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Glb, Node, Primitive, Semantic};
use nalgebra::{Matrix4, Point3};

use super::gltf_look::{Placing, looks};
use super::image::Look;
use super::{Soup, Trouble, corner};

/// The header of the file: the magic word, the version, the length of the whole.
const HEADER: usize = 12;
/// Deeper trees than this are circles.
const MAX_DEPTH: usize = 100;
/// What a primitive without a material is called.
const NO_MATERIAL: &str = "none";

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let (document, blob) = document(bytes)?;
    let blob = blob
        .as_deref()
        .ok_or_else(|| Trouble::damaged("its data are in other files; save everything in one .glb"))?;
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let roots = scene.ok_or_else(|| Trouble::damaged("it has no scene"))?;
    let file = File {
        blob,
        looks: looks(&document, blob, &soup.folder),
    };
    let mut budget = 100_000;
    for root in roots.nodes() {
        visit(&root, &Matrix4::identity(), 0, &mut budget, &file, soup)?;
    }
    Ok(())
}

/// What the tree refers to.
struct File<'a> {
    blob: &'a [u8],
    /// Of each material.
    looks: Vec<Look>,
}

/// The checked tree and the data beside it. What the gltf crate trusts although damaged files have it wrong is looked at first.
fn document(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), Trouble> {
    let length = bytes.get(8..).and_then(|rest| rest.first_chunk::<4>());
    if length.is_some_and(|length| (u32::from_le_bytes(*length) as usize) < HEADER) {
        return Err(Trouble::damaged("its header gives no length"));
    }
    let glb = Glb::from_slice(bytes).map_err(Trouble::damaged)?;
    let root = gltf::json::deserialize::from_slice::<gltf::json::Root>(&glb.json).map_err(Trouble::damaged)?;
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut accessors = primitives.flat_map(|p| p.attributes.values());
    if accessors.any(|accessor| accessor.value() >= root.accessors.len()) {
        return Err(Trouble::damaged("a surface names data that are not there"));
    }
    let document = Document::from_json(root).map_err(Trouble::damaged)?;
    Ok((document, glb.bin.map(|data| data.into_owned())))
}

/// `budget` is how many nodes may still be visited: a damaged tree can name a node again and again.
fn visit(
    node: &Node,
    parent: &Matrix4<f64>,
    depth: usize,
    budget: &mut usize,
    file: &File,
    soup: &mut Soup,
) -> Result<(), Trouble> {
    if depth > MAX_DEPTH || *budget == 0 {
        return Err(Trouble::damaged("its nodes run in a circle"));
    }
    *budget -= 1;
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
    let points = positions_of(&positions, file.blob)?;
    let points: Vec<Point3<f64>> = points.map(|p| to_scene.transform_point(&p)).collect();
    let coordinates = texture_coordinates(primitive, file.blob);
    let indices = match primitive.indices() {
        Some(accessor) => whole_numbers(&accessor, file.blob)?,
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

/// Those that the material's image is laid on with, v up; none where the file has none that can be read, since most commands need none.
fn texture_coordinates(primitive: &Primitive, blob: &[u8]) -> Vec<[f64; 2]> {
    let placing = Placing::new(&primitive.material());
    let accessor = primitive.get(&Semantic::TexCoords(placing.set));
    let stored = accessor.and_then(|accessor| pairs(&accessor, blob).ok());
    let stored = stored.unwrap_or_default().into_iter();
    stored.map(|pair| placing.place(pair)).collect()
}

/// Floats, or whole numbers that stand for 0 to 1.
fn pairs(accessor: &Accessor, blob: &[u8]) -> Result<Vec<[f64; 2]>, Trouble> {
    let number: fn(&[u8], usize) -> f64 = match (accessor.dimensions(), accessor.data_type(), accessor.normalized()) {
        (Dimensions::Vec2, DataType::F32, _) => float,
        (Dimensions::Vec2, DataType::U8, true) => |b, i| f64::from(b[i]) / f64::from(u8::MAX),
        (Dimensions::Vec2, DataType::U16, true) => {
            |b, i| f64::from(u16::from_le_bytes([b[2 * i], b[2 * i + 1]])) / f64::from(u16::MAX)
        }
        _ => return Err(Trouble::damaged("texture coordinates are of another kind")),
    };
    Ok(items(accessor, blob)?.map(|b| [number(b, 0), number(b, 1)]).collect())
}

/// The float with this number.
fn float(b: &[u8], i: usize) -> f64 {
    f64::from(f32::from_le_bytes([b[4 * i], b[4 * i + 1], b[4 * i + 2], b[4 * i + 3]]))
}

fn positions_of<'a>(
    accessor: &Accessor,
    blob: &'a [u8],
) -> Result<impl Iterator<Item = Point3<f64>> + use<'a>, Trouble> {
    if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
        return Err(Trouble::damaged("positions are not triples of 32-bit floats"));
    }
    Ok(items(accessor, blob)?.map(|b| Point3::new(float(b, 0), float(b, 1), float(b, 2))))
}

fn whole_numbers(accessor: &Accessor, blob: &[u8]) -> Result<Vec<usize>, Trouble> {
    if accessor.dimensions() != Dimensions::Scalar {
        return Err(Trouble::damaged("indices are not single numbers"));
    }
    let number: fn(&[u8]) -> usize = match accessor.data_type() {
        DataType::U8 => |b| usize::from(b[0]),
        DataType::U16 => |b| usize::from(u16::from_le_bytes([b[0], b[1]])),
        DataType::U32 => |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize,
        _ => return Err(Trouble::damaged("indices are not whole numbers")),
    };
    Ok(items(accessor, blob)?.map(number).collect())
}

/// The bytes of each item. The gltf crate's own readers trust offsets and counts, which damaged files have wrong.
fn items<'a>(accessor: &Accessor, blob: &'a [u8]) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, Trouble> {
    let (Some(view), None) = (accessor.view(), accessor.sparse()) else {
        return Err(Trouble::damaged("it has sparse data, which this program does not read"));
    };
    let (size, count) = (accessor.size(), accessor.count());
    let stride = view.stride().unwrap_or(size).max(size);
    let past_the_end = || Trouble::damaged("its data end too early");
    let data = view
        .offset()
        .checked_add(view.length())
        .and_then(|end| blob.get(view.offset()..end))
        .and_then(|view| view.get(accessor.offset()..))
        .ok_or_else(past_the_end)?;
    let needed = count.saturating_sub(1).checked_mul(stride);
    if count > 0 && needed.and_then(|n| n.checked_add(size)).is_none_or(|n| n > data.len()) {
        return Err(past_the_end());
    }
    Ok((0..count).map(move |i| &data[i * stride..i * stride + size]))
}
