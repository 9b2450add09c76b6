//! Meshes as other programs write them. Areas and sizes are those of shapely and trimesh.

use std::f64::consts::TAU;
use std::fmt::Write;

use proptest::prelude::*;

use nalgebra::{Rotation3, Vector3};
use scaleproof_surface::mesh::{ImageSource, Mesh, MeshPlacement};
use scaleproof_surface::texture::MappedImages;
use scaleproof_testing::{glb, home};

/// A file of `tests/data/cases`.
fn stored(name: &str) -> Result<Mesh, String> {
    let path = home().join("tests/data/cases").join(name);
    Mesh::load(&path, &MeshPlacement::default()).map_err(|e| e.to_string())
}

fn load(extension: &str, content: impl AsRef<[u8]>) -> Result<Mesh, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("m.{extension}"));
    std::fs::write(&path, content).unwrap();
    Mesh::load(&path, &MeshPlacement::default()).map_err(|e| e.to_string())
}

/// Of all triangles.
fn area_mm2(mesh: &Mesh) -> f64 {
    let areas = (0..mesh.triangles().len()).map(|i| 0.5 * mesh.normal_mm2(i).norm());
    areas.sum()
}

/// One face with these corners in a plane, as OBJ.
fn face(corners: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for [x, y] in corners {
        writeln!(text, "v {x} {y} 3").unwrap();
    }
    text + "f" + &(1..=corners.len()).map(|i| format!(" {i}")).collect::<String>() + "\n"
}

/// A square of 10 with a square hole of 4 that a bridge joins to the border.
const WITH_HOLE: [[f64; 2]; 10] = [
    [0.0, 0.0],
    [10.0, 0.0],
    [10.0, 10.0],
    [0.0, 10.0],
    [0.0, 0.0],
    [3.0, 3.0],
    [3.0, 7.0],
    [7.0, 7.0],
    [7.0, 3.0],
    [3.0, 3.0],
];

#[test]
fn a_face_that_is_not_convex_keeps_its_outline() {
    let (ngon, triangles) = (stored("arch_ngon.obj").unwrap(), stored("arch_tri.obj").unwrap());
    for mesh in [&ngon, &triangles] {
        assert!((area_mm2(mesh) - 303_947.876).abs() < 0.5, "{}", area_mm2(mesh));
    }
    let left = |mesh: &Mesh| {
        let normals = (0..mesh.triangles().len()).map(|i| mesh.normal_mm2(i));
        normals
            .filter(|n| n.y.abs() > 0.999 * n.norm())
            .map(|n| 0.5 * n.norm())
            .sum::<f64>()
    };
    assert!((left(&ngon) - 2.0 * 42_535.361_6).abs() < 0.1, "{}", left(&ngon));

    let cases: [(&str, &[[f64; 2]], f64); 5] = [
        (
            "L",
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]],
            6.0,
        ),
        ("concave quad", &[[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]], 4.0),
        ("a hole", &WITH_HOLE, 84.0),
        (
            "a corner twice",
            &[[1.0, 1.0], [0.0, 4.0], [0.0, 0.0], [0.0, 0.0], [4.0, 0.0]],
            4.0,
        ),
        (
            "corners on a line",
            &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]],
            2.5,
        ),
    ];
    for (what, corners, area) in cases {
        for start in 0..corners.len() {
            let turned: Vec<_> = corners
                .iter()
                .cycle()
                .skip(start)
                .take(corners.len())
                .copied()
                .collect();
            let mirrored: Vec<_> = turned.iter().rev().copied().collect();
            for corners in [turned, mirrored] {
                let mesh = load("obj", face(&corners)).unwrap();
                assert!(
                    (area_mm2(&mesh) - area).abs() < 1e-9,
                    "{what} from {start}: {}",
                    area_mm2(&mesh)
                );
                assert_eq!(mesh.triangles().len(), corners.len() - 2, "{what}");
            }
        }
    }
}

#[test]
fn a_face_that_crosses_itself_is_named() {
    let star: Vec<_> = (0..5)
        .map(|i| f64::from(2 * i) * TAU / 5.0)
        .map(|a| [a.cos(), a.sin()])
        .collect();
    let cases: [&[[f64; 2]]; 4] = [
        &[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]],
        &[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]],
        &star,
        &[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [2.0, 4.0],
            [2.0, -1.0],
            [1.0, -1.0],
            [1.0, 4.0],
            [0.0, 4.0],
        ],
    ];
    for corners in cases {
        let text = face(corners);
        let line = corners.len() + 1;
        let said = load("obj", &text).unwrap_err();
        assert!(
            said.contains(&format!("the face on line {line} crosses itself")),
            "{said}"
        );
    }
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty uchar y\nproperty double z\nelement face 2\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n2 2 0\n2 0 0\n0 2 0\n3 0 2 1\n4 0 1 2 3\n";
    let said = load("ply", ply).unwrap_err();
    assert!(said.contains("the face with number 1 crosses itself"), "{said}");
}

proptest! {
    /// Radii around a centre, in any plane, from any corner: the area is that of the shoelace formula.
    #[test]
    fn any_simple_outline_keeps_its_area(
        radii in prop::collection::vec(1.0..10.0_f64, 3..40),
        start in any::<prop::sample::Index>(),
        axis in (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64),
        comb in any::<bool>(),
    ) {
        let count = radii.len();
        let mut corners: Vec<[f64; 2]> = radii.iter().enumerate().map(|(i, r)| {
            let angle = TAU * i as f64 / count as f64;
            // Teeth on a straight back, of which hardly any corner sees all.
            if comb { [i as f64, if i % 2 == 0 { 1.0 } else { *r + 1.0 }] } else { [r * angle.cos(), r * angle.sin()] }
        }).collect();
        if comb {
            corners.extend([[count as f64 + 1.0, 0.0], [-1.0, 0.0]]);
        }
        let doubled: f64 = (0..corners.len()).map(|i| {
            let ([a, b], [c, d]) = (corners[i], corners[(i + 1) % corners.len()]);
            a * d - c * b
        }).sum();
        let turn = Rotation3::new(Vector3::new(axis.0, axis.1, axis.2));
        let start = start.index(corners.len());
        let mut text = String::new();
        for [x, y] in corners.iter().cycle().skip(start).take(corners.len()) {
            let p = turn * Vector3::new(*x, *y, 0.0);
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        text += "f";
        (1..=corners.len()).for_each(|i| write!(text, " {i}").unwrap());
        let mesh = load("obj", text).unwrap();
        let area = 0.5 * doubled.abs();
        prop_assert!((area_mm2(&mesh) - area).abs() < 1e-4 * area, "{} of {area}", area_mm2(&mesh));
    }

    /// Any corners at all: triangles or a sentence, and no panic.
    #[test]
    fn any_face_is_cut_or_refused(corners in prop::collection::vec([-3..3_i32, -3..3, -1..1], 3..16)) {
        let mut text: String = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
        text += "f";
        (1..=corners.len()).for_each(|i| write!(text, " {i}").unwrap());
        match load("obj", text) {
            Ok(mesh) => prop_assert_eq!(mesh.triangles().len(), corners.len() - 2),
            Err(said) => prop_assert!(said.contains("crosses itself"), "{said}"),
        }
    }
}

const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

#[test]
fn every_solid_of_an_stl_is_read() {
    let solid = |name: &str, facets: usize| format!("solid {name}\n{}endsolid {name}\n", FACET.repeat(facets));
    let two = solid("a b", 2) + &solid("solid", 3);
    let many = [
        (two.clone(), 5),
        (format!("\n  \n{two}"), 5),
        (format!("\u{feff}{two}"), 5),
        (two.to_uppercase(), 5),
        (two.replace('\n', "\r\n"), 5),
        (two.replace('\n', "\r"), 5),
        (two.replace("\nvertex", " vertex"), 5),
        (two.clone() + "\n\n", 5),
    ];
    for (text, triangles) in many {
        let mesh = load("stl", &text).unwrap_or_else(|e| panic!("{e}: {text}"));
        assert_eq!(mesh.triangles().len(), triangles, "{text}");
    }
    for (text, word) in [
        (two.clone() + FACET, None),
        (two.clone() + "rubbish", Some("line 40 is not understood")),
        (
            two.replace("endsolid solid", ""),
            Some("ends before its last solid does"),
        ),
        (two.replacen("vertex 0 1 0\n", "", 1), Some("line 6 is not understood")),
    ] {
        match (load("stl", &text), word) {
            (Ok(mesh), None) => assert_eq!(mesh.triangles().len(), 6),
            (Err(said), Some(word)) => assert!(said.contains(word), "{said}"),
            (other, _) => panic!("{other:?}: {text}"),
        }
    }
}

#[test]
fn what_follows_the_end_of_a_mesh_is_not_dropped() {
    let stl = [&[b's'; 80][..], &1_u32.to_le_bytes(), &[0; 12], &[1; 38]].concat();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let glb = std::fs::read(home().join("tests/data/cases/box.glb")).unwrap();
    for (extension, content) in [("stl", &stl[..]), ("ply", ply.as_bytes()), ("glb", &glb)] {
        let whole = load(extension, content).unwrap().triangles().len();
        let padded = [content, b"\0\0\0"].concat();
        assert_eq!(load(extension, padded).unwrap().triangles().len(), whole, "{extension}");
        let said = load(extension, [content, b"3 0 1 2\n"].concat()).unwrap_err();
        assert!(said.contains("8 bytes follow"), "{said}");
    }
}

#[test]
fn an_obj_is_read_however_its_lines_are_written() {
    let text = "# box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl paint\nf 1 2 3 4\n";
    let variants = [
        text.to_owned(),
        format!("\u{feff}{text}"),
        format!("\u{feff}{}", text.replacen("# box\n", "", 1)),
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.replace("f 1 2 3", "f 1 2 \\\n 3"),
        text.replace("f 1 2 3", "f 1 2 \\\r\n 3"),
        text.replace("f 1 2 3 4", "F -4 -3 -2 -1").replace("v ", "V "),
        text.replace("f 1", "fo 1"),
    ];
    for text in variants {
        let mesh = load("obj", &text).unwrap_or_else(|e| panic!("{e}: {text:?}"));
        assert_eq!(
            (mesh.triangles().len(), mesh.materials()),
            (2, &["paint".to_owned()][..]),
            "{text:?}"
        );
        assert!((area_mm2(&mesh) - 1.0).abs() < 1e-9);
    }
    assert!((stored("i_cont.obj").unwrap().size_mm()[2] - 100.0).abs() < 1e-9);
    for (face, words) in [
        ("f 0 1 2", "line 7 names corner 0, and corners count from 1 to 4"),
        ("f 1 2 9", "line 7 names corner 9, and corners count from 1 to 4"),
        ("f 1 2 -5", "the face on line 7 is not understood"),
        ("f 1 2 \\\n -9", "the face on line 7 is not understood"),
        ("surf 0 1 0 1 1 2 3 4", "free-form surfaces"),
    ] {
        let said = load("obj", text.replace("f 1 2 3 4", face)).unwrap_err();
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_ply_may_have_whole_numbers() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty int x\nproperty short y\nproperty uchar z\nelement face 1\n\
               property list uchar uint vertex_index\nend_header\n-4 0 0\n4 0 0\n0 3 0\n3 0 1 2\n";
    assert!((area_mm2(&load("ply", ply).unwrap()) - 12.0).abs() < 1e-9);
}

/// Sizes by trimesh, mm: width, height and length in the file's frame become length, width and height of the model's.
#[test]
fn a_gltf_is_read_from_its_own_buffers_and_number_types() {
    for (name, size_mm) in [
        ("box.glb", [455.0, 186.0, 128.0]),
        ("box_q.glb", [455.0, 186.0, 128.0]),
        ("box_webp_optional.glb", [455.0, 186.0, 128.0]),
    ] {
        let size = stored(name).unwrap().size_mm();
        // A quantised coordinate is off by half a step of 0.028 mm.
        assert!((0..3).all(|i| (size[i] - size_mm[i]).abs() < 0.03), "{name}: {size:?}");
    }
    let own = stored("h_buf1diff.glb").unwrap();
    let data = std::fs::read(home().join("tests/data/cases/geo.bin")).unwrap();
    let lows = |axis: usize| (0..24).map(move |i| 12 * i + 4 * axis);
    let at = |i: usize| f32::from_le_bytes(data[i..i + 4].try_into().unwrap());
    let extent = |axis: usize| {
        let values = || lows(axis).map(at);
        1000.0 * f64::from(values().fold(f32::MIN, f32::max) - values().fold(f32::MAX, f32::min))
    };
    let size = own.size_mm();
    for (found, axis) in size.iter().zip([2, 0, 1]) {
        assert!((found - extent(axis)).abs() < 1e-3, "{size:?}");
    }
}

/// A triangle of a file with these views of these buffers.
fn triangle(buffers: &str, views: &str, more: &str, data: &[u8]) -> Result<Mesh, String> {
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}],
        "bufferViews":[{views}],"buffers":[{buffers}]{more}}}"#
    );
    load("glb", glb(json.into_bytes(), data.to_vec()))
}

#[test]
fn what_a_gltf_does_not_hold_is_refused_with_the_reason() {
    let points: Vec<u8> = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|c| c.to_le_bytes())
        .collect();
    let view = r#"{"buffer":0,"byteLength":36}"#;
    let chunk = r#"{"byteLength":36}"#;
    assert!(triangle(chunk, view, "", &points).is_ok());
    let refused = |buffers: &str, views: &str, more: &str, words: &str| {
        let said = triangle(buffers, views, more, &points).unwrap_err();
        assert!(said.contains(words), "{said}");
    };
    let of_second = r#"{"buffer":1,"byteLength":36}"#;
    refused(
        r#"{"byteLength":36},{"byteLength":36}"#,
        of_second,
        "",
        "its data are nowhere",
    );
    refused(
        r#"{"byteLength":36},{"byteLength":36,"uri":"no.bin"}"#,
        of_second,
        "",
        "cannot read",
    );
    refused(
        r#"{"byteLength":36},{"byteLength":36,"uri":"../no.bin"}"#,
        of_second,
        "",
        "not named within",
    );
    refused(r#"{"byteLength":40}"#, view, "", "has 36 bytes of 40");
    refused(
        chunk,
        r#"{"buffer":0,"byteOffset":4,"byteLength":36}"#,
        "",
        "end too early",
    );
    let packed = r#"{"buffer":1,"byteLength":36,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteLength":9}}}"#;
    let stand_in = r#"{"byteLength":36},{"byteLength":36,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}"#;
    let required = r#","extensionsUsed":["EXT_meshopt_compression"],"extensionsRequired":["EXT_meshopt_compression"]"#;
    refused(stand_in, packed, required, "gltfpack: without -c");
    refused(
        chunk,
        view,
        r#","extensionsRequired":["X_cubes"]"#,
        "takes the glTF extension X_cubes",
    );
    // What concerns the look alone does not matter here.
    let look = r#","extensionsRequired":["KHR_materials_unlit","EXT_texture_webp"]"#;
    assert!(triangle(chunk, view, look, &points).is_ok());
    let inside = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    assert!(
        triangle(
            &format!(r#"{chunk},{{"byteLength":36,"uri":"{inside}"}}"#),
            of_second,
            "",
            &[0; 36]
        )
        .is_ok()
    );
}

#[test]
fn an_image_is_taken_from_its_own_buffer() {
    let mesh = stored("h_imgbuf1.glb").unwrap();
    let image = mesh.look(0).and_then(|look| look.image.clone());
    assert!(
        matches!(&image, Some(ImageSource::Refused(why)) if why.contains("not named within")),
        "{image:?}"
    );
    // Written by Pillow, without loss; its coordinates are whole numbers that stand for 0 to 1.
    let mapped = MappedImages::from_mesh(&stored("tri_webp.glb").unwrap(), &[]).unwrap();
    let only = mapped.images.only_image(&[0]).unwrap();
    let pixels: Vec<[u8; 3]> = only.image.pixels().map(|pixel| pixel.0).collect();
    assert_eq!(pixels, [[255, 0, 0], [0, 128, 255], [10, 20, 30], [250, 240, 5]]);
    assert_eq!(only.coordinates, [[[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]]);
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_meshs_folder_is_not_followed() {
    let folder = tempfile::tempdir().unwrap();
    let (inside, outside) = (folder.path().join("in"), folder.path().join("secret.png"));
    std::fs::create_dir(&inside).unwrap();
    std::fs::write(&outside, b"x").unwrap();
    std::fs::write(inside.join("own.png"), b"x").unwrap();
    std::os::unix::fs::symlink(&outside, inside.join("far.png")).unwrap();
    std::os::unix::fs::symlink("own.png", inside.join("near.png")).unwrap();
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    std::fs::write(inside.join("m.obj"), obj).unwrap();
    for (name, is_read) in [("own.png", true), ("near.png", true), ("far.png", false)] {
        std::fs::write(inside.join("a.mtl"), format!("newmtl a\nmap_Kd {name}\n")).unwrap();
        let mesh = Mesh::load(&inside.join("m.obj"), &MeshPlacement::default()).unwrap();
        match &mesh.look(0).unwrap().image {
            Some(ImageSource::File(_)) => assert!(is_read, "{name}"),
            Some(ImageSource::Refused(why)) => assert!(!is_read && why.contains("outside the mesh's folder"), "{why}"),
            other => panic!("{other:?}"),
        }
    }
}
