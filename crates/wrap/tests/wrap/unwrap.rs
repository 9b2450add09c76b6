//! Cuts shapes whose truth is known, two real cars and broken meshes into pieces, and holds every piece against the surface.

use crate::common;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use common::shared;
use nalgebra::{Matrix2, Point3, Vector2};
use proptest::prelude::*;
use scaleproof_core::geometry::distance;
use scaleproof_surface::mesh::{Mesh, MeshPlacement};
use scaleproof_wrap::unwrap::{Chart, FlatFace, LeftOutReason, UnwrapError, UnwrapRequest, Unwrapped, unwrap};

/// A3 and A4 within margins of 8 mm.
const A3: [f64; 2] = [404.0, 281.0];
const A4: [f64; 2] = [281.0, 194.0];

type Triangles = Vec<[[f64; 3]; 3]>;

/// Triangles as a mesh of one material, as it comes out of a file.
fn mesh(triangles: &Triangles) -> Mesh {
    let (mut text, mut faces) = (String::new(), String::new());
    for (i, triangle) in triangles.iter().enumerate() {
        for [x, y, z] in triangle {
            writeln!(text, "v {x:.17} {y:.17} {z:.17}").unwrap();
        }
        writeln!(faces, "f {} {} {}", 3 * i + 1, 3 * i + 2, 3 * i + 3).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    std::fs::write(&path, text + &faces).unwrap();
    Mesh::load(&path, &MeshPlacement::default()).unwrap()
}

/// The quads between neighbouring points of a grid, each as two triangles; `at` gives the point.
fn grid(columns: usize, rows: usize, at: impl Fn(usize, usize) -> [f64; 3]) -> Triangles {
    let quads = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let halves = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    halves.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// Around an axis upwards: radius and height of each row, closed in itself.
fn turned(columns: usize, outline: &[[f64; 2]]) -> Triangles {
    grid(columns, outline.len() - 1, |i, j| {
        let (sin, cos) = (std::f64::consts::TAU * (i % columns) as f64 / columns as f64).sin_cos();
        let [radius, height] = outline[j];
        [radius * cos, radius * sin, height]
    })
}

fn sphere(columns: usize, radius: f64) -> Triangles {
    let rows = columns / 2;
    let outline = (0..=rows).map(|j| {
        let (sin, cos) = (std::f64::consts::PI * j as f64 / rows as f64).sin_cos();
        let is_pole = j == 0 || j == rows;
        [if is_pole { 0.0 } else { radius * sin }, radius - radius * cos]
    });
    turned(columns, &outline.collect::<Vec<_>>())
}

fn everything() -> UnwrapRequest {
    UnwrapRequest {
        hidden_too: true,
        ..UnwrapRequest::default()
    }
}

fn pieces(mesh: &Mesh, request: &UnwrapRequest) -> Unwrapped {
    let unwrapped = unwrap(mesh, &[], request, &mut |_| ()).unwrap();
    assert_true(mesh, &[], request, &unwrapped);
    unwrapped
}

fn area(corners: &[Point3<f64>; 3]) -> f64 {
    0.5 * (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm()
}

fn corners(unwrapped: &Unwrapped, face: &FlatFace) -> [Point3<f64>; 3] {
    face.corners.map(|c| unwrapped.points_mm[c])
}

/// How long the outline of a piece is, slits and holes included.
fn outline_mm(chart: &Chart) -> f64 {
    let key = |p: [f64; 2]| p.map(|v| (v + 0.0).to_bits());
    let mut sides = BTreeMap::new();
    for face in &chart.faces {
        for i in 0..3 {
            let (p, q) = (face.flat_mm[i], face.flat_mm[(i + 1) % 3]);
            let ends = [key(p).min(key(q)), key(p).max(key(q))];
            sides.entry(ends).or_insert((0, distance(p, q))).0 += 1;
        }
    }
    sides.values().filter(|(n, _)| *n == 1).map(|(_, l)| l).sum()
}

fn faces(unwrapped: &Unwrapped) -> impl Iterator<Item = &FlatFace> {
    unwrapped.charts.iter().flat_map(|c| &c.faces)
}

/// The stretch by the eigenvalues of one first fundamental form in terms of the other.
fn stretch(surface: &[Point3<f64>; 3], paper: &[[f64; 2]; 3]) -> f64 {
    let (b, c) = (surface[1] - surface[0], surface[2] - surface[0]);
    let flat = paper.map(Vector2::from);
    let (p, q) = (flat[1] - flat[0], flat[2] - flat[0]);
    let before = Matrix2::new(b.dot(&b), b.dot(&c), b.dot(&c), c.dot(&c));
    let after = Matrix2::new(p.dot(&p), p.dot(&q), p.dot(&q), q.dot(&q));
    let ratio = before.try_inverse().unwrap() * after;
    let (half, product) = (0.5 * ratio.trace(), ratio.determinant());
    let root = (half * half - product).max(0.0).sqrt();
    let (large, small) = (half + root, product / (half + root));
    large.max(1.0 / small).sqrt()
}

/// Holds every promise of the pieces against the mesh.
fn assert_true(mesh: &Mesh, paint: &[usize], request: &UnwrapRequest, unwrapped: &Unwrapped) {
    let (low, high) = mesh.bounds_mm();
    let tolerance = 1e-5 * (high - low).amax();
    let mut values = Vec::new();
    let mut shown: BTreeMap<usize, f64> = BTreeMap::new();
    for face in faces(unwrapped) {
        let triangle = mesh.triangles()[face.triangle];
        assert!(paint.is_empty() || paint.contains(&triangle.material));
        let (own, whole) = (corners(unwrapped, face), mesh.corners_mm(&triangle));
        for (corner, weights) in own.iter().zip(face.weights) {
            let place: nalgebra::Vector3<f64> = whole.iter().zip(weights).map(|(p, w)| w * p.coords).sum();
            assert!((corner.coords - place).norm() < tolerance, "a corner lies elsewhere");
        }
        let [a, b, c] = face.flat_mm.map(Vector2::from);
        assert!((b - a).perp(&(c - a)) > 0.0, "a face is mirrored");
        let truth = stretch(&own, &face.flat_mm);
        assert!(
            (face.stretch - truth).abs() < 1e-4 * truth,
            "stretch {} is {truth}",
            face.stretch
        );
        values.push((truth, area(&own)));
        *shown.entry(face.triangle).or_default() += area(&own);
    }
    for (triangle, shown) in &shown {
        let whole = area(&mesh.corners_mm(&mesh.triangles()[*triangle]));
        assert!(
            *shown < whole * 1.0001 + tolerance * tolerance,
            "a triangle is there twice"
        );
    }
    let covered: f64 = values.iter().map(|(_, area)| area).sum();
    let mean = values.iter().map(|(s, area)| s * area).sum::<f64>() / covered;
    assert!((mean - unwrapped.mean_stretch).abs() < 1e-6 && mean <= request.mean_stretch + 1e-9);
    let above = |least: f64| {
        values
            .iter()
            .filter(|(s, _)| *s > least)
            .map(|(_, area)| area)
            .sum::<f64>()
    };
    assert!(above(request.stretch_99 + 1e-9) <= 0.01 * covered && above(unwrapped.stretch_99 + 1e-6) <= 0.01 * covered);
    assert_eq!(above(unwrapped.largest_stretch * 1.0001), 0.0);
    let left_out = |reason: LeftOutReason| -> f64 {
        let of = unwrapped.left_out.iter().filter(|l| l.reason == reason);
        of.map(|l| l.surface_mm2).sum()
    };
    let small = left_out(LeftOutReason::TooSmall);
    assert!((covered + small - unwrapped.visible_mm2).abs() < 1e-6 * unwrapped.visible_mm2);
    assert!(covered >= 0.97 * unwrapped.visible_mm2);
    let is_paint = |m: usize| paint.is_empty() || paint.contains(&m);
    let painted = mesh.triangles().iter().filter(|t| is_paint(t.material));
    let total: f64 = painted.map(|t| area(&mesh.corners_mm(t))).sum();
    let named = unwrapped.visible_mm2 + left_out(LeftOutReason::Hidden);
    assert!((total - named).abs() < 1e-4 * total, "{named} mm² of {total} are named");
    for charts in unwrapped.charts.windows(2) {
        assert!(
            charts[0].surface_mm2 >= charts[1].surface_mm2,
            "the largest is not first"
        );
    }
    if let Some(most) = request.most_pieces {
        assert!(unwrapped.charts.len() <= most);
    }
    for chart in &unwrapped.charts {
        assert!(!chart.faces.is_empty());
        assert_fits(chart, request);
        assert_no_overlap(chart);
    }
}

/// The largest coordinates of a piece; the smallest are 0.
fn size(chart: &Chart) -> [f64; 2] {
    let points = chart.faces.iter().flat_map(|f| f.flat_mm);
    let (mut low, mut high) = ([f64::INFINITY; 2], [0.0_f64; 2]);
    for p in points {
        low = [low[0].min(p[0]), low[1].min(p[1])];
        high = [high[0].max(p[0]), high[1].max(p[1])];
    }
    assert_eq!(low, [0.0; 2]);
    high
}

fn assert_fits(chart: &Chart, request: &UnwrapRequest) {
    if let Some([width, height]) = request.fits_mm {
        let [x, y] = size(chart);
        assert!(x <= width + 1e-6 && y <= height + 1e-6, "{x} × {y} mm");
    }
}

/// Every pixel of the paper lies in one face of a piece at most, but for the borders of faces.
fn assert_no_overlap(chart: &Chart) {
    let [width, height] = size(chart);
    let pixel = (width.max(height) / 900.0).max(0.02);
    let columns = (width / pixel) as usize + 1;
    let mut has_face = vec![false; columns * ((height / pixel) as usize + 1)];
    for face in &chart.faces {
        let corners = face.flat_mm.map(Vector2::from);
        let low = corners.iter().fold(corners[0], |l, p| l.inf(p)) / pixel;
        let high = corners.iter().fold(corners[0], |h, p| h.sup(p)) / pixel;
        for y in low.y as usize..=high.y as usize {
            for x in low.x as usize..=high.x as usize {
                let p = pixel * Vector2::new(x as f64 + 0.37, y as f64 + 0.41);
                let inside = (0..3).all(|i| {
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    (b - a).perp(&(p - a)) > 0.011 * (b - a).norm()
                });
                if inside {
                    let pixel = &mut has_face[y * columns + x];
                    assert!(!*pixel, "two faces of a piece overlap");
                    *pixel = true;
                }
            }
        }
    }
}

fn assert_unrolls(unwrapped: &Unwrapped) {
    assert!(unwrapped.largest_stretch < 1.0005, "{}", unwrapped.largest_stretch);
}

#[test]
fn a_box_unfolds_without_stretch_and_its_floor_is_hidden() {
    let unwrapped = pieces(&Mesh::cuboid([100.0, 60.0, 40.0]), &UnwrapRequest::default());
    assert_unrolls(&unwrapped);
    assert!((unwrapped.visible_mm2 - 18_800.0).abs() < 1e-6);
    assert_eq!(unwrapped.left_out.len(), 1);
    let hidden = &unwrapped.left_out[0];
    assert_eq!((hidden.reason, hidden.triangles.len()), (LeftOutReason::Hidden, 2));
    assert!((hidden.surface_mm2 - 6000.0).abs() < 1e-6);
    let all = pieces(&Mesh::cuboid([100.0, 60.0, 40.0]), &everything());
    assert!((all.visible_mm2 - 24_800.0).abs() < 1e-6 && all.left_out.is_empty());
    // Outside is outside.
    for face in faces(&all) {
        let [a, b, c] = corners(&all, face);
        assert!((b - a).cross(&(c - a)).dot(&(a - Point3::new(0.0, 0.0, 20.0))) > 0.0);
    }
}

#[test]
fn a_box_is_cut_where_the_paper_ends() {
    let request = UnwrapRequest {
        fits_mm: Some([100.0, 70.0]),
        ..everything()
    };
    let unwrapped = pieces(&Mesh::cuboid([300.0, 60.0, 40.0]), &request);
    assert_unrolls(&unwrapped);
    assert!((faces(&unwrapped).map(|f| area(&corners(&unwrapped, f))).sum::<f64>() - 64_800.0).abs() < 1e-6);
}

#[test]
fn a_tube_unrolls_into_its_rectangle() {
    let unwrapped = pieces(
        &mesh(&turned(60, &[[20.0, 0.0], [20.0, 35.0], [20.0, 70.0]])),
        &everything(),
    );
    assert_unrolls(&unwrapped);
    let circumference = 60.0 * 2.0 * 20.0 * (std::f64::consts::PI / 60.0).sin();
    assert_eq!(unwrapped.charts.len(), 1);
    let [x, y] = size(&unwrapped.charts[0]);
    assert!(
        (x.max(y) - circumference).abs() < 0.05 && (x.min(y) - 70.0).abs() < 0.05,
        "{x} × {y}"
    );
    assert!((unwrapped.charts[0].surface_mm2 - 70.0 * circumference).abs() < 0.01);
}

#[test]
fn a_cone_unrolls_into_sectors() {
    let outline: Vec<[f64; 2]> = (0..=6)
        .map(|i| [60.0 - 10.0 * f64::from(i), 8.0 * f64::from(i)])
        .collect();
    let unwrapped = pieces(&mesh(&turned(48, &outline)), &everything());
    assert_unrolls(&unwrapped);
    assert!(unwrapped.charts.len() <= 2, "{}", unwrapped.charts.len());
}

#[test]
fn a_sphere_is_cut_until_the_bounds_hold() {
    let ball = mesh(&sphere(40, 100.0));
    let unwrapped = pieces(&ball, &everything());
    assert!(unwrapped.charts.len() > 3 && unwrapped.mean_stretch > 1.001);
    let strict = UnwrapRequest {
        mean_stretch: 1.005,
        stretch_99: 1.03,
        ..everything()
    };
    assert!(pieces(&ball, &strict).charts.len() > unwrapped.charts.len());
    let few = UnwrapRequest {
        most_pieces: Some(12),
        fits_mm: Some(A4),
        ..everything()
    };
    pieces(&ball, &few);
    // A sphere is no disc: two pieces have more stretch (Chebyshev's theorem on maps).
    let error = unwrap(
        &ball,
        &[],
        &UnwrapRequest {
            most_pieces: Some(2),
            ..few
        },
        &mut |_| (),
    )
    .unwrap_err();
    assert!(
        matches!(error, UnwrapError::TooFewPieces { most: 2, needed } if needed > 2),
        "{error}"
    );
}

#[test]
fn broken_meshes_are_cut_like_others() {
    let sheet = |z: f64| grid(6, 6, move |i, j| [10.0 * i as f64, 10.0 * j as f64, z]);
    let fin = |x: f64| grid(1, 6, move |i, j| [x, 10.0 * j as f64, 10.0 * i as f64]);
    // Three faces meet at the edges of a fin.
    let with_fin = [sheet(0.0), fin(30.0)].concat();
    let unwrapped = pieces(&mesh(&with_fin), &everything());
    assert!((unwrapped.visible_mm2 - 4200.0).abs() < 1e-6);
    // The same sheet twice, and turned over.
    let mut twice = [sheet(0.0), sheet(0.0)].concat();
    pieces(&mesh(&twice), &everything());
    twice[72..].iter_mut().for_each(|t| t.swap(0, 1));
    pieces(&mesh(&twice), &everything());
    // Triangles without area are named.
    let mut flat = sheet(0.0);
    flat.extend([[[5.0, 5.0, 0.0]; 3], [[0.0; 3], [10.0, 0.0, 0.0], [20.0, 0.0, 0.0]]]);
    let unwrapped = pieces(&mesh(&flat), &everything());
    assert_eq!(unwrapped.left_out[0].triangles, [72, 73]);
    assert_eq!(unwrapped.left_out[0].reason, LeftOutReason::NoArea);
    assert_eq!(unwrapped.charts.len(), 1);
    // Corners that are apart by rounding only are one.
    let mut apart = sheet(0.0);
    for (i, triangle) in apart.iter_mut().enumerate() {
        triangle.iter_mut().for_each(|p| p[2] += 1e-6 * (i % 3) as f64);
    }
    assert_eq!(pieces(&mesh(&apart), &everything()).charts.len(), 1);
    // Far from each other.
    let alone: Triangles = (0..20)
        .map(|i| [[0.0, 0.0], [9.0, 0.0], [0.0, 9.0]].map(|[x, y]| [x, y, 20.0 * f64::from(i)]))
        .collect();
    assert_eq!(pieces(&mesh(&alone), &everything()).charts.len(), 20);
}

#[test]
fn winding_does_not_matter() {
    let mut ball = sphere(24, 50.0);
    let whole = pieces(&mesh(&ball), &UnwrapRequest::default());
    ball.iter_mut().step_by(3).for_each(|t| t.swap(1, 2));
    let unwrapped = pieces(&mesh(&ball), &UnwrapRequest::default());
    assert_eq!(unwrapped.charts.len(), whole.charts.len());
    for face in faces(&unwrapped) {
        let [a, b, c] = corners(&unwrapped, face);
        assert!(
            (b - a).cross(&(c - a)).dot(&(a - Point3::new(0.0, 0.0, 50.0))) > 0.0,
            "a face shows its inside"
        );
    }
}

#[test]
fn a_band_with_one_side_is_cut_across() {
    let band = grid(48, 2, |i, j| {
        let (i, j) = if i == 48 { (0, 2 - j) } else { (i, j) };
        let angle = std::f64::consts::TAU * i as f64 / 48.0;
        let across = 8.0 * (j as f64 - 1.0);
        let (radius, height) = (60.0 + across * (angle / 2.0).cos(), across * (angle / 2.0).sin());
        [radius * angle.cos(), radius * angle.sin(), height]
    });
    pieces(&mesh(&band), &everything());
}

#[test]
fn the_same_mesh_gives_the_same_pieces_and_progress_never_goes_back() {
    let ball = mesh(&sphere(30, 80.0));
    let request = UnwrapRequest {
        most_pieces: Some(12),
        ..everything()
    };
    let mut last = 0.0;
    let mut heard = |share: f64| {
        assert!((last..=1.0).contains(&share), "{share} after {last}");
        last = share;
    };
    let first = unwrap(&ball, &[], &request, &mut heard).unwrap();
    assert_eq!(last, 1.0);
    assert_eq!(first, pieces(&ball, &request));
}

#[test]
fn what_cannot_be_cut_is_refused_in_a_sentence() {
    let cube = Mesh::cuboid([100.0, 60.0, 40.0]);
    let refused = |mesh: &Mesh, materials: &[usize], request: UnwrapRequest| {
        unwrap(mesh, materials, &request, &mut |_| ()).unwrap_err()
    };
    assert_eq!(refused(&cube, &[7], everything()), UnwrapError::NoPaint);
    for value in [1.0, f64::NAN, -3.0, f64::INFINITY] {
        let by_mean = UnwrapRequest {
            mean_stretch: value,
            ..everything()
        };
        assert!(refused(&cube, &[], by_mean).to_string().contains("cannot be asked for"));
    }
    for value in [0.0, f64::NAN, 0.5] {
        let small = UnwrapRequest {
            fits_mm: Some([value, 100.0]),
            ..everything()
        };
        assert!(matches!(refused(&cube, &[], small), UnwrapError::BadSize { .. }));
    }
    let tiny = UnwrapRequest {
        fits_mm: Some([1.5, 1.5]),
        ..everything()
    };
    assert!(matches!(
        refused(&Mesh::cuboid([1000.0, 600.0, 400.0]), &[], tiny),
        UnwrapError::BadSize { .. }
    ));
    let many = grid(320, 320, |i, j| [i as f64, j as f64, 0.0]);
    assert_eq!(
        refused(&mesh(&many), &[], everything()),
        UnwrapError::TooManyTriangles { count: 204_800 }
    );
    let shallow: Triangles = vec![[[0.0; 3], [50.0, 0.0, 0.0], [100.0, 0.0, 0.0]]];
    assert_eq!(refused(&mesh(&shallow), &[], everything()), UnwrapError::NoPaint);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Whatever triangles there are: bumpy sheets with holes, flipped faces and stray triangles.
    #[test]
    fn any_triangles_become_pieces_that_are_true(
        heights in prop::collection::vec(-12.0..12.0f64, 49),
        missing in prop::collection::vec(0..72usize, 0..20),
        turned in prop::collection::vec(0..72usize, 0..10),
        stray in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-30.0..90.0f64)), 0..6),
        hidden_too in any::<bool>(),
        fits in prop::option::of(30.0..200.0f64),
    ) {
        let mut triangles = grid(6, 6, |i, j| [10.0 * i as f64, 10.0 * j as f64, heights[7 * i + j]]);
        turned.iter().for_each(|t| triangles[*t].swap(0, 2));
        let mut n = 0..;
        triangles.retain(|_| !missing.contains(&n.next().unwrap()));
        triangles.extend(stray);
        let request = UnwrapRequest { hidden_too, fits_mm: fits.map(|mm| [mm, 30.0 + 0.5 * mm]), ..UnwrapRequest::default() };
        pieces(&mesh(&triangles), &request);
    }
}

fn assert_car(name: &str, mesh: &Mesh, paint: &str, most: usize) {
    let paint = mesh.materials_named(&[paint.to_owned()]).unwrap();
    for (paper, size) in [("A3", A3), ("A4", A4)] {
        let request = UnwrapRequest {
            most_pieces: Some(most),
            fits_mm: Some(size),
            ..UnwrapRequest::default()
        };
        let start = std::time::Instant::now();
        let unwrapped = unwrap(mesh, &paint, &request, &mut |_| ()).unwrap();
        let seconds = start.elapsed().as_secs_f64();
        assert_true(mesh, &paint, &request, &unwrapped);
        let covered: f64 = unwrapped.charts.iter().map(|c| c.surface_mm2).sum();
        let cut: f64 = unwrapped.charts.iter().map(outline_mm).sum();
        println!(
            "{name} on {paper}: {} pieces, {:.2} % of {:.0} mm², stretch {:.4} (99 %: {:.3}, largest {:.2}), outlines {:.1} m, {seconds:.1} s",
            unwrapped.charts.len(),
            100.0 * covered / unwrapped.visible_mm2,
            unwrapped.visible_mm2,
            unwrapped.mean_stretch,
            unwrapped.stretch_99,
            unwrapped.largest_stretch,
            cut / 1000.0
        );
        for left_out in &unwrapped.left_out {
            println!("  left out: {:?}, {:.0} mm²", left_out.reason, left_out.surface_mm2);
        }
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_skyline_takes_24_pieces() {
    let file = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let placement = MeshPlacement {
        length_mm: Some(455.0),
        ..MeshPlacement::default()
    };
    assert_car("skyline", &Mesh::load(&file, &placement).unwrap(), "Material.001", 24);
}

/// The e-tron with the faces of its list as a material of their own.
fn etron(folder: &Path, file: &Path, list: &Path) -> Mesh {
    let paint = std::fs::read_to_string(list).unwrap();
    let paint: std::collections::BTreeSet<usize> = paint.split_whitespace().map(|n| n.parse().unwrap()).collect();
    let (mut text, mut n) = (String::new(), 0);
    for line in std::fs::read_to_string(file).unwrap().lines() {
        if line.starts_with("v ") {
            writeln!(text, "{line}").unwrap();
        } else if let Some(corners) = line.strip_prefix("f ") {
            let corners = corners.split_whitespace().map(|c| c.split('/').next().unwrap());
            let material = if paint.contains(&n) { "paint" } else { "rest" };
            writeln!(text, "usemtl {material}\nf {}", corners.collect::<Vec<_>>().join(" ")).unwrap();
            n += 1;
        }
    }
    let path = folder.join("etron.obj");
    std::fs::write(&path, text).unwrap();
    let placement = MeshPlacement {
        length_mm: Some(490.0),
        ..MeshPlacement::default()
    };
    Mesh::load(&path, &placement).unwrap()
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_etron_takes_36_pieces() {
    let [file, list] =
        ["model_save.obj", "exterior_face.txt"].map(|name| shared(&format!("meshes/rauca_etron/{name}")));
    let folder = tempfile::tempdir().unwrap();
    assert_car("e-tron", &etron(folder.path(), &file, &list), "paint", 36);
}
