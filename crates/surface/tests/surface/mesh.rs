//! Each format, good and damaged, written here by hand.

use proptest::prelude::*;

use nalgebra::Point3;
use scaleproof_surface::mesh::{Mesh, MeshError, MeshPlacement, SignedAxis, Triangle};

const BOX_MM: [f64; 3] = [40.0, 20.0, 10.0];

fn obj_of(mesh: &Mesh) -> Vec<u8> {
    let mut text = "mtllib box.mtl\nmtllib more.mtl\n".to_owned();
    for p in mesh.points() {
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.corners.map(|i| i + 1);
        text += &format!("usemtl {}\nf {a} {b} {c}\n", mesh.materials()[triangle.material]);
    }
    text.into_bytes()
}

fn stl_of(mesh: &Mesh, header: &[u8; 5]) -> Vec<u8> {
    let mut bytes = vec![b'.'; 80];
    bytes[..5].copy_from_slice(header);
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for triangle in mesh.triangles() {
        bytes.extend([0; 12]);
        for p in mesh.corners_mm(triangle) {
            bytes.extend(p.iter().flat_map(|c| (*c as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply_of(mesh: &Mesh, ascii: bool) -> Vec<u8> {
    let format = if ascii { "ascii" } else { "binary_little_endian" };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.points().len(),
        mesh.triangles().len()
    )
    .into_bytes();
    for p in mesh.points() {
        if ascii {
            bytes.extend(format!("{} {} {}\n", p.x, p.y, p.z).bytes())
        } else {
            bytes.extend(p.iter().flat_map(|c| (*c as f32).to_le_bytes()))
        }
    }
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.corners;
        if ascii {
            bytes.extend(format!("3 {a} {b} {c}\n").bytes())
        } else {
            bytes.push(3);
            bytes.extend(triangle.corners.iter().flat_map(|i| (*i as i32).to_le_bytes()));
        }
    }
    bytes
}

/// A glTF in metres with its front to +z, below a node that moves and mirrors it.
fn glb_of(mesh: &Mesh) -> Vec<u8> {
    let mut data = Vec::new();
    for p in mesh.points() {
        // Model frame to glTF (front z, left x, up y), mirrored in x by the file and back by its node.
        for c in [-p.y, p.z, p.x] {
            data.extend(((c / 1000.0) as f32).to_le_bytes());
        }
    }
    let points = data.len();
    for triangle in mesh.triangles() {
        // The mirrored file has its triangles the other way round.
        let [a, b, c] = triangle.corners;
        data.extend([a, c, b].iter().flat_map(|i| (*i as u16).to_le_bytes()));
    }
    let (vertices, indices) = (mesh.points().len(), 3 * mesh.triangles().len());
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"materials":[{{"name":"paint"}}],
        "nodes":[{{"children":[1],"translation":[3,4,5]}},{{"mesh":0,"scale":[-1,1,1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3","min":[-1,-1,-1],"max":[1,1,1]}},
        {{"bufferView":1,"componentType":5123,"count":{indices},"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{points}}},{{"buffer":0,"byteOffset":{points},"byteLength":{}}}],
        "buffers":[{{"byteLength":{}}}]}}"#,
        2 * indices,
        data.len()
    )
    .into_bytes();
    scaleproof_testing::glb(json, data)
}

fn load(extension: &str, bytes: &[u8], placement: &MeshPlacement) -> Result<Mesh, MeshError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("m.{extension}"));
    std::fs::write(&path, bytes).unwrap();
    Mesh::load(&path, placement)
}

/// Each format with the same box: extension, bytes, the material it should be of.
fn files() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let mesh = Mesh::cuboid(BOX_MM);
    vec![
        ("obj", obj_of(&mesh), "box"),
        ("stl", stl_of(&mesh, b"STLB "), "solid"),
        ("stl", stl_of(&mesh, b"solid"), "solid"),
        ("ply", ply_of(&mesh, true), "ply"),
        ("ply", ply_of(&mesh, false), "ply"),
        ("glb", glb_of(&mesh), "paint"),
    ]
}

fn volume(mesh: &Mesh) -> f64 {
    let six = |t: &Triangle| {
        let [a, b, c] = mesh.corners_mm(t);
        a.coords.dot(&b.coords.cross(&c.coords))
    };
    mesh.triangles().iter().map(six).sum::<f64>() / 6.0
}

#[test]
fn every_format_gives_the_same_box() {
    assert!((volume(&Mesh::cuboid(BOX_MM)) - 8000.0).abs() < 1e-9, "outward normals");
    for (extension, bytes, material) in files() {
        let mesh = load(extension, &bytes, &MeshPlacement::default()).unwrap();
        assert_eq!((mesh.points().len(), mesh.triangles().len()), (8, 12), "{extension}");
        assert_eq!(mesh.materials(), [material], "{extension}");
        let (low, high) = mesh.bounds_mm();
        assert!(
            (low - Point3::new(-20.0, -10.0, 0.0)).norm() < 1e-3,
            "{extension}: {low}"
        );
        assert!(
            (high - Point3::new(20.0, 10.0, 10.0)).norm() < 1e-3,
            "{extension}: {high}"
        );
        assert!((volume(&mesh) - 8000.0).abs() < 1.0, "{extension}: {}", volume(&mesh));
    }
}

#[test]
fn a_mesh_is_turned_scaled_and_put_on_the_ground() {
    let axis = |text: &str| text.parse::<SignedAxis>().unwrap();
    // The box's y becomes the length; the top becomes what was the front.
    let placement = MeshPlacement {
        front: Some(axis("-y")),
        up: Some(axis("+x")),
        length_mm: Some(100.0),
    };
    let mesh = load("ply", &files()[3].1, &placement).unwrap();
    for (found, expected) in mesh.size_mm().iter().zip([100.0, 50.0, 200.0]) {
        assert!((found - expected).abs() < 1e-9, "{:?}", mesh.size_mm());
    }
    assert_eq!(mesh.bounds_mm().0.z, 0.0);
    assert!(volume(&mesh) > 0.0, "still outward");
    let both = MeshPlacement {
        front: Some(axis("x")),
        up: Some(axis("-x")),
        ..placement
    };
    assert!(matches!(load("ply", &files()[3].1, &both), Err(MeshError::FrontIsUp)));
    assert!("w".parse::<SignedAxis>().is_err());
}

#[test]
fn what_is_no_mesh_is_refused() {
    let usual = MeshPlacement::default();
    let said = |extension: &str, bytes: &[u8]| load(extension, bytes, &usual).unwrap_err().to_string();
    assert!(said("fbx", b"").contains(".glb, .obj, .stl or .ply"));
    assert!(said("obj", b"v 0 0 0\n").contains("has no faces"));
    assert!(said("obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").contains("cannot be read"));
    assert!(said("obj", b"v 0 0 0\nf 1 2 3\n").contains("cannot be read"));
    assert!(said("stl", b"").contains("cannot be read"));
    assert!(said("ply", b"ply\nformat ascii 1.0\nend_header\n").contains("has no faces"));
    assert!(said("glb", b"glTF").contains("cannot be read"));
    let mesh = load("obj", &files()[0].1, &usual).unwrap();
    let error = mesh.materials_named(&["paint".to_owned()]).unwrap_err();
    assert!(error.to_string().contains("it has 'box'"), "{error}");
    for (extension, bytes, _) in files() {
        assert!(load(extension, &bytes[..bytes.len() - 9], &usual).is_err() || extension == "obj");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// Bytes changed, cut off or put in: an answer or a sentence, never a panic, and never for long.
    #[test]
    fn damaged_files_never_panic(
        which in 0..6usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in prop::option::of(any::<prop::sample::Index>()),
        put_in in prop::option::of((any::<prop::sample::Index>(), prop::collection::vec(any::<u8>(), 1..6))),
    ) {
        let (extension, mut bytes, _) = files().swap_remove(which);
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some((at, more)) = put_in {
            let at = at.index(bytes.len());
            bytes.splice(at..at, more);
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Err(error) = load(extension, &bytes, &MeshPlacement { length_mm: Some(100.0), ..MeshPlacement::default() }) {
            let sentence = error.to_string();
            prop_assert!(sentence.lines().count() == 1, "{sentence}");
        }
    }
}
