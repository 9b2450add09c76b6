//! Piece in its plane: outline, border edges, folds, and its orientation on the model.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use crate::unwrap::{Chart, Unwrapped};
use scaleproof_core::geometry::{Point2, convex_hull, distance, extent};
use scaleproof_print::raster::FlatTriangle;
use scaleproof_print::sheet::sides;
use scaleproof_print::wrap::Region;
use scaleproof_surface::mesh::doubled_area;

/// Bend of an edge above which it is drawn.
const FOLD_DEG: f64 = 30.0;
/// Distance on paper below which corners are the same.
const SAME_MM: f64 = 1e-6;

/// Edge of the piece's border.
#[derive(Debug, Clone, Copy)]
pub struct Border {
    /// Indices of its ends among the points of all pieces, ascending.
    pub ends: [usize; 2],
    /// Its ends on paper, mm.
    pub flat: [Point2; 2],
    /// Unit vector on paper, away from the piece.
    pub outward: Point2,
}

#[derive(Debug, Clone)]
pub struct Piece {
    pub triangles: Vec<FlatTriangle>,
    /// Corners of the triangles in space, model frame, mm.
    pub corners: Vec<[Point3<f64>; 3]>,
    pub region: Region,
    pub borders: Vec<Border>,
    /// Edges within the piece at which the model bends.
    pub folds: Vec<[Point2; 2]>,
    pub surface_mm2: f64,
    /// Mean normal; `middle` is the centre, both in the model frame.
    pub normal: Vector3<f64>,
    pub middle: Point3<f64>,
    /// Unit vector on paper that points up on the model, or to its front if the piece faces up.
    pub up: Point2,
}

impl Piece {
    pub fn all(flat: &Unwrapped) -> Vec<Self> {
        let charts = flat.charts.iter();
        charts.map(|chart| Self::new(chart, &flat.points_mm)).collect()
    }

    fn new(chart: &Chart, points: &[Point3<f64>]) -> Self {
        let turn = along_x(chart);
        let turned = |p: Point2| [turn[0] * p[0] + turn[1] * p[1], turn[0] * p[1] - turn[1] * p[0]];
        let corners: Vec<_> = chart.faces.iter().map(|f| f.corners.map(|c| points[c])).collect();
        let flat = chart.faces.iter().map(|face| FlatTriangle {
            flat_mm: face.flat_mm.map(turned),
            height_mm: [0.0; 3],
            triangle: face.triangle,
            weights: face.weights,
        });
        let triangles: Vec<_> = flat.collect();
        let (borders, folds) = edges(chart, &corners, &triangles);
        let (normal, middle) = means(&corners);
        Self {
            region: Region::union(triangles.iter().map(|t| t.flat_mm.to_vec()).collect()),
            up: up(&corners, &triangles, &normal),
            surface_mm2: chart.surface_mm2,
            triangles,
            corners,
            borders,
            folds,
            normal,
            middle,
        }
    }
}

/// Returns the direction of the narrowest bounding box's long side: one of the box's sides lies on an edge of the convex hull.
fn along_x(chart: &Chart) -> Point2 {
    let hull = convex_hull(chart.faces.iter().flat_map(|f| f.flat_mm).collect());
    let mut best = (f64::INFINITY, [1.0, 0.0]);
    for (a, b) in sides(&hull) {
        let length = distance(*a, *b);
        if length < SAME_MM {
            continue;
        }
        let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let across = [-along[1], along[0]];
        let [wide, high] = [along, across].map(|axis| {
            let (low, high) = extent(hull.iter().map(|p| p[0] * axis[0] + p[1] * axis[1]));
            high - low
        });
        if wide * high < best.0 {
            best = (wide * high, if wide >= high { along } else { across });
        }
    }
    best.1
}

/// Returns the borders, and the inner edges that are bent.
fn edges(chart: &Chart, corners: &[[Point3<f64>; 3]], triangles: &[FlatTriangle]) -> (Vec<Border>, Vec<[Point2; 2]>) {
    // For each edge, its sides: the face, and the ends on paper in the order of the edge's key.
    let mut sides = BTreeMap::<[usize; 2], Vec<(usize, [Point2; 2])>>::new();
    for (f, face) in chart.faces.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (face.corners[i], face.corners[(i + 1) % 3]);
            let (p, q) = (triangles[f].flat_mm[i], triangles[f].flat_mm[(i + 1) % 3]);
            let (key, flat) = if a < b { ([a, b], [p, q]) } else { ([b, a], [q, p]) };
            sides.entry(key).or_default().push((f, flat));
        }
    }
    let (mut borders, mut folds) = (Vec::new(), Vec::new());
    for (ends, mut here) in sides {
        while let Some((face, flat)) = here.pop() {
            let is_same = |other: &[Point2; 2]| flat.iter().zip(other).all(|(p, q)| near(*p, *q));
            let beside = here.iter().position(|(_, other)| is_same(other));
            match beside.map(|i| here.swap_remove(i)) {
                Some((other, _)) => {
                    let bend = doubled_area(&corners[face]).angle(&doubled_area(&corners[other]));
                    if bend.to_degrees() > FOLD_DEG {
                        folds.push(flat);
                    }
                }
                None => borders.push(Border {
                    ends,
                    flat,
                    outward: outward(&flat, &triangles[face].flat_mm),
                }),
            }
        }
    }
    (borders, folds)
}

/// Returns true if two points on paper coincide.
pub fn near(p: Point2, q: Point2) -> bool {
    distance(p, q) < SAME_MM
}

fn outward([a, b]: &[Point2; 2], face: &[Point2; 3]) -> Point2 {
    let length = distance(*a, *b).max(f64::MIN_POSITIVE);
    let normal = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
    let middle = [0, 1].map(|axis| face.iter().map(|p| p[axis]).sum::<f64>() / 3.0 - a[axis]);
    let is_inward = normal[0] * middle[0] + normal[1] * middle[1] > 0.0;
    normal.map(|v| if is_inward { -v } else { v })
}

fn means(corners: &[[Point3<f64>; 3]]) -> (Vector3<f64>, Point3<f64>) {
    let (mut normal, mut middle, mut area) = (Vector3::zeros(), Vector3::zeros(), 0.0);
    for corners in corners {
        let doubled = doubled_area(corners);
        normal += doubled;
        let share = doubled.norm();
        middle += share / 3.0 * (corners[0].coords + corners[1].coords + corners[2].coords);
        area += share;
    }
    let normal = normal.try_normalize(1e-12).unwrap_or_else(Vector3::z);
    (normal, Point3::from(middle / f64::max(area, f64::MIN_POSITIVE)))
}

/// Returns the mean gradient over the piece, on paper, of the height (or of the forward direction).
fn up(corners: &[[Point3<f64>; 3]], triangles: &[FlatTriangle], normal: &Vector3<f64>) -> Point2 {
    let to = if normal.z.abs() > 0.7 {
        Vector3::x()
    } else {
        Vector3::z()
    };
    let mut sum = [0.0; 2];
    for (corners, flat) in corners.iter().zip(triangles) {
        let [a, b, c] = flat.flat_mm;
        let [ha, hb, hc] = corners.map(|p| p.coords.dot(&to));
        // Twice the area times the gradient of a linear function on the triangle.
        sum[0] += (hb - ha) * (c[1] - a[1]) - (hc - ha) * (b[1] - a[1]);
        sum[1] += (hc - ha) * (b[0] - a[0]) - (hb - ha) * (c[0] - a[0]);
    }
    let length = sum[0].hypot(sum[1]);
    if length > 0.0 {
        sum.map(|v| v / length)
    } else {
        [0.0, 1.0]
    }
}
