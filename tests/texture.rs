//! Textures of meshes: files written here with known coordinates, and the published camouflage, against colours read in another way.

use crate::common::{assert_refused, glb as glb_of, home, program, shared, stderr};

use std::path::Path;

use image::{Rgb, RgbImage, Rgba, RgbaImage};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_surface::mesh::{FaceList, Mesh, MeshPlacement, Wrap};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::Card;
use scaleproof_surface::pattern::world_aligned::Side;
use scaleproof_surface::texture::{FaceTexels, Mapped, MappedImages, SidePatterns, SurfacePoint, Texture};
use serde_json::{Value, json};

/// Columns and rows of the image of the tests.
const SIZE: [u32; 2] = [8, 4];

/// Every pixel of it has another colour.
fn colour(column: u32, row: u32) -> [u8; 3] {
    [30 * column as u8, 60 * row as u8, 100]
}

fn picture() -> RgbImage {
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| Rgb(colour(x, y)))
}

fn png(image: impl Into<image::DynamicImage>) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    image.into().write_to(&mut file, image::ImageFormat::Png).unwrap();
    file.into_inner()
}

fn load(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> Mesh {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    Mesh::load(&path, &MeshPlacement::default()).unwrap()
}

fn own_images(mesh: &Mesh) -> Mapped {
    MappedImages::from_mesh(mesh, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A square of two triangles, corners (0, 0), (1, 0), (1, 1), (0, 1) of the plane: the colour at a place of it.
fn at(texture: &Texture, mesh: &Mesh, x: f64, y: f64) -> [u8; 3] {
    let point = if x >= y {
        SurfacePoint {
            triangle: 0,
            weights: [1.0 - x, x - y, y],
        }
    } else {
        SurfacePoint {
            triangle: 1,
            weights: [1.0 - y, x, y - x],
        }
    };
    texture.colour(mesh, &point)
}

const SQUARE: &str = "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\n";

/// The pixel of a place of an image that lies straight on the square, row 0 on top.
fn straight(x: f64, y: f64) -> [u8; 3] {
    let [columns, rows] = SIZE.map(f64::from);
    colour((x * columns) as u32, ((1.0 - y) * rows) as u32)
}

#[test]
fn an_obj_has_the_image_of_its_library_where_its_coordinates_say() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("my paint.png"), png(picture())).unwrap();
    let vt = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    // Faces by numbers from 1, and back from the last; the polygon is cut into a fan.
    for face in ["f 1/1 2/2 3/3 4/4", "vn 0 0 1\nf -4/-4/1 -3/-3/1 -2/-2/1 -1/-1/1"] {
        for options in ["", "-blendu on -mm 0 1 -bm 2 ", "-clamp on -o 0 0 0 -s 1 1 1 -t 0.1 "] {
            let library =
                format!("newmtl other\nmap_Kd no.png\nnewmtl body\nKd 0 0 0\n  map_Kd {options}my paint.png\n");
            std::fs::write(folder.join("a b.mtl"), library).unwrap();
            let mesh = load(
                folder,
                "a.obj",
                format!("mtllib a b.mtl\n{SQUARE}{vt}usemtl body\n{face}\n"),
            );
            let texture = Texture::Images(own_images(&mesh).images);
            for (x, y) in [
                (0.01, 0.01),
                (0.99, 0.01),
                (0.99, 0.99),
                (0.01, 0.99),
                (0.3, 0.8),
                (0.7, 0.4),
            ] {
                assert_eq!(at(&texture, &mesh, x, y), straight(x, y), "{face} {options} {x} {y}");
            }
        }
    }
    // Twice as many repeats, moved by a quarter of the image; beyond the border it begins anew, or goes on with its last texel.
    for (clamp, beyond) in [("off", colour(2, 0)), ("on", colour(7, 0))] {
        let library = format!("newmtl body\nmap_Kd -s 2 2 -o 0.25 0 -clamp {clamp} my paint.png\n");
        std::fs::write(folder.join("a.mtl"), library).unwrap();
        let mesh = load(
            folder,
            "a.obj",
            format!("mtllib a.mtl\n{SQUARE}{vt}usemtl body\nf 1/1 2/2 3/3 4/4\n"),
        );
        let texture = Texture::Images(own_images(&mesh).images);
        assert_eq!(at(&texture, &mesh, 0.01, 0.49), colour(2, 0));
        // u = 2 · 0.51 + 0.25 = 1.27, of which 0.27 · 8 is in column 2.
        assert_eq!(at(&texture, &mesh, 0.51, 0.49), beyond);
    }
}

#[test]
fn a_mesh_is_read_for_its_places_though_its_images_are_missing_or_its_coordinates_damaged() {
    let folder = tempfile::tempdir().unwrap();
    let plain = load(folder.path(), "plain.obj", format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
    let damaged = format!("mtllib none.mtl\n{SQUARE}vt nan 1\nvt x\nvt\nusemtl m\nf 1/1 2/2 3/99\nf 1/0 3/-9 4/3\n");
    let mesh = load(folder.path(), "a.obj", damaged);
    assert_eq!((mesh.points(), mesh.triangles()), (plain.points(), plain.triangles()));
    assert_eq!(mesh.coordinates(0), None, "an index of nothing is no coordinate");
}

/// A glTF of the square (in its x and z, seen from above with its top away from +z), once for each part: coordinates, material.
fn glb(parts: &[(Coordinates, Value)], images: &Value, textures: &Value, samplers: &Value, inside: &[u8]) -> Vec<u8> {
    let mut data = inside.to_vec();
    data.resize(data.len().next_multiple_of(4), 0);
    let mut views = vec![json!({"buffer": 0, "byteOffset": 0, "byteLength": inside.len().max(1)})];
    let mut accessors = Vec::new();
    let mut add = |bytes: &[u8], accessor: Value| {
        views.push(json!({"buffer": 0, "byteOffset": data.len(), "byteLength": bytes.len()}));
        data.extend_from_slice(bytes);
        data.resize(data.len().next_multiple_of(4), 0);
        let mut accessor = accessor;
        accessor["bufferView"] = (views.len() - 1).into();
        accessors.push(accessor);
        accessors.len() - 1
    };
    let mut primitives = Vec::new();
    for (i, (coordinates, _)) in parts.iter().enumerate() {
        let places = [[0.0_f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let bytes: Vec<u8> = places
            .iter()
            .flat_map(|[x, y]| [*x, i as f32, 1.0 - y])
            .flat_map(f32::to_le_bytes)
            .collect();
        let positions = add(
            &bytes,
            json!({"componentType": 5126, "count": 4, "type": "VEC3", "min": [0, i, 0], "max": [1, i, 1]}),
        );
        let (bytes, kind, normalized) = coordinates.bytes();
        let uv = add(
            &bytes,
            json!({"componentType": kind, "count": 4, "type": "VEC2", "normalized": normalized}),
        );
        let corners: Vec<u8> = [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect();
        let indices = add(&corners, json!({"componentType": 5123, "count": 6, "type": "SCALAR"}));
        let mut attributes = json!({"POSITION": positions});
        attributes[format!("TEXCOORD_{}", coordinates.set)] = uv.into();
        primitives.push(json!({"attributes": attributes, "indices": indices, "material": i}));
    }
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "extensionsUsed": ["KHR_texture_transform"], "meshes": [{"primitives": primitives}],
        "materials": parts.iter().map(|(_, material)| material.clone()).collect::<Vec<_>>(),
        "images": images, "textures": textures, "samplers": samplers,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": data.len()}],
    })
    .to_string()
    .into_bytes();
    glb_of(json, data)
}

/// Where the corners of the square lie in the image, v down, and how they are stored.
struct Coordinates {
    places: [[f32; 2]; 4],
    set: u32,
    kind: u32,
}

/// The whole image, upright.
const WHOLE: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

impl Coordinates {
    fn floats(places: [[f32; 2]; 4]) -> Self {
        Self {
            places,
            set: 0,
            kind: 5126,
        }
    }

    fn bytes(&self) -> (Vec<u8>, u32, bool) {
        let all = self.places.iter().flatten();
        match self.kind {
            5121 => (all.map(|c| (255.0 * c) as u8).collect(), 5121, true),
            5123 => (
                all.flat_map(|c| ((65535.0 * c) as u16).to_le_bytes()).collect(),
                5123,
                true,
            ),
            _ => (all.flat_map(|c| c.to_le_bytes()).collect(), 5126, false),
        }
    }
}

fn material(name: &str, texture: Value) -> Value {
    json!({"name": name, "pbrMetallicRoughness": {"baseColorTexture": texture}})
}

/// The mesh of one part; its image is embedded, with these wrap modes.
fn one(coordinates: Coordinates, texture: Value, wrap: u32) -> Mesh {
    let folder = tempfile::tempdir().unwrap();
    let bytes = glb(
        &[(coordinates, material("body", texture))],
        &json!([{"bufferView": 0, "mimeType": "image/png"}]),
        &json!([{"source": 0, "sampler": 0}]),
        &json!([{"wrapS": wrap, "wrapT": wrap}]),
        &png(picture()),
    );
    load(folder.path(), "a.glb", bytes)
}

const REPEAT: u32 = 10497;
const MIRRORED: u32 = 33648;
const CLAMP: u32 = 33071;

#[test]
fn a_glb_has_coordinates_of_every_kind_and_its_v_is_turned_up() {
    for (set, kind) in [(0, 5126), (1, 5126), (0, 5121), (2, 5123)] {
        let coordinates = Coordinates {
            places: WHOLE,
            set,
            kind,
        };
        let mesh = one(coordinates, json!({"index": 0, "texCoord": set}), REPEAT);
        let texture = Texture::Images(own_images(&mesh).images);
        for (x, y) in [
            (0.01, 0.01),
            (0.99, 0.02),
            (0.98, 0.99),
            (0.01, 0.99),
            (0.3, 0.8),
            (0.7, 0.4),
        ] {
            assert_eq!(at(&texture, &mesh, x, y), straight(x, y), "{set} {kind} {x} {y}");
        }
    }
}

#[test]
fn images_lie_inside_a_glb_beside_it_or_in_its_text_and_each_material_has_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let flat = |rgb| png(RgbImage::from_pixel(2, 2, Rgb(rgb)));
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    std::fs::write(folder.path().join("maps/the roof.png"), flat([9, 8, 7])).unwrap();
    let uri = {
        use base64::Engine;
        let text = base64::engine::general_purpose::STANDARD.encode(flat([200, 100, 50]));
        format!("data:image/png;base64,{text}")
    };
    // Materials of one name are two materials when their images differ.
    let plain = json!({"name": "glass", "pbrMetallicRoughness": {"baseColorFactor": [0.0, 1.0, 0.214_041_14, 1.0]}});
    let dim = json!({"name": "dim", "pbrMetallicRoughness":
        {"baseColorTexture": {"index": 2}, "baseColorFactor": [0.5, 1.0, 0.0, 0.0]}});
    let parts = [
        (Coordinates::floats(WHOLE), material("body", json!({"index": 0}))),
        (Coordinates::floats(WHOLE), material("body", json!({"index": 1}))),
        (Coordinates::floats(WHOLE), material("text", json!({"index": 2}))),
        (Coordinates::floats(WHOLE), plain),
        (Coordinates::floats(WHOLE), dim),
    ];
    let bytes = glb(
        &parts,
        &json!([{"bufferView": 0}, {"uri": "maps/the%20roof.png"}, {"uri": uri}]),
        &json!([{"source": 0}, {"source": 1}, {"source": 2}]),
        &json!([]),
        &flat([1, 2, 3]),
    );
    let mesh = load(folder.path(), "a.glb", bytes);
    assert_eq!(mesh.materials(), ["body", "body", "text", "glass", "dim"]);
    assert_eq!(mesh.materials_named(&["body".to_owned()]).unwrap(), [0, 1]);
    let mapped = own_images(&mesh);
    let texture = Texture::Images(mapped.images);
    let middle = |triangle| {
        let weights = [1.0 / 3.0; 3];
        texture.colour(&mesh, &SurfacePoint { triangle, weights })
    };
    assert_eq!([0, 2, 4].map(middle), [[1, 2, 3], [9, 8, 7], [200, 100, 50]]);
    // IEC 61966-2-1: 0.21404 in linear light is 0.5 in sRGB.
    assert_eq!(middle(6), [0, 255, 128]);
    // 200 is 0.57758 in linear light; half of it, 0.28879, is 146.
    assert_eq!(
        middle(8),
        [146, 100, 0],
        "its alpha says nothing, as the material is opaque"
    );
}

#[test]
fn beyond_its_borders_an_image_is_repeated_mirrored_or_held() {
    // A row from u = -2 to u = 2 in the bottom row of texels.
    let places = [[-2.0, 0.99], [2.0, 0.99], [2.0, 0.98], [-2.0, 0.98]];
    let mesh = |wrap| one(Coordinates::floats(places), json!({"index": 0}), wrap);
    let (repeat, mirrored, clamp) = (mesh(REPEAT), mesh(MIRRORED), mesh(CLAMP));
    for step in 0..32_u32 {
        let x = (f64::from(step) + 0.5) / 32.0;
        let (column, turn) = (step % 8, step / 8);
        let read = |mesh: &Mesh| at(&Texture::Images(own_images(mesh).images), mesh, x, 0.5);
        assert_eq!(read(&repeat), colour(column, 3), "{step}");
        let back = if turn % 2 == 1 { 7 - column } else { column };
        assert_eq!(read(&mirrored), colour(back, 3), "{step}");
        let held = if step < 16 { 0 } else { (step - 16).min(7) };
        assert_eq!(read(&clamp), colour(held, 3), "{step}");
    }
    for wrap in [Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge] {
        for place in [0.0, 0.25, 0.999] {
            assert!(
                (wrap.within(place) - place).abs() < 1e-12,
                "{wrap:?} leaves what is within"
            );
        }
    }
}

#[test]
fn a_texture_transform_scales_turns_and_moves_as_its_extension_says() {
    let transform = |offset: [f64; 2], rotation: f64, scale: [f64; 2]| {
        let extension = json!({"offset": offset, "rotation": rotation, "scale": scale, "texCoord": 3});
        let coordinates = Coordinates {
            set: 3,
            ..Coordinates::floats([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        };
        let texture = json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": extension}});
        let mesh = one(coordinates, texture, REPEAT);
        // The first triangle has the corners (0, 0), (1, 0), (1, 1) of the file; back to v down.
        mesh.coordinates(0).unwrap().map(|[u, v]| [u, 1.0 - v])
    };
    let near = |found: [[f64; 2]; 3], expected: [[f64; 2]; 3]| {
        let off = found.iter().flatten().zip(expected.iter().flatten());
        assert!(off.clone().all(|(a, b)| (a - b).abs() < 1e-5), "{found:?} {expected:?}");
    };
    // The extension's two examples: the lower left quadrant of the image, turned clockwise by 90°, and v turned up.
    let quarter = std::f64::consts::FRAC_PI_2;
    near(
        transform([0.0, 1.0], quarter, [0.5, 0.5]),
        [[0.0, 1.0], [0.0, 0.5], [0.5, 0.5]],
    );
    near(
        transform([0.0, 1.0], 0.0, [1.0, -1.0]),
        [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]],
    );
    // All three: translation · rotation · scale, counter-clockwise as seen with v down, which is clockwise by the usual matrix.
    let turn = nalgebra::Rotation2::new(-0.3) * nalgebra::Matrix2::new(2.0, 0.0, 0.0, 0.7);
    let place = |u: f64, v: f64| {
        let p = turn * nalgebra::Vector2::new(u, v) + nalgebra::Vector2::new(0.1, -0.4);
        [p.x, p.y]
    };
    near(
        transform([0.1, -0.4], 0.3, [2.0, 0.7]),
        [place(0.0, 0.0), place(1.0, 0.0), place(1.0, 1.0)],
    );
}

#[test]
fn a_ply_has_coordinates_of_vertices_by_three_names_and_of_faces_with_an_image_each() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a b.png"), png(picture())).unwrap();
    std::fs::write(
        folder.path().join("c.png"),
        png(RgbImage::from_pixel(1, 1, Rgb([7, 7, 7]))),
    )
    .unwrap();
    let corners = ["0 0", "1 0", "1 1", "0 1"];
    for [u, v] in [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]] {
        let vertices: String = corners.iter().map(|c| format!("{c} 0 {c}\n")).collect();
        let text = format!(
            "ply\nformat ascii 1.0\ncomment TextureFile a b.png\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             property float {u}\nproperty double {v}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n{vertices}4 0 1 2 3\n"
        );
        let mesh = load(folder.path(), "a.ply", text);
        let texture = Texture::Images(own_images(&mesh).images);
        for (x, y) in [(0.01, 0.01), (0.99, 0.01), (0.3, 0.8), (0.7, 0.4)] {
            assert_eq!(at(&texture, &mesh, x, y), straight(x, y), "{u} {x} {y}");
        }
    }
    let vertices: String = corners.iter().map(|c| format!("{c} 0\n")).collect();
    let text = format!(
        "ply\nformat ascii 1.0\ncomment TextureFile a b.png\ncomment TextureFile c.png\nelement vertex 4\nproperty float x\nproperty float y\n\
         property float z\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n\
         end_header\n{vertices}3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0 0 1 1 0 1 1\n"
    );
    let mesh = load(folder.path(), "a.ply", text);
    let texture = Texture::Images(own_images(&mesh).images);
    assert_eq!(at(&texture, &mesh, 0.7, 0.4), straight(0.7, 0.4));
    assert_eq!(at(&texture, &mesh, 0.3, 0.8), [7, 7, 7]);
}

#[test]
fn see_through_pixels_show_white_paper() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = load(
        folder.path(),
        "a.obj",
        format!("{SQUARE}vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n"),
    );
    let image = folder.path().join("t.png");
    let mut see_through = RgbaImage::from_pixel(10, 10, Rgba([0, 0, 0, 255]));
    see_through.put_pixel(9, 9, Rgba([0, 0, 0, 0]));
    see_through.save(&image).unwrap();
    let mapped = MappedImages::from_image(&mesh, &[], &image).unwrap();
    assert!(
        mapped.notes[0].contains("1.0 %") && mapped.notes.len() == 1,
        "{:?}",
        mapped.notes
    );
    let texture = Texture::Images(mapped.images);
    assert_eq!(
        [at(&texture, &mesh, 0.95, 0.05), at(&texture, &mesh, 0.85, 0.05)],
        [[255; 3], [0; 3]]
    );
}

#[test]
fn a_border_of_texels_belongs_to_the_triangle_that_asks() {
    // Two triangles whose patches meet in the image at u = 0.5 but not on the model.
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{SQUARE}vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/2 3/4 4/5\n");
    let mesh = load(folder.path(), "a.obj", text);
    let image = folder.path().join("t.png");
    RgbImage::from_fn(2, 1, |x, _| Rgb([255 * x as u8; 3]))
        .save(&image)
        .unwrap();
    let texture = Texture::Images(MappedImages::from_image(&mesh, &[], &image).unwrap().images);
    let corner = |triangle, corner: usize| {
        let mut weights = [0.0; 3];
        weights[corner] = 1.0;
        texture.colour(&mesh, &SurfacePoint { triangle, weights })[0]
    };
    assert_eq!([0, 1, 2].map(|i| corner(0, i)), [0; 3]);
    assert_eq!([0, 1, 2].map(|i| corner(1, i)), [255; 3], "u = 1 is not u = 0");
    // Beside the triangle its border goes on.
    let beside = SurfacePoint {
        triangle: 0,
        weights: [-0.2, 0.6, 0.6],
    };
    assert_eq!(texture.colour(&mesh, &beside), [0; 3]);
    // Half a square of 100 mm on one texel of 1 × 1: 5000 mm² a half texel.
    let texel_mm = texture.texel_mm(&mesh, 0).unwrap();
    assert!((texel_mm - (5000.0_f64 / 0.5).sqrt()).abs() < 1e-6, "{texel_mm}");
}

/// The published camouflage: its own lines of text read here, its atlas by another decoder's buffer.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_atlas_of_a_published_camouflage_is_read_where_its_lines_say() {
    let obj = shared("meshes/rauca_etron/model_save.obj");
    let mesh = Mesh::load(&obj, &MeshPlacement::default()).unwrap();
    let mapped = own_images(&mesh);
    let texture = Texture::Images(mapped.images);
    let text = std::fs::read_to_string(&obj).unwrap();
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').skip(1).map(|w| w.parse().unwrap()).collect() };
    let of = |word: &'static str| text.lines().filter(move |line| line.starts_with(word));
    let vt: Vec<Vec<f64>> = of("vt ").map(numbers).collect();
    let v: Vec<Vec<f64>> = of("v ").map(numbers).collect();
    let faces: Vec<&str> = of("f ").collect();
    assert_eq!((faces.len(), mesh.triangles().len()), (23145, 23145));
    let atlas = image::open(obj.with_file_name("model_save.png")).unwrap().into_rgb8();
    let mut random = Pcg32::seed_from_u64(16);
    let (mut on_border, mut distinct) = (0, std::collections::HashSet::new());
    for _ in 0..10_000 {
        let triangle = random.random_range(0..faces.len());
        let [a, b] = [random.random::<f64>(), random.random::<f64>()];
        let weights = [1.0 - a.sqrt(), a.sqrt() * (1.0 - b), a.sqrt() * b];
        let (mut uv, mut place) = ([0.0; 2], [0.0; 3]);
        for (weight, word) in weights.iter().zip(faces[triangle].split(' ').skip(1)) {
            let (i, j) = word.split_once('/').unwrap();
            let [i, j] = [i, j].map(|n| n.parse::<usize>().unwrap() - 1);
            (0..2).for_each(|k| uv[k] += weight * vt[j][k]);
            (0..3).for_each(|k| place[k] += weight * v[i][k]);
        }
        let point = SurfacePoint { triangle, weights };
        let found = point.place_mm(&mesh);
        assert!(
            (0..3).all(|k| (found[k] - place[k]).abs() < 1e-5),
            "triangle {triangle} lies elsewhere"
        );
        let (x, y) = (uv[0] * 2448.0, (1.0 - uv[1]) * 2432.0);
        let expected = atlas.get_pixel(x as u32, y as u32).0;
        let is_border = [x, y].iter().any(|c| (c - c.round()).abs() < 1e-6);
        on_border += usize::from(is_border);
        distinct.insert(expected);
        assert!(
            is_border || texture.colour(&mesh, &point) == expected,
            "triangle {triangle} at {uv:?}"
        );
    }
    println!(
        "{on_border} of 10000 points on borders of texels, {} colours",
        distinct.len()
    );
    assert!(on_border < 10 && distinct.len() > 1000);
    let sizes: Vec<f64> = (0..faces.len()).filter_map(|i| texture.texel_mm(&mesh, i)).collect();
    println!("{} triangles with texels", sizes.len());
    assert!(sizes.len() > 23_000);
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_faces_of_a_published_camouflage_become_a_material_of_their_own() {
    let list = shared("meshes/rauca_etron/exterior_face.txt");
    let mesh = Mesh::load(&list.with_file_name("model_save.obj"), &MeshPlacement::default()).unwrap();
    let faces = FaceList::load(&list, &mesh).unwrap();
    let before = mesh.clone();
    let (mesh, paint) = mesh.with_paint(&faces);
    assert_eq!(mesh.materials(), ["material_1", "material_1 (paint)"]);
    assert_eq!(paint, [1]);
    let listed: Vec<usize> = std::fs::read_to_string(&list)
        .unwrap()
        .lines()
        .map(|line| line.parse().unwrap())
        .collect();
    for (i, (triangle, old)) in mesh.triangles().iter().zip(before.triangles()).enumerate() {
        assert_eq!(triangle.corners, old.corners);
        assert_eq!(triangle.material == 1, listed.contains(&i), "triangle {i}");
    }
    // Their image is still theirs.
    let middle = SurfacePoint {
        triangle: listed[0],
        weights: [1.0 / 3.0; 3],
    };
    let painted = MappedImages::from_mesh(&mesh, &paint).unwrap();
    let colours = [(painted, &mesh), (own_images(&before), &before)]
        .map(|(mapped, mesh)| Texture::Images(mapped.images).colour(mesh, &middle));
    assert_eq!(colours[0], colours[1]);
}

/// An array file as NumPy 1 writes it.
fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
    while (header.len() + 11) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

/// The rule of the neural mesh renderer, written a second time: the cube at index (w · (n - 1)) along each axis, weighted by how near it is.
fn of_cube(cube: &[f64], side: usize, weights: [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (index, texel) in cube.chunks(3).enumerate() {
        let place = [index / (side * side), index / side % side, index % side];
        let share: f64 = (0..3)
            .map(|k| (1.0 - (weights[k] * (side as f64 - 1.0) - place[k] as f64).abs()).max(0.0))
            .product();
        (0..3).for_each(|c| sum[c] += share * texel[c]);
    }
    sum
}

#[test]
fn texels_of_triangles_are_interpolated_as_their_renderer_does() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = load(folder.path(), "a.obj", format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
    let path = folder.path().join("t.npy");
    let mut random = Pcg32::seed_from_u64(3);
    for side in [1_usize, 2, 3, 6] {
        let levels: Vec<u8> = (0..2 * side * side * side * 3).map(|_| random.random()).collect();
        let values: Vec<f64> = levels.iter().map(|v| f64::from(*v) / 255.0).collect();
        let long = format!("(1, 2, {side}, {side}, {side}, 3)");
        let short = format!("(2, {side}, {side}, {side}, 3)");
        let single: Vec<u8> = values.iter().flat_map(|v| (*v as f32).to_le_bytes()).collect();
        let double: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
        for (kind, shape, data) in [
            ("<f4", &long, &single),
            (">f8", &short, &double),
            ("|u1", &long, &levels),
        ] {
            std::fs::write(&path, npy(kind, "False", shape, data)).unwrap();
            let texture = Texture::Faces(FaceTexels::load(&path, &mesh).unwrap().0);
            for _ in 0..200 {
                let [a, b] = [random.random::<f64>(), random.random::<f64>()];
                let weights = [1.0 - a.sqrt(), a.sqrt() * (1.0 - b), a.sqrt() * b];
                let triangle = random.random_range(0..2);
                let cube = &values[triangle * side.pow(3) * 3..][..side.pow(3) * 3];
                let expected = of_cube(cube, side, weights);
                let found = texture.colour(&mesh, &SurfacePoint { triangle, weights });
                let off = (0..3).map(|c| (f64::from(found[c]) - 255.0 * expected[c]).abs());
                assert!(off.fold(0.0, f64::max) < 0.51, "{side} {kind} {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn an_array_of_another_mesh_or_kind_is_refused_with_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = load(folder.path(), "a.obj", format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
    let path = folder.path().join("t.npy");
    let shape = "(2, 1, 1, 1, 3)";
    let whole: Vec<u8> = [0.5_f32; 6].iter().flat_map(|v| v.to_le_bytes()).collect();
    let with = |value: f32| [&whole[..20], &value.to_le_bytes()].concat();
    let mut huge = npy("<f4", "False", shape, &whole);
    huge[6] = 2;
    huge.splice(8..10, u32::MAX.to_le_bytes());
    let nested = format!("{}{}", "(".repeat(900), ")".repeat(900));
    let deep = format!("{}1{}", "(".repeat(420), ",)".repeat(420).replace(",)", ")"));
    let cases: [(Vec<u8>, &str); 16] = [
        (npy("<f4", "False", &deep, &whole), "its header is damaged"),
        (
            npy("<f4", "False", "(3, 1, 1, 1, 3)", &whole),
            "it is for a mesh of 3 triangles and this one has 2",
        ),
        (
            npy("<f4", "False", "(1, 4, 1, 1, 1, 3)", &whole),
            "it is for a mesh of 4 triangles",
        ),
        (npy("<f4", "True", shape, &whole), "Fortran"),
        (npy("|O", "False", shape, &whole), "its numbers are '|O'"),
        (npy("<i8", "False", shape, &[0; 48]), "its numbers are '<i8'"),
        (npy("<f4", "False", shape, &whole[..23]), "ends too early"),
        (npy("<f4", "False", shape, b""), "ends too early"),
        (huge, "its header has 4294967295 bytes"),
        (npy("<f4", "False", &nested, &whole), "its header has"),
        (
            npy("<f4", "False", "(2, 1, 1, 2, 3)", &whole),
            "its shape is [2, 1, 1, 2, 3]",
        ),
        (npy("<f4", "False", "(2, 99, 99, 99, 3)", &whole), "its shape is"),
        (npy("<f4", "False", shape, &with(f32::NAN)), "the value NaN"),
        (npy("<f4", "False", shape, &with(255.0)), "the value 255"),
        (b"\x93NUMPY".to_vec(), "it is no .npy file"),
        (b"\x93NUMPY\x01\x00\x04\x00none".to_vec(), "its header is damaged"),
    ];
    for (bytes, words) in cases {
        std::fs::write(&path, bytes).unwrap();
        let error = FaceTexels::load(&path, &mesh).unwrap_err().to_string();
        assert!(error.contains(words) && error.lines().count() == 1, "{words}: {error}");
    }
    std::fs::write(&path, npy("<f4", "False", shape, &whole)).unwrap();
    assert!(FaceTexels::load(&path, &mesh).is_ok(), "and the whole one is read");
}

/// The colours of a box, face by face, against the six patterns by its normals; then the file with its card, as commands take it.
#[test]
fn a_pattern_for_each_side_is_a_texture_of_the_model() {
    let own = |side: usize, column: u32, row: u32| [40 * side as u8, 90 * column as u8, 60 * row as u8];
    let below_each_other = RgbImage::from_fn(2, 12, |x, y| Rgb(own((y / 2) as usize, x, y % 2)));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sides.png");
    std::fs::write(&path, png(below_each_other)).unwrap();
    let pattern = Pattern::load(&path).unwrap();
    let mesh = Mesh::cuboid([200.0, 120.0, 80.0]);
    let patterns = SidePatterns::new(&pattern, 60.0, &mesh).unwrap().unwrap();
    let texture = Texture::Sides(patterns);
    let mut seen = std::collections::BTreeSet::new();
    for triangle in 0..12 {
        let [a, b, c] = mesh.corners_mm(&mesh.triangles()[triangle]);
        let normal = (b - a).cross(&(c - a)).normalize();
        let side = Side::ALL
            .iter()
            .position(|side| side.outward().dot(&normal) > 0.99)
            .unwrap();
        for weights in [[0.5, 0.3, 0.2], [0.1, 0.8, 0.1], [0.2, 0.25, 0.55]] {
            let point = SurfacePoint { triangle, weights };
            let [u, v] = Side::ALL[side].project(&point.place_mm(&mesh));
            let cell = |mm: f64| (mm / 30.0).floor().rem_euclid(2.0) as u32;
            let expected = own(side, cell(u), cell(-v));
            assert_eq!(texture.colour(&mesh, &point), expected, "{side} {u} {v}");
            let corners = texture.in_cells(&mesh, triangle).unwrap();
            let place = [0, 1].map(|axis| (0..3).map(|k| weights[k] * corners[k][axis]).sum::<f64>());
            let found = texture.cell(triangle, [place[0].floor() as i64, place[1].floor() as i64]);
            seen.insert(found[0]);
        }
    }
    assert_eq!(seen.len(), 6, "each side has its own: {seen:?}");
    let nine = Pattern::random(9, 1).unwrap();
    assert!(
        SidePatterns::new(&nine, 60.0, &mesh).unwrap().is_none(),
        "9 rows are not those of six sides"
    );

    let scene = home().join("captures/skyline/scene.toml");
    let command = |option: &str, out: &str| {
        let out = folder.path().join(out);
        let mut command = program();
        command
            .args(["texture", "bake", "--scene"])
            .arg(&scene)
            .args(["--size", "256", option])
            .arg(&path);
        let output = command.arg("-o").arg(&out).output().unwrap();
        (output, out)
    };
    let card = Card {
        pattern_sha256: pattern.sha256().to_owned(),
        tile_mm: 60.0,
        sides: true,
        about: serde_json::Map::new(),
    };
    std::fs::write(path.with_extension("json"), card.to_file(&path).unwrap().1).unwrap();
    let (baked, image) = command("--texture", "baked.png");
    assert!(baked.status.success(), "{}", stderr(&baked));
    let reds: std::collections::BTreeSet<u8> = image::open(image)
        .unwrap()
        .into_rgb8()
        .pixels()
        .map(|p| p.0[0])
        .collect();
    assert!((0..6).all(|side| reds.contains(&(40 * side))), "{reds:?}");
    assert_refused(
        &command("--pattern", "no.png").0,
        &["a pattern for each side", "--texture"],
    );
    // No image on texture coordinates either, whatever happened to it since.
    let other = RgbImage::from_pixel(2, 12, Rgb([1, 2, 3]));
    std::fs::write(&path, png(other)).unwrap();
    assert_refused(&command("--texture", "no.png").0, &["the card of another pattern"]);
    std::fs::write(&path, png(RgbImage::new(600, 3600))).unwrap();
    assert_refused(&command("--texture", "no.png").0, &["600×3600 pixels", "512"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Any numbers as coordinates, any libraries and arrays: a colour or a sentence.
    #[test]
    fn any_coordinates_and_libraries_give_colours_or_a_sentence(
        coordinates in prop::collection::vec("(nan|inf|-inf|-?[0-9]{1,3}(\\.[0-9]{1,8})?|-?[0-9]e-?[0-9]{1,3}|x)", 6),
        map in "[-a-z0-9 ./\\\\:]{0,30}",
        indices in prop::collection::vec(-5_i32..6, 3),
    ) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("p.png"), png(picture())).unwrap();
        std::fs::write(folder.path().join("a.mtl"), format!("newmtl a\nmap_Kd {map}\nnewmtl b\nmap_Kd p.png\n")).unwrap();
        let vt: String = coordinates.chunks(2).map(|c| format!("vt {} {}\n", c[0], c[1])).collect();
        let [a, b, c] = [indices[0], indices[1], indices[2]];
        let text = format!("mtllib a.mtl\n{SQUARE}{vt}usemtl b\nf 1/{a} 2/{b} 3/{c}\nusemtl a\nf 1/{c} 3/{b} 4/{a}\n");
        let mesh = load(folder.path(), "a.obj", text);
        for paint in [&[0][..], &[1], &[]] {
            match MappedImages::from_mesh(&mesh, paint) {
                Ok(mapped) => {
                    let texture = Texture::Images(mapped.images);
                    for (x, y) in [(0.0, 0.0), (1.0, 1.0), (0.3, 0.8), (0.9, 0.1)] {
                        let _ = at(&texture, &mesh, x, y);
                    }
                }
                Err(error) => prop_assert!(error.to_string().lines().count() == 1, "{error}"),
            }
        }
    }

    #[test]
    fn damaged_arrays_never_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..5), cut in 0..300_usize) {
        let folder = tempfile::tempdir().unwrap();
        let mesh = load(folder.path(), "a.obj", format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
        let mut bytes = npy("|u1", "False", "(1, 2, 2, 2, 2, 3)", &[9; 48]);
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        bytes.truncate(bytes.len().saturating_sub(cut.saturating_sub(200)));
        let path = folder.path().join("t.npy");
        std::fs::write(&path, bytes).unwrap();
        if let Err(error) = FaceTexels::load(&path, &mesh) {
            prop_assert!(error.to_string().lines().count() == 1, "{error}");
        }
    }
}
