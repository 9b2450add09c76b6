//! Prints the panels of models, renders them with poppler, and reads the colours where the model's surface is.

use crate::common;
use crate::print_template::render;

use std::path::{Path, PathBuf};

use common::{assert_refused, shared};
use image::{Rgb, RgbImage};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use render::{done, pages, scaleproof, text_of};
use scaleproof_print::media::Media;
use scaleproof_print::paper::Paper;
use scaleproof_print::wrap::{Face, PaintedSurface, Wrap, WrapRequest, wrap};
use scaleproof_surface::mesh::{Mesh, MeshPlacement};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::world_aligned::{Side, WorldAligned};
use scaleproof_surface::texture::{Texture, Tile};

const DPI: f64 = 400.0;
/// What the program takes when nothing is said.
pub fn request(paper: Paper) -> WrapRequest {
    WrapRequest {
        scale: 10.0,
        name: "p.png".into(),
        facts: String::new(),
        dpi: 300.0,
        overlap_mm: 8.0,
        media: Media::new(paper),
    }
}

fn tiled(pattern: &Pattern, tile_mm: f64) -> Texture {
    Texture::Tile(Tile::new(pattern.clone(), tile_mm))
}

/// A bar along x with slopes beside its roof, in the model frame: length, width, height, and how far a slope goes down and in.
const BAR: [f64; 5] = [200.0, 90.0, 60.0, 10.0, 20.0];

/// The bar as OBJ: everything is `paint` but the front, which is `glass`.
fn bar(folder: &Path) -> PathBuf {
    let [length, width, height, down, inwards] = BAR;
    let (y, z) = (width / 2.0, height - down);
    // Seen from the front (y to the right), counter-clockwise.
    let outline = [
        (-y, 0.0),
        (y, 0.0),
        (y, z),
        (y - inwards, height),
        (inwards - y, height),
        (-y, z),
    ];
    let mut text = String::new();
    for x in [-length / 2.0, length / 2.0] {
        for (y, z) in outline {
            text += &format!("v {x} {y} {z}\n");
        }
    }
    text += "usemtl paint\n";
    for i in 0..6 {
        let next = (i + 1) % 6;
        text += &format!("f {} {} {} {}\n", i + 1, next + 1, next + 7, i + 7);
    }
    text += "f 6 5 4 3 2 1\nusemtl glass\nf 7 8 9 10 11 12\n";
    let path = folder.join("bar.obj");
    std::fs::write(&path, text).unwrap();
    path
}

fn pattern_file(pattern: &Pattern, folder: &Path) -> PathBuf {
    let path = folder.join("p.png");
    std::fs::write(&path, pattern.to_png().unwrap()).unwrap();
    path
}

/// The rendered panels, and how to read a colour on them.
struct Printed {
    wrap: Wrap,
    pages: Vec<RgbImage>,
}

impl Printed {
    fn new(wrap: Wrap, pdf: &Path) -> Self {
        let pages = pages(pdf, 2, DPI);
        assert_eq!(pages.len() + 1, wrap.pages.len());
        Self { wrap, pages }
    }

    /// The colour on paper at (u, v) of a side, on the sheet that shows the place when all are glued.
    fn colour(&self, side: Side, [u, v]: [f64; 2]) -> [u8; 3] {
        let mut page = 0;
        for piece in &self.wrap.pieces {
            for plan in &piece.layout.sheets {
                let by = piece.moved_by_mm(plan);
                let (x, y) = (u + by[0], v + by[1]);
                let trim = plan.trim;
                let mine = x >= trim.left_mm && x < trim.right_mm && y > trim.bottom_mm && y <= trim.top_mm;
                if piece.panel.side == side && mine {
                    let px = |mm: f64| (mm / 25.4 * DPI) as u32;
                    return self.pages[page]
                        .get_pixel(px(x), px(piece.layout.frame.page.height_mm - y))
                        .0;
                }
                page += 1;
            }
        }
        panic!("no sheet shows {side:?} {u} {v}")
    }
}

/// Points spread evenly over the paint that is printed, and the faces they are on.
fn points(paint: &PaintedSurface, count: usize) -> Vec<(Point3<f64>, Face)> {
    let mut random = Pcg32::seed_from_u64(7);
    let mut sums = Vec::new();
    for face in &paint.faces {
        let area = if face.side == Side::Bottom {
            0.0
        } else {
            face.surface_mm2
        };
        sums.push(sums.last().unwrap_or(&0.0) + area);
    }
    let mut unit = || random.random::<f64>();
    let mut point = || {
        let at = unit() * sums.last().unwrap();
        let face = &paint.faces[sums.partition_point(|sum| *sum < at)];
        let [a, b, c] = face.corners;
        let (mut s, mut t) = (unit(), unit());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        (a + s * (b - a) + t * (c - a), *face)
    };
    (0..count).map(|_| point()).collect()
}

/// Where a point is on its panel, written out a second time: as somebody sees it who looks at that side from outside.
fn on_panel(side: Side, p: &Point3<f64>) -> [f64; 2] {
    match side {
        Side::Left => [-p.x, p.z],
        Side::Right => [p.x, p.z],
        Side::Roof => [-p.y, p.x],
        Side::Front => [p.y, p.z],
        Side::Rear => [-p.y, p.z],
        Side::Bottom => panic!("no panel"),
    }
}

/// Which share of 10,000 points of the paint has the world-aligned colour on paper, those near cell borders excepted.
fn share_right(printed: &Printed, mesh: &Mesh, materials: &[usize], pattern: &Pattern) -> f64 {
    let laid = WorldAligned {
        pattern,
        cell_mm: printed.wrap.cell_mm.unwrap(),
    };
    let near_border = |mm: f64| {
        let rest = mm.rem_euclid(laid.cell_mm);
        rest.min(laid.cell_mm - rest) <= 0.1
    };
    let (mut right, mut compared) = (0, 0);
    for (point, face) in points(&PaintedSurface::of_materials(mesh, materials), 10_000) {
        let [a, b, c] = face.corners;
        let normal = (b - a).cross(&(c - a));
        let side = Side::facing(&normal);
        let place = on_panel(side, &point);
        if place.iter().any(|mm| near_border(*mm)) {
            continue;
        }
        right += usize::from(printed.colour(side, place) == laid.colour(&point, &normal));
        compared += 1;
    }
    println!("{right} of {compared} points have their colour");
    assert!(compared > 9_000, "{compared}");
    right as f64 / f64::from(compared)
}

/// The acceptance line: paint of the skyline model.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_skyline_panels_show_what_a_renderer_shows() {
    let glb = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let folder = tempfile::tempdir().unwrap();
    let pattern = Pattern::random(16, 1).unwrap();
    let (png, pdf) = (pattern_file(&pattern, folder.path()), folder.path().join("w.pdf"));
    let scene = shared("sessions/skyline/scene.toml");
    done(&format!(
        "print wrap --panels --mesh {} --material Material.001 --length-mm 455 --scene {} --pattern {} --tile-mm 118 --paper a3 -o {}",
        glb.display(),
        scene.display(),
        png.display(),
        pdf.display()
    ));
    let placement = MeshPlacement {
        length_mm: Some(455.0),
        ..MeshPlacement::default()
    };
    let mesh = Mesh::load(&glb, &placement).unwrap();
    let paint = mesh.materials_named(&["Material.001".into()]).unwrap();
    let made = wrap(&mesh, &paint, &tiled(&pattern, 118.0), &request(Paper::A3)).unwrap();
    made.facts().iter().for_each(|fact| println!("{fact}"));
    println!("{:.0} mm of seams without a letter", made.unlettered_mm);
    let share = share_right(&Printed::new(made, &pdf), &mesh, &paint, &pattern);
    assert!(share >= 0.999, "{share}");
    skyline_lies_as_in_the_photos(&mesh);
}

/// The mesh in the model frame, seen with the true poses, fills the true boxes: front and left are where the photos have them.
fn skyline_lies_as_in_the_photos(mesh: &Mesh) {
    let text = std::fs::read_to_string(shared("sessions/skyline/truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let corners: Vec<_> = mesh.triangles().iter().flat_map(|t| mesh.corners_mm(t)).collect();
    for photo in truth["photos"].as_array().unwrap() {
        let entry = |row: usize, column: usize| photo["T_camera_model_mm"][row][column].as_f64().unwrap();
        let mut found = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for p in &corners {
            let at = |row| entry(row, 0) * p.x + entry(row, 1) * p.y + entry(row, 2) * p.z + entry(row, 3);
            let (x, y) = (at(0) / at(2), at(1) / at(2));
            // Camera of the session: its file.
            let r2 = x * x + y * y;
            let bent = 1.0 - 0.08 * r2 + 0.03 * r2 * r2;
            let (px, py) = (648.5 + 1180.0 * bent * x, 473.5 + 1180.0 * bent * y);
            found = [found[0].min(px), found[1].min(py), found[2].max(px), found[3].max(py)];
        }
        for (i, edge) in found.iter().enumerate() {
            let expected = photo["box_xyxy_px"][i].as_f64().unwrap();
            assert!(
                (edge - expected).abs() < 3.0,
                "{}: {found:?}, {expected}",
                photo["file"]
            );
        }
    }
}

#[test]
fn the_bar_is_printed_as_calculated() {
    let folder = tempfile::tempdir().unwrap();
    let pattern = Pattern::random(9, 4).unwrap();
    let (png, pdf, obj) = (
        pattern_file(&pattern, folder.path()),
        folder.path().join("w.pdf"),
        bar(folder.path()),
    );
    done(&format!(
        "print wrap --panels --mesh {} --material paint --pattern {} --tile-mm 61.7 --paper a4 -o {}",
        obj.display(),
        png.display(),
        pdf.display()
    ));
    let mesh = Mesh::load(&obj, &MeshPlacement::default()).unwrap();
    let paint = mesh.materials_named(&["paint".into()]).unwrap();
    let made = wrap(&mesh, &paint, &tiled(&pattern, 61.7), &request(Paper::A4)).unwrap();
    let [length, width, height, down, inwards] = BAR;
    let slope = down.hypot(inwards);
    let cap = width * height - down * inwards;
    let flat = |side: Side| {
        let piece = made.pieces.iter().find(|piece| piece.panel.side == side);
        piece.map(|piece| {
            (
                piece.panel.flat_mm2(),
                piece.panel.surface_mm2,
                piece.panel.largest_stretch,
            )
        })
    };
    let expected = [
        (Side::Left, length * (height - down), length * (height - down), 1.0),
        (Side::Right, length * (height - down), length * (height - down), 1.0),
        (
            Side::Roof,
            length * width,
            length * (width - 2.0 * inwards + 2.0 * slope),
            slope / inwards,
        ),
        (Side::Rear, cap, cap, 1.0),
    ];
    for (side, paper, surface, stretch) in expected {
        let found = flat(side).unwrap();
        println!("{side:?}: {found:?}");
        assert!(
            (found.0 - paper).abs() < 0.1 && (found.1 - surface).abs() < 0.1,
            "{side:?}"
        );
        assert!((found.2 - stretch).abs() < 1e-6, "{side:?}");
    }
    assert_eq!(flat(Side::Front), None, "glass");
    assert!((made.unprinted_mm2() - length * width).abs() < 0.1, "the floor");
    assert!((made.largest_stretch() - 1.118).abs() < 1e-3);
    let printed = Printed::new(made, &pdf);
    assert_eq!(share_right(&printed, &mesh, &paint, &pattern), 1.0);
    borders_run_on_over_the_seams(&printed);
}

/// Along the seam between left side and roof, and around the corner between left side and rear, cells end at the same places.
fn borders_run_on_over_the_seams(printed: &Printed) {
    let [length, width, height, down, _] = BAR;
    let changes = |from: f64, to: f64, colour: &dyn Fn(f64) -> [u8; 3]| -> Vec<f64> {
        let steps = ((to - from) / 0.05) as usize;
        let at = |i: usize| from + 0.05 * i as f64;
        (1..steps)
            .filter(|i| colour(at(*i)) != colour(at(i - 1)))
            .map(at)
            .collect()
    };
    let agree = |a: Vec<f64>, b: Vec<f64>| {
        // A soft edge is two changes; every border has a partner on the other panel.
        let missing = |a: &[f64], b: &[f64]| a.iter().filter(|x| b.iter().all(|y| (*x - y).abs() > 0.2)).count();
        println!("{} and {} borders along a seam", a.len(), b.len());
        assert!(
            a.len() >= 5 && missing(&a, &b) == 0 && missing(&b, &a) == 0,
            "{a:?} {b:?}"
        );
    };
    let end = length / 2.0 - 1.0;
    let (z, y) = (height - down - 1.0, width / 2.0 - 1.0);
    agree(
        changes(-end, end, &|x| printed.colour(Side::Left, [-x, z])),
        changes(-end, end, &|x| printed.colour(Side::Roof, [-y, x])),
    );
    agree(
        changes(1.0, z, &|z| printed.colour(Side::Left, [end, z])),
        changes(1.0, z, &|z| printed.colour(Side::Rear, [-y, z])),
    );
}

/// A pattern with a red cell whose right neighbour is green and whose lower neighbour is blue reads so on every panel.
#[test]
fn nothing_is_mirrored() {
    let folder = tempfile::tempdir().unwrap();
    let mut cells = RgbImage::from_pixel(3, 3, Rgb([90, 90, 90]));
    cells.put_pixel(0, 0, Rgb([255, 0, 0]));
    cells.put_pixel(1, 0, Rgb([0, 255, 0]));
    cells.put_pixel(0, 1, Rgb([0, 0, 255]));
    let [png, pdf, scene] = ["p.png", "w.pdf", "s.toml"].map(|name| folder.path().join(name));
    cells.save(&png).unwrap();
    done(&format!(
        "scene new --preset ring --radius-mm 300 --tags 4 --tag-mm 50 --model-size-mm 160x80x60 -o {}",
        scene.display()
    ));
    done(&format!(
        "print wrap --panels --scene {} --pattern {} --tile-mm 30 -o {}",
        scene.display(),
        png.display(),
        pdf.display()
    ));
    let pattern = Pattern::load(&png).unwrap();
    let made = wrap(
        &Mesh::cuboid([160.0, 80.0, 60.0]),
        &[],
        &tiled(&pattern, 30.0),
        &request(Paper::A4),
    )
    .unwrap();
    let printed = Printed::new(made, &pdf);
    // Red cells: columns from the model's middle, rows down from 60 mm above the ground.
    for side in [Side::Left, Side::Right, Side::Front, Side::Rear] {
        assert_eq!(printed.colour(side, [5.0, 55.0]), [255, 0, 0], "{side:?}");
        assert_eq!(printed.colour(side, [15.0, 55.0]), [0, 255, 0], "{side:?}");
        assert_eq!(printed.colour(side, [5.0, 45.0]), [0, 0, 255], "{side:?}");
    }
    assert_eq!(printed.colour(Side::Roof, [5.0, -5.0]), [255, 0, 0]);
    assert_eq!(printed.colour(Side::Roof, [15.0, -5.0]), [0, 255, 0]);
    assert_eq!(printed.colour(Side::Roof, [5.0, -15.0]), [0, 0, 255]);
    // All eight seams around a box have a letter, the longest the first.
    assert_eq!(printed.wrap.unlettered_mm, 0.0);
    for (panel, page, count) in [("left", 2, 3), ("roof", 4, 4)] {
        let text = text_of(&pdf, page);
        let letters: Vec<&str> = text
            .lines()
            .map(str::trim)
            .filter(|l| l.len() == 1 && l.chars().all(char::is_lowercase))
            .collect();
        println!("{panel}: {letters:?}");
        assert_eq!(letters.len(), count, "{text}");
    }
}

/// A patch of known pixels, measured on the page of its piece, as rectangles and as an embedded image.
#[test]
fn patches_have_their_size_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let obj = bar(folder.path()).display().to_string();
    for (pixels, name) in [(8u32, "small.png"), (200, "large.png")] {
        let picture = RgbImage::from_fn(pixels, pixels / 2, |x, y| {
            let left = x < pixels / 2;
            Rgb(if left {
                [200, 20, 20]
            } else {
                [20, 20, 200 - u8::from(y > 0)]
            })
        });
        picture.save(path(name)).unwrap();
        let (from, to) = (path(name), path("patch.pdf"));
        done(&format!(
            "print patch --mesh {obj} --patch {from} --panel left --at-mm -30,25 --size-mm 60 -o {to}"
        ));
        let pages = pages(Path::new(&to), 1, DPI);
        assert_eq!(pages.len(), 2, "the panel, then the piece");
        for (page, id) in [(1, "left A1"), (2, "patch1 A1")] {
            let text = text_of(Path::new(&to), page);
            assert!(
                text.contains(id) && text.contains("on the left panel at -30, 25 mm"),
                "{text}"
            );
        }
        for (i, page) in pages.iter().enumerate() {
            let red: Vec<_> = coloured(page, |c| c[0] > 150 && c[1] < 60 && c[2] < 60);
            let blue: Vec<_> = coloured(page, |c| c[2] > 150 && c[1] < 60 && c[0] < 60);
            let wide = extent(&blue, 0).1 - extent(&red, 0).0;
            println!(
                "{name}, page {i}: {wide:.2} mm wide, {:.2} mm high",
                extent(&red, 1).1 - extent(&red, 1).0
            );
            assert!((wide - 60.0).abs() < 0.15, "{wide}");
            assert!((extent(&red, 1).1 - extent(&red, 1).0 - 30.0).abs() < 0.15);
            // The halves meet in the middle, without a mixed strip.
            assert!((extent(&blue, 0).0 - extent(&red, 0).1).abs() < 0.15);
        }
    }
    // Half of it beyond the front edge is cut off and said; wholly beside is refused.
    let small = path("small.png");
    let base = format!(
        "print patch --mesh {obj} --patch {small} --panel left --size-mm 60x30 -o {}",
        path("b.pdf")
    );
    let half = scaleproof(&format!("{base} --at-mm -100,25"));
    let said = String::from_utf8(half.stderr).unwrap();
    assert!(said.contains("50.0 % of small.png"), "{said}");
    assert_refused(
        &scaleproof(&format!("{base} --at-mm -300,25")),
        &["beside the left panel", "-100,0"],
    );
    assert_refused(&scaleproof(&format!("{base} --at-mm here")), &["as in -40,65"]);
    assert_refused(
        &scaleproof(&format!("{base} --at-mm 0,25 --at-mm 0,30")),
        &["repeat all four"],
    );
    assert_refused(
        &scaleproof(&format!("{base} --at-mm 0,25").replace("60x30", "0")),
        &["patch width cannot be 0"],
    );
    assert_refused(
        &scaleproof(&format!("{base} --at-mm 0,25").replace("60x30", "60x0.01")),
        &["patch height cannot be 0.01"],
    );
    for scale in ["0", "-10", "nan", "inf", "1e308"] {
        assert_refused(
            &scaleproof(&format!("{base} --at-mm 0,25 --scale {scale}")),
            &["scale cannot be"],
        );
    }
    assert_refused(
        &scaleproof(&format!("{base} --at-mm 0,25").replace("small.png", "bar.obj")),
        &["neither PNG nor JPEG"],
    );
}

/// The middles, in mm from the top-left, of the pixels of a kind.
fn coloured(page: &RgbImage, kind: impl Fn([u8; 3]) -> bool) -> Vec<[f64; 2]> {
    let mm = |px: u32| (f64::from(px) + 0.5) * 25.4 / DPI;
    let pixels = page.enumerate_pixels().filter(|(_, _, colour)| kind(colour.0));
    pixels.map(|(x, y, _)| [mm(x), mm(y)]).collect()
}

fn extent(points: &[[f64; 2]], axis: usize) -> (f64, f64) {
    let along = points.iter().map(|p| p[axis]);
    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
        (low.min(at), high.max(at))
    })
}

#[test]
fn impossible_wraps_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let obj = bar(folder.path()).display().to_string();
    let png = pattern_file(&Pattern::random(4, 1).unwrap(), folder.path())
        .display()
        .to_string();
    std::fs::write(path("empty.obj"), "v 0 0 0\n").unwrap();
    std::fs::write(path("torn.glb"), "glTF").unwrap();
    std::fs::write(path("flat.obj"), "v 0 0 0\nv 100 0 0\nv 0 100 0\nf 3 2 1\n").unwrap();
    // As a program exports that counts in metres, and a damaged one that would take for ever.
    let solid =
        |side: &str| format!("v 0 0 0\nv {side} 0 0\nv 0 {side} 0\nv 0 0 {side}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    std::fs::write(path("metres.obj"), solid("0.455")).unwrap();
    std::fs::write(path("giant.obj"), solid("1e8")).unwrap();
    // A car as large as life.
    std::fs::write(path("car.obj"), solid("4550")).unwrap();
    let scene = path("s.toml");
    done(&format!(
        "scene new --preset ring --radius-mm 300 --tags 4 --tag-mm 50 --model-size-mm 220x90x60 -o {scene}"
    ));
    let out = path("w.pdf");
    let usual = format!("print wrap --panels --mesh {obj} --pattern {png} --tile-mm 40 -o {out}");
    let cases: [(String, &[&str]); 20] = [
        (usual.replace("bar.obj", "empty.obj"), &["has no faces"]),
        (usual.replace("bar.obj", "absent.obj"), &["cannot read", "no such file"]),
        (usual.replace("bar.obj", "torn.glb"), &["cannot be read as a mesh"]),
        (usual.replace("bar.obj", "p.png"), &[".glb, .obj, .stl or .ply"]),
        (
            usual.replace("bar.obj", "flat.obj"),
            &["no surface on any of the five sides"],
        ),
        (
            usual.replace("bar.obj", "metres.obj"),
            &["0.455 × 0.455 × 0.455 mm", "--length-mm"],
        ),
        (usual.replace("bar.obj", "giant.obj"), &["100000000 ×", "10 to 5000 mm"]),
        (
            usual.replace("bar.obj", "car.obj"),
            &["4550 × 4550 × 4550 mm", "--length-mm", "455 (1:10)"],
        ),
        (
            usual.replace("bar.obj", "car.obj") + " --scale 25",
            &["as in 182 (1:25)"],
        ),
        (
            usual.replace("bar.obj", "car.obj") + " --length-mm 20000",
            &["would be 20000 ×", "10 to 5000 mm"],
        ),
        (
            format!("{usual} --length-mm 1e6"),
            &["cannot be set to 1000000", "as in 455"],
        ),
        (
            format!("{usual} --material body"),
            &["no material 'body'", "'paint', 'glass'"],
        ),
        (
            format!("{usual} --scene {scene}"),
            &["200 × 90 × 60", "220 × 90 × 60", "--length-mm"],
        ),
        (format!("{usual} --length-mm -5"), &["cannot be set to -5"]),
        (format!("{usual} --mesh-front w"), &["no direction"]),
        (format!("{usual} --mesh-up +x"), &["same axis"]),
        (
            usual.replace("--tile-mm 40", "--tile-mm 0"),
            &["tile width cannot be 0"],
        ),
        (
            usual.replace("--tile-mm 40", "--tile-mm -3"),
            &["tile width cannot be -3"],
        ),
        (format!("{usual} --paper 90x90"), &["too small"]),
        (
            format!("print wrap --panels --pattern {png} --tile-mm 40 -o {out}"),
            &["--mesh"],
        ),
    ];
    for (command, words) in cases {
        assert_refused(&scaleproof(&command), words);
        assert!(!Path::new(&out).exists(), "{command}");
    }
    assert_refused(
        &scaleproof(&(usual.replace("w.pdf", "bar.obj") + " --format pdf")),
        &["would be overwritten"],
    );
    // Life-size all the same, if somebody says so.
    std::fs::write(path("bus.obj"), solid("1600")).unwrap();
    let bus = usual
        .replace("bar.obj", "bus.obj")
        .replace("--tile-mm 40", "--tile-mm 400")
        + " --paper roll1600";
    assert_refused(&scaleproof(&bus), &["as in 160 (1:10) or, if the file is right, 1600"]);
    done(&format!("{bus} --length-mm 1600"));
    // The same input gives the same bytes, and SVG has a file a page.
    done(&usual);
    let first = std::fs::read(&out).unwrap();
    done(&usual);
    assert!(first == std::fs::read(&out).unwrap());
    done(&usual.replace("w.pdf", "w.svg"));
    assert!(Path::new(&path("w-assembly.svg")).exists() && Path::new(&path("w-left-A1.svg")).exists());
    let text = std::fs::read_to_string(path("w-left-A1.svg")).unwrap();
    assert!(roxmltree::Document::parse(&text).is_ok() && text.contains("clip-path"));
    let cut = text.split("id=\"cut\"").nth(1).unwrap();
    assert!(cut.contains("<path d=\"M"), "the cutter follows the panel: {cut}");
}

#[test]
fn the_shipped_examples_are_what_their_commands_give() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("print_templates");
    let (scene, png) = (shipped.join("ring4.toml"), shipped.join("random16.png"));
    let (scene, png) = (scene.display(), png.display());
    for (name, command) in [
        (
            "ring4_wrap_a3.pdf",
            format!("wrap --panels --scene {scene} --pattern {png} --tile-mm 118"),
        ),
        (
            "ring4_patch_a3.pdf",
            format!("patch --scene {scene} --patch {png} --panel left --at-mm 0,50 --size-mm 80"),
        ),
    ] {
        let made = folder.path().join(name);
        done(&format!("print {command} --paper a3 -o {}", made.display()));
        assert!(
            std::fs::read(&made).unwrap() == std::fs::read(shipped.join(name)).unwrap(),
            "{name} is out of date: its README says how to make it again"
        );
    }
}
