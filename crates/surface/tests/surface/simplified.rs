//! A finely cut ball, simplified: its shape, its halves of two materials and its texture coordinates are known.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use nalgebra::{Point2, Point3, Vector2};
use scaleproof_surface::mesh::{Mesh, MeshPlacement};

const RADIUS_MM: f64 = 50.0;

/// A ball of `around` × `around / 2` quadrilaterals, upper half `top`, lower half `bottom`; texture coordinates are its map by longitude and height.
fn ball(around: usize) -> Mesh {
    let rows = around / 2;
    let mut text = "o ball\n".to_owned();
    for row in 0..=rows {
        for column in 0..=around {
            let (longitude, height) = (column as f64 / around as f64, row as f64 / rows as f64);
            let (lon, lat) = (longitude * std::f64::consts::TAU, (height - 0.5) * std::f64::consts::PI);
            // Both ends of a row are the same point; their texture coordinates differ.
            let lon = if column == around { 0.0 } else { lon };
            let [x, y, z] = [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()].map(|c| RADIUS_MM * c);
            writeln!(text, "v {x:.9} {y:.9} {z:.9}\nvt {longitude:.9} {height:.9}").unwrap();
        }
    }
    for row in 0..rows {
        let material = if row < rows / 2 { "bottom" } else { "top" };
        writeln!(text, "usemtl {material}").unwrap();
        for column in 0..around {
            let corner = |row: usize, column: usize| row * (around + 1) + column + 1;
            let [a, b, c, d] = [
                corner(row, column),
                corner(row, column + 1),
                corner(row + 1, column + 1),
                corner(row + 1, column),
            ];
            if row > 0 {
                writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}").unwrap();
            }
            if row + 1 < rows {
                writeln!(text, "f {a}/{a} {c}/{c} {d}/{d}").unwrap();
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ball.obj");
    std::fs::write(&file, text).unwrap();
    Mesh::load(Path::new(&file), &MeshPlacement::default()).unwrap()
}

fn centre(mesh: &Mesh) -> Point3<f64> {
    let (low, high) = mesh.bounds_mm();
    nalgebra::center(&low, &high)
}

/// How far the middles of the triangles lie inside the ball at most, mm.
fn deepest_mm(mesh: &Mesh, centre: &Point3<f64>) -> f64 {
    let middle = |[a, b, c]: [Point3<f64>; 3]| Point3::from((a.coords + b.coords + c.coords) / 3.0);
    let depth = |i| RADIUS_MM - (middle(mesh.triangle_mm(i)) - centre).norm();
    (0..mesh.triangles().len()).map(depth).fold(0.0, f64::max)
}

fn area_mm2(mesh: &Mesh, material: &str) -> f64 {
    let material = mesh.materials_named(&[material.to_owned()]).unwrap();
    mesh.painted(&material).map(|i| mesh.normal_mm2(i).norm() / 2.0).sum()
}

#[test]
fn a_simplified_ball_has_its_shape_and_its_closed_surface() {
    let fine = ball(400);
    let found = fine.simplified(8_000, 0.2, false);
    let coarse = &found.mesh;
    assert!(
        coarse.triangles().len() <= 8_000,
        "{} triangles",
        coarse.triangles().len()
    );
    let deepest = deepest_mm(coarse, &centre(&fine));
    assert!(
        deepest < 0.2 && deepest < 3.0 * found.moved_mm,
        "{deepest} mm deep, said {} mm",
        found.moved_mm
    );
    for material in ["top", "bottom"] {
        let [before, after] = [&fine, coarse].map(|mesh| area_mm2(mesh, material));
        assert!(
            (after / before - 1.0).abs() < 2e-3,
            "{material}: {before} and {after} mm²"
        );
    }
    // Every edge has two triangles, in opposite senses.
    let mut senses: HashMap<[usize; 2], i32> = HashMap::new();
    for [a, b, c] in coarse.triangles().iter().map(|t| t.corners) {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            *senses.entry([p.min(q), p.max(q)]).or_default() += if p < q { 1 } else { -1 };
        }
    }
    assert!(senses.values().all(|sum| *sum == 0));
}

#[test]
fn the_surface_moves_no_further_than_is_allowed() {
    let fine = ball(200);
    let found = fine.simplified(10, 0.05, false);
    assert!(found.moved_mm <= 0.05);
    assert!(deepest_mm(&found.mesh, &centre(&fine)) < 0.15);
    assert!(found.mesh.triangles().len() > 500, "{}", found.mesh.triangles().len());
}

#[test]
fn the_border_between_two_materials_stays_where_it_is() {
    let fine = ball(200);
    let coarse = fine.simplified(3_000, 0.5, false).mesh;
    let height = centre(&fine).z;
    let top = coarse.materials_named(&["top".to_owned()]).unwrap();
    for i in coarse.painted(&top) {
        assert!(coarse.triangle_mm(i).iter().all(|p| p.z > height - 1e-6));
    }
}

#[test]
fn a_texture_stays_where_it_was() {
    let fine = ball(400);
    let coarse = fine.simplified(8_000, 0.2, true).mesh;
    let centre = centre(&fine);
    for i in 0..coarse.triangles().len() {
        let places = coarse.coordinates(i).unwrap().map(Point2::from);
        for (place, corner) in places.iter().zip(coarse.triangle_mm(i)) {
            let at = corner - centre;
            let latitude = (at.z / RADIUS_MM).clamp(-1.0, 1.0).asin();
            assert!((latitude / std::f64::consts::PI + 0.5 - place.y).abs() < 1e-6);
        }
        // None spans the seam, where the map begins again.
        let wide = |p: Point2<f64>, q: Point2<f64>| Vector2::from(p - q).x.abs();
        assert!(wide(places[0], places[1]).max(wide(places[1], places[2])) < 0.5);
    }
}
