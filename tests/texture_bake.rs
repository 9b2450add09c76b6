//! Textures on their way out: the image and the mesh that `texture bake` writes, read back by a parser of this test and held against the pattern's
//! own formula; previews; the published camouflage drawn as its authors drew it.

use crate::common::{assert_refused, program, shared, stderr, stdout};

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::process::Output;

use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_frames::Pinhole;
use scaleproof_frames::raster::{Hit, Raster};
use scaleproof_pose::scene::Viewpoint;
use scaleproof_pose::simulate::looking_at;
use scaleproof_surface::mesh::{FaceList, Mesh, MeshPlacement};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::colour::Lab;
use scaleproof_surface::pattern::world_aligned::{Side, WorldAligned};
use scaleproof_surface::texture::{MappedImages, SurfacePoint, Texture};

/// Triangles of a written .obj: places, texture coordinates and the material of each face.
struct Written {
    places: Vec<Point3<f64>>,
    coordinates: Vec<[f64; 2]>,
    faces: Vec<(String, Vec<[usize; 2]>)>,
    image: RgbImage,
}

impl Written {
    fn open(png: &Path) -> Self {
        let mut written = Written {
            places: Vec::new(),
            coordinates: Vec::new(),
            faces: Vec::new(),
            image: image::open(png).unwrap().to_rgb8(),
        };
        let mut material = String::new();
        for line in std::fs::read_to_string(png.with_extension("obj")).unwrap().lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let number = |i: usize| words[i].parse::<f64>().unwrap();
            match words[0] {
                "v" => written.places.push(Point3::new(number(1), number(2), number(3))),
                "vt" => written.coordinates.push([number(1), number(2)]),
                "usemtl" => material = words[1].to_owned(),
                "f" => {
                    let corner = |word: &&str| {
                        let mut parts = word.split('/').map(|n| n.parse::<usize>().unwrap() - 1);
                        [parts.next().unwrap(), parts.next().unwrap_or(usize::MAX)]
                    };
                    written
                        .faces
                        .push((material.clone(), words[1..].iter().map(corner).collect()));
                }
                _ => {}
            }
        }
        written
    }

    /// The pixel that a renderer without filter shows at texture coordinates.
    fn pixel(&self, [u, v]: [f64; 2]) -> [u8; 3] {
        let (width, height) = self.image.dimensions();
        let index = |share: f64, count: u32| ((share * f64::from(count)) as u32).min(count - 1);
        self.image.get_pixel(index(u, width), index(1.0 - v, height)).0
    }
}

/// What random points said.
#[derive(Debug, Default)]
struct Compared {
    right: usize,
    wrong: usize,
    near_a_border: usize,
}

/// 10,000 random points of the paint, by area: the pattern's colour there, by its formula, against the image at the written coordinates. Points within a
/// texel of a cell's border, or of an edge at which the surface turns to another side, are not compared. `to_model`: from the file into the model frame.
fn compare(
    written: &Written,
    paint: &str,
    to_model: impl Fn(&Point3<f64>) -> Point3<f64>,
    pattern: &Pattern,
    tile_mm: f64,
) -> Compared {
    let mapped = WorldAligned {
        pattern,
        cell_mm: tile_mm / f64::from(pattern.columns()),
    };
    let (width, height) = written.image.dimensions();
    let size = [f64::from(width), f64::from(height)];
    let in_texels = |uv: [f64; 2]| [0, 1].map(|axis| uv[axis] * size[axis]);
    let sides = sides_at_edges(written, paint, &to_model);
    let mut turns = Turns::default();
    let mut sum = 0.0;
    let mut faces = Vec::new();
    for (_, corners) in written.faces.iter().filter(|(material, _)| material == paint) {
        let places: [Point3<f64>; 3] = std::array::from_fn(|i| to_model(&written.places[corners[i][0]]));
        let uv: [[f64; 2]; 3] = std::array::from_fn(|i| written.coordinates[corners[i][1]]);
        let normal = (places[1] - places[0]).cross(&(places[2] - places[0]));
        sum += normal.norm();
        let texel_mm = (0..3).map(|i| {
            let (p, q, next) = (uv[i], uv[(i + 1) % 3], places[(i + 1) % 3]);
            let texels = [0, 1].map(|axis| (q[axis] - p[axis]) * size[axis]);
            (next - places[i]).norm() / texels[0].hypot(texels[1])
        });
        for i in (0..3).filter(|i| sides[&edge(corners, *i)].len() > 1) {
            turns.add([uv[i], uv[(i + 1) % 3]].map(in_texels));
        }
        faces.push((sum, places, uv, normal, texel_mm.fold(0.0, f64::max)));
    }
    let mut rng = Pcg32::seed_from_u64(7);
    let mut compared = Compared::default();
    while compared.right + compared.wrong < 10_000 {
        let at = sum * rng.random::<f64>();
        let (_, places, corners, normal, texel_mm) =
            &faces[faces.partition_point(|face| face.0 < at).min(faces.len() - 1)];
        let (a, b): (f64, f64) = (rng.random(), rng.random());
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        let weights = [1.0 - a - b, a, b];
        let place = Point3::from((0..3).fold(Vector3::zeros(), |sum, i| sum + weights[i] * places[i].coords));
        let uv = [0, 1].map(|axis| (0..3).map(|i| weights[i] * corners[i][axis]).sum::<f64>());
        let to_border = Side::facing(normal)
            .project(&place)
            .map(|mm| (mm - mapped.cell_mm * (mm / mapped.cell_mm).round()).abs());
        if turns.are_near(in_texels(uv)) || to_border.iter().any(|mm| *mm < REACH * texel_mm) {
            compared.near_a_border += 1;
        } else if written.pixel(uv) == mapped.colour(&place, normal) {
            compared.right += 1;
        } else {
            compared.wrong += 1;
        }
    }
    compared
}

/// The texture coordinates of an edge's ends.
fn edge(corners: &[[usize; 2]], i: usize) -> [usize; 2] {
    let (p, q) = (corners[i][1], corners[(i + 1) % 3][1]);
    [p.min(q), p.max(q)]
}

/// The sides of the faces at each edge in the image.
fn sides_at_edges(
    written: &Written,
    paint: &str,
    to_model: impl Fn(&Point3<f64>) -> Point3<f64>,
) -> HashMap<[usize; 2], BTreeSet<Side>> {
    let mut sides: HashMap<[usize; 2], BTreeSet<Side>> = HashMap::new();
    for (_, corners) in written.faces.iter().filter(|(material, _)| material == paint) {
        let [a, b, c] = std::array::from_fn(|i| to_model(&written.places[corners[i][0]]));
        let side = Side::facing(&(b - a).cross(&(c - a)));
        (0..3).for_each(|i| _ = sides.entry(edge(corners, i)).or_default().insert(side));
    }
    sides
}

/// Edges at which the surface turns to another side, in texels: thin triangles turn within a texel, so those of others count, too.
#[derive(Default)]
struct Turns(HashMap<[i64; 2], Vec<[[f64; 2]; 2]>>);

impl Turns {
    /// Texels along a bucket.
    const BUCKET: f64 = 16.0;

    fn add(&mut self, ends: [[f64; 2]; 2]) {
        let span = |axis: usize| {
            let [a, b] = ends.map(|end| end[axis]);
            let bucket = |at: f64| (at / Self::BUCKET).floor() as i64;
            bucket(a.min(b) - REACH)..=bucket(a.max(b) + REACH)
        };
        for row in span(1) {
            for column in span(0) {
                self.0.entry([column, row]).or_default().push(ends);
            }
        }
    }

    fn are_near(&self, at: [f64; 2]) -> bool {
        let bucket = at.map(|texels| (texels / Self::BUCKET).floor() as i64);
        let near = |[a, b]: &[[f64; 2]; 2]| {
            let along = [b[0] - a[0], b[1] - a[1]];
            let to = [at[0] - a[0], at[1] - a[1]];
            let squared = along[0].powi(2) + along[1].powi(2);
            let share = ((along[0] * to[0] + along[1] * to[1]) / squared.max(1e-12)).clamp(0.0, 1.0);
            (to[0] - share * along[0]).hypot(to[1] - share * along[1]) < REACH
        };
        self.0.get(&bucket).is_some_and(|edges| edges.iter().any(near))
    }
}

/// The box around all that is used.
fn bounds(written: &Written) -> (Point3<f64>, Point3<f64>) {
    let used = written
        .faces
        .iter()
        .flat_map(|(_, corners)| corners)
        .map(|c| written.places[c[0]]);
    let start = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
    used.fold(start, |(low, high), p| (low.inf(&p), high.sup(&p)))
}

fn assert_read_back(what: &str, compared: &Compared) {
    println!("{what}: {compared:?}");
    let all = compared.right + compared.wrong;
    assert!(
        compared.near_a_border < 2 * all,
        "too few points are left: {compared:?}"
    );
    assert!(compared.right as f64 >= 0.999 * all as f64, "{compared:?}");
}

/// A folder with a pattern and meshes.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        bench.write("P.png", Pattern::random(4, 3).unwrap().to_png().unwrap());
        bench
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.at(name), content).unwrap();
    }

    fn image(&self, name: &str, image: &RgbImage) {
        image.save(self.at(name)).unwrap();
    }

    /// `texture …` in the folder.
    fn run(&self, arguments: &str) -> Output {
        let mut command = program();
        // What is said of long work is no result.
        command.current_dir(self.0.path()).args(["--quiet", "texture"]);
        command.args(arguments.split_whitespace()).output().unwrap()
    }

    fn bake(&self, arguments: &str) -> Written {
        let output = self.run(&format!("bake {arguments} -o out.png"));
        assert!(output.status.success(), "{}", stderr(&output));
        Written::open(&self.at("out.png"))
    }
}

/// A square of 100 mm on the ground that looks up, with these texture coordinates of its two triangles.
fn square(coordinates: &[[f64; 2]; 6]) -> String {
    let mut text = "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\n".to_owned();
    for [u, v] in coordinates {
        text += &format!("vt {u} {v}\n");
    }
    text + "usemtl Paint\nf 1/1 2/2 3/3\nf 1/4 3/5 4/6\n"
}

/// A texel reaches so far from any point of it.
const REACH: f64 = std::f64::consts::SQRT_2;

const WHOLE: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

#[test]
fn coordinates_that_can_hold_an_image_are_kept() {
    let bench = Bench::new();
    bench.write("square.obj", square(&WHOLE));
    let written = bench.bake("--mesh square.obj --pattern P.png --tile-mm 100 --size 64");
    for (_, corners) in &written.faces {
        for [place, coordinates] in corners {
            let place = written.places[*place];
            assert_eq!(written.coordinates[*coordinates], [place.x / 100.0, place.y / 100.0]);
        }
    }
    // Cells are 16 × 16 texels: every texel is known.
    let pattern = Pattern::random(4, 3).unwrap();
    let mapped = WorldAligned {
        pattern: &pattern,
        cell_mm: 25.0,
    };
    for (x, y, pixel) in written.image.enumerate_pixels() {
        let place = Point3::new((f64::from(x) + 0.5) / 0.64, (63.5 - f64::from(y)) / 0.64, 0.0);
        assert_eq!(pixel.0, mapped.colour(&place, &Vector3::z()), "{x}, {y}");
    }
}

#[test]
fn coordinates_that_cannot_are_replaced() {
    let shifted = WHOLE.map(|[u, v]| [u + 0.5, v]);
    let mut folded = WHOLE;
    // The second triangle on the first.
    folded[5] = [1.0, 0.0];
    let cases = [
        (square(&shifted), "leave the image"),
        (square(&folded), "overlap"),
        (square(&[[0.25; 2]; 6]), "no room"),
        (
            square(&WHOLE).replace("f 1/4 3/5 4/6", "f 1 3 4"),
            "has no texture coordinates for all",
        ),
    ];
    let bench = Bench::new();
    let to_model = |p: &Point3<f64>| *p;
    for (mesh, why) in cases {
        bench.write("square.obj", mesh);
        let output = bench.run("bake --mesh square.obj --pattern P.png --tile-mm 100 --size 128 -o out.png");
        assert!(stdout(&output).contains(why), "{} {}", stdout(&output), stderr(&output));
        let compared = compare(
            &Written::open(&bench.at("out.png")),
            "Paint",
            to_model,
            &Pattern::random(4, 3).unwrap(),
            100.0,
        );
        assert_read_back(why, &compared);
    }
    bench.write("square.obj", square(&WHOLE));
    let output =
        bench.run("bake --mesh square.obj --pattern P.png --tile-mm 100 --size 128 -o out.png --unwrap --json");
    let answer: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(answer["unwrapped"], "as asked");
    assert_eq!(answer["files"].as_array().unwrap().len(), 4);
}

/// Black and white columns of half a texel: half of the light, which is 188 in sRGB.
#[test]
fn a_texel_is_the_mean_of_the_light_of_its_place() {
    let bench = Bench::new();
    bench.write("square.obj", square(&WHOLE));
    bench.image(
        "lines.png",
        &RgbImage::from_fn(128, 128, |x, _| Rgb([255 * (x % 2) as u8; 3])),
    );
    let written = bench.bake("--mesh square.obj --texture lines.png --size 64");
    assert!(written.image.pixels().all(|pixel| pixel.0 == [188; 3]));
}

/// A box of 180 × 90 × 60 mm without texture coordinates.
fn box_obj() -> String {
    let mut text = String::new();
    for i in 0..8_usize {
        let end = |bit: usize| f64::from((i >> bit & 1) as u32);
        text += &format!(
            "v {} {} {}\n",
            180.0 * (end(0) - 0.5),
            90.0 * (end(1) - 0.5),
            60.0 * end(2)
        );
    }
    text + "usemtl a_body\nf 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nusemtl a_floor\nf 1 3 4 2\nusemtl a_body\nf 5 6 8 7\n"
}

#[test]
fn the_written_meshes_look_like_the_pattern() {
    let bench = Bench::new();
    bench.write("box.obj", box_obj());
    let shown = |arguments: &str| {
        let output = bench.run(&format!(
            "show --azimuth-deg 30 200 --size-px 240x160 {arguments} -o views"
        ));
        assert!(output.status.success(), "{}", stderr(&output));
        ["az30", "az200"].map(|name| image::open(bench.at(&format!("views/{name}.png"))).unwrap().to_rgb8())
    };
    let wanted = shown("--mesh box.obj --material a_body --pattern P.png --tile-mm 100");
    bench.bake("--mesh box.obj --material a_body --pattern P.png --tile-mm 100 --size 1024");
    for found in [
        shown("--texture out.obj --material a_body"),
        shown("--texture out.glb --material a_body --length-mm 180"),
    ] {
        for (wanted, found) in wanted.iter().zip(&found) {
            let off = wanted
                .as_raw()
                .iter()
                .zip(found.as_raw())
                .filter(|(a, b)| a.abs_diff(**b) > 24);
            let share = off.count() as f64 / wanted.as_raw().len() as f64;
            assert!(share < 0.01, "{share} of the values differ");
        }
    }
    let library = std::fs::read_to_string(bench.at("out.mtl")).unwrap();
    assert!(library.contains("newmtl a_body") && library.contains("newmtl a_floor"));
    assert_eq!(library.matches("map_Kd out.png").count(), 1);
}

#[test]
fn a_preview_shows_each_side_from_its_azimuth() {
    let bench = Bench::new();
    bench.write("box.obj", box_obj());
    bench.image("red.png", &RgbImage::from_pixel(8, 8, Rgb([255, 0, 0])));
    let patch = "--mesh box.obj --patch red.png --panel left --at-mm 0,30 --size-mm 60";
    let output = bench.run(&format!(
        "show {patch} --azimuth-deg 90 270 --pitch-deg 0 --size-px 100x80 -o views.png"
    ));
    assert!(output.status.success(), "{}", stderr(&output));
    let sheet = image::open(bench.at("views.png")).unwrap().to_rgb8();
    assert_eq!(sheet.dimensions(), (200, 80));
    let [left, right] = [50, 150].map(|x| sheet.get_pixel(x, 40).0);
    assert!(left[0] > 100 && left[1] == 0 && left[2] == 0, "{left:?}");
    assert!(
        right[0] == right[1] && right[1] == right[2] && right[0] > 100,
        "{right:?}"
    );
    assert_eq!(sheet.get_pixel(1, 1).0, [255; 3]);
    // 180 mm fill the width, and the model is not cut.
    let row: Vec<bool> = (0..100).map(|x| sheet.get_pixel(x, 40).0 != [255; 3]).collect();
    assert!(row.iter().filter(|is_model| **is_model).count() > 80 && !row[0] && !row[99]);
}

#[test]
fn what_cannot_be_baked_or_shown_is_refused() {
    let bench = Bench::new();
    bench.write("box.obj", box_obj());
    let refused = |arguments: &str, words: &[&str]| {
        assert_refused(&bench.run(&format!("{arguments} --mesh box.obj -o out.png")), words);
        assert!(!bench.at("out.png").exists() && !bench.at("out.obj").exists());
    };
    let pattern = "--pattern P.png --tile-mm 100";
    refused(&format!("bake {pattern} --size 32"), &["64 to 8192 px"]);
    refused(&format!("bake {pattern} --size 9000"), &["64 to 8192 px"]);
    refused(&format!("bake {pattern} --size big"), &["'big'"]);
    refused("bake --texture P.png", &["no texture coordinates"]);
    refused("bake", &["--pattern or --texture"]);
    refused(&format!("show {pattern} --pitch-deg 90"), &["a pitch of 90°"]);
    refused(&format!("show {pattern} --size-px 5000x10"), &["16 to 4096 px"]);
    refused(&format!("show {pattern} --azimuth-deg east"), &["'east'"]);
    bench.write("out.obj", box_obj());
    let over = bench.run(&format!("bake --mesh out.obj {pattern} -o out.png"));
    assert_refused(&over, &["out.obj is an input"]);
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn patterns_are_read_back_from_the_skyline() {
    let mesh = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let bench = Bench::new();
    let pattern = Pattern::random(16, 1).unwrap();
    bench.write("P.png", pattern.to_png().unwrap());
    let written = bench.bake(&format!(
        "--mesh {} --material Material.001 --length-mm 455 --pattern P.png --tile-mm 240",
        mesh.display()
    ));
    // glTF: y up, z to the front.
    let (low, high) = bounds(&written);
    let scale = 455.0 / (high.z - low.z);
    let to_model = |p: &Point3<f64>| {
        let middle = nalgebra::center(&low, &high);
        Point3::new(p.z - middle.z, p.x - middle.x, p.y - low.y) * scale
    };
    assert_read_back("skyline", &compare(&written, "Material.001", to_model, &pattern, 240.0));
}

/// Arguments of the published camouflage at 490 mm.
fn camouflage() -> (PathBuf, String) {
    let folder = shared("meshes/rauca_etron");
    let mesh = folder.join("model_save.obj");
    let faces = folder.join("exterior_face.txt");
    let arguments = format!("--mesh {} --faces {} --length-mm 490", mesh.display(), faces.display());
    (folder, arguments)
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn patterns_are_read_back_from_the_published_mesh() {
    let (_, mesh) = camouflage();
    let bench = Bench::new();
    let pattern = Pattern::random(16, 1).unwrap();
    bench.write("P.png", pattern.to_png().unwrap());
    for more in ["--size 2448x2432", "--size 2048 --unwrap"] {
        let written = bench.bake(&format!("{mesh} --pattern P.png --tile-mm 240 {more}"));
        let (low, high) = bounds(&written);
        let middle = nalgebra::center(&low, &high);
        let to_model = |p: &Point3<f64>| {
            let scale = 490.0 / (high.x - low.x);
            Point3::new(p.x - middle.x, p.y - middle.y, p.z - low.z) * scale
        };
        let paint = "material_1_(paint)";
        assert_read_back(more, &compare(&written, paint, to_model, &pattern, 240.0));
    }
}

/// Where the authors' camera stood and looked: found by hand, then fitted.
#[derive(Debug, Clone, Copy)]
struct View([f64; 6]);

impl View {
    /// Azimuth, pitch, distance in half lengths of the model, focal length and principal point in pixels.
    const START: Self = Self([315.0, 36.0, 3.2, 290.0, 319.5, 319.5]);
    const STEPS: [f64; 6] = [0.5, 0.5, 0.2, 3.0, 0.5, 0.5];
}

/// The mesh and what was drawn of it.
struct Drawn {
    mesh: Mesh,
    paint: Vec<usize>,
    texture: MappedImages,
    picture: RgbImage,
}

/// A block of pixels: the share that the model covers in our image, whether all of it is paint, and both colours.
struct Block {
    covered: f64,
    is_paint: bool,
    ours: [f64; 3],
    theirs: [f64; 3],
    theirs_covered: f64,
}

impl Drawn {
    /// The picture in blocks of so many pixels, without light, from points on a grid of half pixels.
    fn blocks(&self, view: &View, side: u32) -> Vec<Block> {
        let [azimuth_deg, pitch_deg, distance, focal_length_px, cx, cy] = view.0;
        let (low, high) = self.mesh.bounds_mm();
        let viewpoint = Viewpoint {
            azimuth_deg,
            pitch_deg,
            distance_mm: 0.5 * distance * (high.x - low.x),
        };
        let pose = looking_at(&viewpoint, nalgebra::center(&low, &high));
        let pinhole = Pinhole {
            focal_length_px: 2.0 * focal_length_px,
            centre_px: [2.0 * cx + 0.5, 2.0 * cy + 0.5],
        };
        let raster = Raster::image(&self.mesh, &pose, &pinhole, [1280, 1280]).unwrap();
        let block = |left: u32, top: u32| {
            let mut block = Block {
                covered: 0.0,
                is_paint: true,
                ours: [0.0; 3],
                theirs: [0.0; 3],
                theirs_covered: 0.0,
            };
            let share = 1.0 / f64::from(4 * side * side);
            for (x, y) in (0..2 * side).flat_map(|y| (0..2 * side).map(move |x| (2 * left + x, 2 * top + y))) {
                let theirs = self.picture.get_pixel(x / 2, y / 2).0;
                let is_model = theirs.iter().min() < Some(&250);
                block.theirs_covered += if is_model { share } else { 0.0 };
                let hit = raster.at(i64::from(x), i64::from(y));
                let ours = hit.map_or([255; 3], |hit| self.colour(&raster, [x, y], &hit));
                block.covered += if hit.is_some() { share } else { 0.0 };
                let material = hit.map(|hit| self.mesh.triangles()[hit.triangle].material);
                block.is_paint &= is_model && material.is_some_and(|material| self.paint.contains(&material));
                for c in 0..3 {
                    block.ours[c] += share * f64::from(ours[c]);
                    block.theirs[c] += share * f64::from(theirs[c]);
                }
            }
            block
        };
        // The car is well within.
        let steps = |from: u32, to: u32| (from..to).step_by(side as usize);
        steps(256, 400)
            .flat_map(|top| steps(240, 416).map(move |left| (left, top)))
            .map(|(left, top)| block(left, top))
            .collect()
    }

    fn colour(&self, raster: &Raster, [x, y]: [u32; 2], hit: &Hit) -> [u8; 3] {
        let corners = self.mesh.corners_mm(&self.mesh.triangles()[hit.triangle]);
        let p = raster.point(i64::from(x), i64::from(y), hit);
        let area = |a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>| (b - a).cross(&(c - a)).norm();
        let [a, b, c] = &corners;
        let parts = [area(&p, b, c), area(a, &p, c), area(a, b, &p)];
        let sum: f64 = parts.iter().sum();
        let weights = parts.map(|part| part / sum);
        Texture::Images(self.texture.clone()).colour(
            &self.mesh,
            &SurfacePoint {
                triangle: hit.triangle,
                weights,
            },
        )
    }

    fn intersection_over_union(&self, view: &View) -> f64 {
        let (mut both, mut any) = (0.0, 0.0);
        for block in self.blocks(view, 1) {
            let (ours, theirs) = (block.covered > 0.5, block.theirs_covered > 0.5);
            both += f64::from(u8::from(ours && theirs));
            any += f64::from(u8::from(ours || theirs));
        }
        both / any
    }

    /// How well outline and colours agree; the light takes from all channels alike.
    fn agreement(&self, view: &View) -> f64 {
        let blocks = self.blocks(view, 2);
        let off: f64 = blocks.iter().map(|b| (b.covered - b.theirs_covered).abs()).sum();
        let size: f64 = blocks.iter().map(|b| b.theirs_covered).sum();
        let paint: Vec<&Block> = blocks.iter().filter(|b| b.is_paint).collect();
        let hue = |of: fn(&Block) -> [f64; 3], channel: usize| -> Vec<f64> {
            let colours = paint.iter().map(|b| of(b));
            colours
                .map(|rgb| rgb[channel] - rgb.iter().sum::<f64>() / 3.0)
                .collect()
        };
        let channels = (0..3).map(|c| correlation(&hue(|b| b.ours, c), &hue(|b| b.theirs, c)));
        channels.sum::<f64>() - off / size
    }
}

/// Pearson's.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 { a.iter().zip(b).map(|(x, y)| f(x - mean_a, y - mean_b)).sum() };
    sum(&|x, y| x * y) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt()
}

/// Of each value among the others.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    order.iter().enumerate().for_each(|(rank, i)| ranks[*i] = rank as f64);
    ranks
}

/// C*ab.
fn chroma(rgb: [f64; 3]) -> f64 {
    let lab = Lab::from_rgb(rgb.map(|v| v.round() as u8));
    lab.a.hypot(lab.b)
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_published_camouflage_looks_as_its_authors_drew_it() {
    let folder = shared("meshes/rauca_etron");
    let placement = MeshPlacement {
        length_mm: Some(490.0),
        ..MeshPlacement::default()
    };
    let mesh = Mesh::load(&folder.join("model_save.obj"), &placement).unwrap();
    let faces = FaceList::load(&folder.join("exterior_face.txt"), &mesh).unwrap();
    let texture = MappedImages::from_mesh(&mesh, &[])
        .unwrap_or_else(|e| panic!("{e}"))
        .images;
    let (mesh, paint) = mesh.with_paint(&faces);
    let drawn = Drawn {
        mesh,
        paint,
        texture,
        picture: image::open(folder.join("textur_render.png")).unwrap().to_rgb8(),
    };
    let (mut view, mut steps) = (View::START, View::STEPS);
    let mut best = drawn.agreement(&view);
    for _ in 0..6 {
        let before = best;
        for (i, step) in steps.iter().enumerate() {
            for sign in [1.0, -1.0] {
                let mut other = view;
                other.0[i] += sign * step;
                if i == 2 {
                    // The size in the image stays.
                    other.0[3] *= other.0[2] / view.0[2];
                }
                let agreement = drawn.agreement(&other);
                if agreement > best {
                    (view, best) = (other, agreement);
                    break;
                }
            }
        }
        if best == before {
            steps = steps.map(|step| 0.5 * step);
        }
    }
    let overlap = drawn.intersection_over_union(&view);
    // Details of the texture are smaller than a pixel of the picture.
    let blocks = drawn.blocks(&view, 2);
    let paint = || blocks.iter().filter(|b| b.is_paint);
    let ours: Vec<f64> = paint().map(|b| chroma(b.ours)).collect();
    let theirs: Vec<f64> = paint().map(|b| chroma(b.theirs)).collect();
    let agreement = correlation(&ranks(&ours), &ranks(&theirs));
    println!(
        "{view:?}: IoU {overlap:.4}; rank correlation of chroma {agreement:.3} in {} blocks of the paint",
        ours.len()
    );
    assert!(
        overlap >= 0.95 && agreement >= 0.9 && ours.len() > 500,
        "{view:?}: {overlap} {agreement}"
    );
}
