//! Meshes and textures as a user gives them, and broken ones: one sentence each.

use clap::Parser;
use image::{DynamicImage, Rgb, RgbImage};

use super::*;
use crate::cli::advice;
use crate::cli::args::model::ModelArgs;
use scaleproof_surface::texture::SurfacePoint;

#[derive(clap::Parser)]
struct Both {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    texture: TextureArgs,
}

/// A folder with meshes and textures of many kinds.
struct Files(tempfile::TempDir);

const SQUARE: &str = "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\n";
const FACES: &str = "usemtl body\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

impl Files {
    fn new() -> Self {
        let files = Self(tempfile::tempdir().unwrap());
        files.write("t.png", png(RgbImage::from_pixel(4, 4, Rgb([10, 20, 30]))));
        files.write("body.mtl", "newmtl body\nmap_Kd t.png\n");
        files.obj("m.obj", "body.mtl", "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
        files
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.0.path().join(name), bytes).unwrap();
    }

    fn obj(&self, name: &str, library: &str, coordinates: &str) {
        self.write(name, format!("mtllib {library}\n{SQUARE}{coordinates}{FACES}"));
    }

    /// What the command line loads, or what it says.
    fn load(&self, words: &str) -> Result<(Model, NamedTexture), String> {
        let folder = self.0.path().display().to_string();
        let words = words.replace('@', &format!("{folder}/"));
        let args = Both::try_parse_from(std::iter::once("x").chain(words.split(' '))).map_err(|e| e.to_string())?;
        let all = || -> Result<_> {
            let model = args.model.load_or(args.texture.mesh())?;
            let texture = args.texture.load(&model)?;
            Ok((model, texture))
        };
        all().map_err(|e| advice::sentence(e.as_ref()).replace(&folder, ""))
    }

    fn refused(&self, words: &str, sentence: &str) {
        match self.load(words) {
            Ok(_) => panic!("{words} is taken"),
            Err(said) => assert!(said.contains(sentence) && said.lines().count() == 1, "{words}: {said}"),
        }
    }
}

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    image.into().write_to(&mut file, image::ImageFormat::Png).unwrap();
    file.into_inner()
}

#[test]
fn a_textured_mesh_is_also_the_mesh_and_may_dress_another_one_of_the_same_shape() {
    let files = Files::new();
    let middle = |triangle| SurfacePoint {
        triangle,
        weights: [1.0 / 3.0; 3],
    };
    let (model, own) = files.load("--texture @m.obj --length-mm 50").unwrap();
    assert_eq!((model.mesh.size_mm(), own.name.as_str()), ([50.0, 50.0, 0.0], "m.obj"));
    assert_eq!(own.texture.colour(&model.mesh, &middle(1)), [10, 20, 30]);
    // The same square in metres and turned, without coordinates, of which one triangle is paint.
    files.write(
        "plain.obj",
        "v 5 0 0\nv 5 0.1 0\nv 5 0.1 0.1\nv 5 0 0.1\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n",
    );
    let words = "--mesh @plain.obj --mesh-front +y --length-mm 50 --material b --texture @m.obj";
    let (model, worn) = files.load(words).unwrap();
    assert_eq!(worn.texture.colour(&model.mesh, &middle(1)), [10, 20, 30]);
    files.write(
        "other.obj",
        "v 0 0 0\nv 100 0 0\nv 90 100 0\nv 0 100 0\nf 1 2 3\nf 1 3 4\n",
    );
    files.refused(
        "--mesh @other.obj --texture @m.obj",
        "triangle 0 of the textured mesh has another shape",
    );
    files.write("one.obj", format!("{SQUARE}f 1 2 3\n"));
    files.refused("--mesh @one.obj --texture @m.obj", "has 2 triangles and the mesh 1");
    let image = files.load("--mesh @m.obj --texture @t.png").unwrap().1;
    assert_eq!(
        image.sha256,
        files::sha256_hex(&files::read(&files.0.path().join("t.png")).unwrap())
    );
}

#[test]
fn one_of_pattern_and_texture_is_given_and_options_of_a_mesh_need_one() {
    let files = Files::new();
    assert!(files.load("--mesh @m.obj").err().unwrap().contains("--pattern"));
    let both = files
        .load("--mesh @m.obj --pattern @t.png --texture @t.png")
        .err()
        .unwrap();
    assert!(both.contains("cannot be used with"), "{both}");
    let (model, tile) = files.load("--mesh @m.obj --pattern @t.png --tile-mm 20").unwrap();
    assert_eq!(tile.texture.texel_mm(&model.mesh, 0), Some(5.0));
    files.refused("--texture @t.png", "give --mesh");
    // The card of a repeated pattern: on texture coordinates it would be stretched.
    let sha256 = files::sha256_hex(&std::fs::read(files.0.path().join("t.png")).unwrap());
    files.write("t.json", format!("{{\"pattern_sha256\":\"{sha256}\",\"tile_mm\":60}}"));
    files.refused(
        "--mesh @m.obj --texture @t.png",
        "/t.png is a pattern to be repeated every 60 mm",
    );
    std::fs::remove_file(files.0.path().join("t.json")).unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("captures/skyline/scene.toml");
    let words = format!("--scene {} --length-mm 400 --texture @t.png", scene.display());
    files.refused(&words, "--length-mm is about a mesh; give --mesh too");
}

#[test]
fn broken_images_and_coordinates_end_with_one_sentence() {
    let files = Files::new();
    let image = "--mesh @m.obj --texture @";
    files.refused(&format!("{image}none.png"), "cannot read /none.png");
    files.write("text.png", "no image");
    files.refused(
        &format!("{image}text.png"),
        "/text.png cannot be used (it is neither PNG nor JPEG)",
    );
    let whole = png(RgbImage::from_fn(64, 64, |x, y| Rgb([x as u8, y as u8, (x * y) as u8])));
    files.write("cut.png", &whole[..whole.len() - 50]);
    files.refused(&format!("{image}cut.png"), "/cut.png cannot be used (it is damaged");
    // A header alone that claims 20,000 × 20,000 pixels.
    files.write("huge.png", claiming(&whole, 20_000));
    files.refused(&format!("{image}huge.png"), "400 megapixels");
    files.write("wide.png", png(RgbImage::new(20_000, 20)));
    files.refused(&format!("{image}wide.png"), "20000×20 pixels, more than 16384");
    files.write("deep.png", png(DynamicImage::new_rgb16(4, 4)));
    files.refused(&format!("{image}deep.png"), "16 bits a channel");
    files.write("ink.jpg", cmyk());
    files.refused(&format!("{image}ink.jpg"), "printing inks, CMYK");

    let own = "--texture @n.obj";
    for (library, sentence) in [
        ("map_Kd none.png", "'body' cannot be painted: cannot read /none.png"),
        ("map_Kd ../t.png", "'../t.png' is not named within the mesh's folder"),
        ("map_Kd a/../../t.png", "is not named within the mesh's folder"),
        (
            "map_Kd /etc/hosts",
            "'/etc/hosts' is not named within the mesh's folder",
        ),
        ("map_Kd C:\\t.png", "'C:/t.png' is not named within the mesh's folder"),
        ("map_Kd text.png", "/text.png: it is neither PNG nor JPEG"),
        ("map_Kd", "is not named within the mesh's folder"),
        ("Kd 1 0 0", "the file names no image for it"),
    ] {
        files.write("n.mtl", format!("newmtl body\n{library}\n"));
        files.obj("n.obj", "n.mtl", "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
        files.refused(own, sentence);
    }
    files.obj("n.obj", "gone.mtl", "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
    files.refused(own, "its material library 'gone.mtl' is not a file beside the mesh");
    files.obj("n.obj", "../gone.mtl", "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
    files.refused(own, "its material library '../gone.mtl' is not a file beside the mesh");

    for (coordinates, sentence) in [
        (
            "vt 0 0\nvt 1 0\nvt 1 1\nvt nan 1\n",
            "a texture coordinate of the mesh is NaN",
        ),
        (
            "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1e7\n",
            "a texture coordinate of the mesh is 10000000",
        ),
        (
            "vt 0 0\nvt 1 0\nvt 1 1\n",
            "1 triangle of the paint's 2 have no texture coordinates",
        ),
        ("", "the mesh has no texture coordinates"),
    ] {
        files.obj("n.obj", "body.mtl", coordinates);
        files.refused(own, sentence);
        files.refused("--mesh @n.obj --texture @t.png", sentence);
    }
    files.obj("n.obj", "body.mtl", "vt -700 0\nvt 1 0\nvt 1 900\nvt 0 1\n");
    assert!(files.load(own).is_ok(), "an image may be repeated");
}

#[test]
fn lists_of_faces_are_read_and_broken_ones_end_with_one_sentence() {
    let files = Files::new();
    files.write("f.txt", "\n  1\r\n\n1\t 1\n");
    let (model, _) = files.load("--mesh @m.obj --faces @f.txt --texture @t.png").unwrap();
    let painted = model
        .mesh
        .triangles()
        .iter()
        .map(|t| model.materials.contains(&t.material));
    assert_eq!(painted.collect::<Vec<_>>(), [false, true]);
    for (text, sentence) in [
        ("", "/f.txt cannot be used (it is empty)"),
        ("\n \n", "(it is empty)"),
        ("0\n2\n", "(line 2 has triangle 2, and the mesh has 2 of them)"),
        ("0\n\nroof\n", "(line 3 has 'roof', which is no whole number)"),
        ("0 1.5", "(line 1 has '1.5', which is no whole number)"),
        ("-1", "(line 1 has '-1', which is no whole number)"),
        ("99999999999999999999999", "which is no whole number"),
    ] {
        files.write("f.txt", text);
        files.refused("--mesh @m.obj --faces @f.txt --texture @t.png", sentence);
    }
    files.refused(
        "--mesh @m.obj --faces @none.txt --texture @t.png",
        "cannot read /none.txt",
    );
    let both = files
        .load("--mesh @m.obj --faces @f.txt --material body --texture @t.png")
        .err()
        .unwrap();
    assert!(both.contains("cannot be used with"), "{both}");
}

/// A PNG whose header gives another width and height.
fn claiming(png: &[u8], side: u32) -> Vec<u8> {
    let mut bytes = png.to_vec();
    bytes[16..20].copy_from_slice(&side.to_be_bytes());
    bytes[20..24].copy_from_slice(&side.to_be_bytes());
    let mut crc = !0_u32;
    for byte in &bytes[12..29] {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bytes
}

/// A JPEG of one block in four inks: a frame of four components with the tables of a grey one.
fn cmyk() -> Vec<u8> {
    let mut grey = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new(&mut grey);
    let image = image::GrayImage::from_pixel(8, 8, image::Luma([128]));
    let mut encoder = encoder;
    encoder.encode_image(&image).unwrap();
    let find = |marker: u8| grey.windows(2).position(|w| w == [0xff, marker]).unwrap();
    let (frame, tables, scan) = (find(0xc0), find(0xc4), find(0xda));
    let mut bytes = grey[..frame].to_vec();
    let component = |id: u8| [id, 0x11, 0];
    bytes.extend([0xff, 0xc0, 0, 20, 8, 0, 8, 0, 8, 4]);
    bytes.extend([1, 2, 3, 4].map(component).concat());
    bytes.extend(&grey[tables.min(scan)..scan]);
    bytes.extend([0xff, 0xda, 0, 14, 4, 1, 0, 2, 0, 3, 0, 4, 0, 0, 63, 0]);
    // The four blocks are the grey one's bits, whose padding ends them all the same.
    bytes.extend([&grey[scan + 10..grey.len() - 2], &[0; 8]].concat());
    bytes.extend([0xff, 0xd9]);
    bytes
}
