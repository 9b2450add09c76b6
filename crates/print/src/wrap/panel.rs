//! Division of a model's surface into the sides it faces: the content of each panel, and the errors of the projection.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;

use super::region::Region;
use crate::buckets::{Buckets, bounds};
use scaleproof_core::geometry;
use scaleproof_core::geometry::Point2;
use scaleproof_surface::mesh::{Mesh, Triangle, doubled_area};
use scaleproof_surface::pattern::world_aligned::Side;

pub const PRINTED: [Side; 5] = [Side::Left, Side::Right, Side::Roof, Side::Front, Side::Rear];

/// Bend of an edge above which it is drawn.
const FEATURE_DEG: f64 = 30.0;
/// Distance by which an outer surface hides one behind it, mm.
const BEFORE_MM: f64 = 0.3;

#[derive(Debug, Clone)]
pub struct Panel {
    pub side: Side,
    /// Union of all painted triangles of this side in its plane (u, v), mm; see [`Side`].
    pub region: Region,
    /// Visible edges inside the region that are bent or border another material: (u, v), mm.
    pub edges: Vec<[Point2; 2]>,
    pub surface_mm2: f64,
    /// Area of the surface after projection into the side's plane, every layer counted.
    pub projected_mm2: f64,
    /// Largest length on the surface for 1 mm on paper.
    pub largest_stretch: f64,
}

impl Panel {
    pub fn flat_mm2(&self) -> f64 {
        self.region.area_mm2()
    }

    /// Returns the area of the layers that lie behind others in this direction, and are printed with them.
    pub fn hidden_mm2(&self) -> f64 {
        (self.projected_mm2 - self.flat_mm2()).max(0.0)
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Face {
    /// Index of the triangle in the mesh.
    pub index: usize,
    pub triangle: Triangle,
    pub corners: [Point3<f64>; 3],
    pub side: Side,
    pub surface_mm2: f64,
    /// Area on the surface per area on paper; equal to the stretch along the steepest line.
    pub stretch: f64,
}

#[derive(Debug, Clone)]
pub struct PaintedSurface {
    pub faces: Vec<Face>,
    /// Triangles of the mesh with other materials.
    others: Vec<Triangle>,
}

impl PaintedSurface {
    /// Collects the triangles of some materials, or of all if none are given; degenerate ones are left out.
    pub fn of_materials(mesh: &Mesh, materials: &[usize]) -> Self {
        let is_painted = |triangle: &Triangle| materials.is_empty() || materials.contains(&triangle.material);
        let (mut faces, mut others) = (Vec::new(), Vec::new());
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            let corners = mesh.corners_mm(triangle);
            let normal = doubled_area(&corners);
            let length = normal.norm();
            if !is_painted(triangle) {
                others.push(*triangle);
            } else if length > 0.0 {
                let side = Side::facing(&normal);
                faces.push(Face {
                    index,
                    triangle: *triangle,
                    corners,
                    side,
                    surface_mm2: 0.5 * length,
                    stretch: length / side.outward().dot(&normal),
                });
            }
        }
        Self { faces, others }
    }

    pub fn surface_mm2(&self) -> f64 {
        self.faces.iter().map(|face| face.surface_mm2).sum()
    }

    /// Returns the painted faces at each edge, by the edge's corners in ascending order.
    pub fn edges(&self) -> BTreeMap<[usize; 2], Vec<usize>> {
        let mut edges = BTreeMap::<_, Vec<usize>>::new();
        for (i, face) in self.faces.iter().enumerate() {
            for edge in face.triangle.edges() {
                edges.entry(edge).or_default().push(i);
            }
        }
        edges
    }

    /// Returns the printed panels that have a surface, in the order of [`PRINTED`].
    pub fn panels(&self) -> Vec<Panel> {
        let edges = self.edges();
        let other_edges = self.others.iter().flat_map(Triangle::edges).collect();
        let panel = |side| self.panel(side, &edges, &other_edges);
        PRINTED.into_iter().filter_map(panel).collect()
    }

    fn panel(
        &self,
        side: Side,
        edges: &BTreeMap<[usize; 2], Vec<usize>>,
        other_edges: &BTreeSet<[usize; 2]>,
    ) -> Option<Panel> {
        let faces: Vec<&Face> = self.faces.iter().filter(|face| face.side == side).collect();
        let flat = |face: &&Face| face.corners.map(|p| side.project(&p)).to_vec();
        let region = Region::union(faces.iter().map(flat).collect());
        if region.is_empty() {
            return None;
        }
        let cover = Cover::new(side, &faces);
        let seen = |(edge, meeting): (&[usize; 2], &Vec<usize>)| {
            let meeting = meeting.iter().map(|i| &self.faces[*i]);
            let ours: Vec<&Face> = meeting.filter(|f| f.side == side).collect();
            let first = ours.first()?;
            let bent = match ours[..] {
                [a, b] => bend_deg(a, b) > FEATURE_DEG,
                _ => true,
            };
            let ends = edge.map(|corner| corner_of(first, corner));
            (bent || other_edges.contains(edge)).then_some(())?;
            cover.shows_inside(&ends).then(|| ends.map(|p| side.project(&p)))
        };
        Some(Panel {
            side,
            edges: edges.iter().filter_map(seen).collect(),
            surface_mm2: faces.iter().map(|f| f.surface_mm2).sum(),
            projected_mm2: faces.iter().map(|f| f.surface_mm2 / f.stretch).sum(),
            largest_stretch: faces.iter().map(|f| f.stretch).fold(1.0, f64::max),
            region,
        })
    }
}

pub fn corner_of(face: &Face, corner: usize) -> Point3<f64> {
    let place = face.triangle.corners.iter().position(|c| *c == corner);
    face.corners[place.unwrap_or_default()]
}

/// Returns the angle between two faces' normals.
pub fn bend_deg(a: &Face, b: &Face) -> f64 {
    doubled_area(&a.corners).angle(&doubled_area(&b.corners)).to_degrees()
}

/// Faces of a side with a spatial index.
struct Cover<'a> {
    side: Side,
    faces: &'a [&'a Face],
    buckets: Buckets,
}

impl<'a> Cover<'a> {
    fn new(side: Side, faces: &'a [&'a Face]) -> Self {
        let flat: Vec<[Point2; 3]> = faces.iter().map(|f| f.corners.map(|p| side.project(&p))).collect();
        let (low, high) = bounds(flat.iter().flatten(), 0.0);
        let boxes = flat.iter().map(|corners| bounds(corners, 0.0));
        Self {
            side,
            faces,
            buckets: Buckets::new(low, high, boxes),
        }
    }

    /// Returns the height of the outermost face over a point; `None` beside all faces.
    fn outermost(&self, p: Point2) -> Option<f64> {
        let near = self.buckets.at(p)?.iter();
        let over = near.filter_map(|i| self.height(self.faces[*i as usize], p));
        over.reduce(f64::max)
    }

    fn height(&self, face: &Face, p: Point2) -> Option<f64> {
        let [a, b, c] = face.corners.map(|corner| self.side.project(&corner));
        let [whole, at_b, at_c] = [[b, c], [p, c], [b, p]].map(|[b, c]| geometry::doubled_area(a, b, c));
        let (second, third) = (at_b / whole, at_c / whole);
        let first = 1.0 - second - third;
        let inside = first >= 0.0 && second >= 0.0 && third >= 0.0;
        let [a, b, c] = face.corners.map(|corner| self.side.outward().dot(&corner.coords));
        inside.then_some(first * a + second * b + third * c)
    }

    /// Returns true if the middle of an edge is not behind other faces, and has faces on both sides.
    fn shows_inside(&self, ends: &[Point3<f64>; 2]) -> bool {
        let height = self.side.outward().dot(&nalgebra::center(&ends[0], &ends[1]).coords);
        let [a, b] = ends.map(|p| self.side.project(&p));
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        if length < 0.1 {
            return false;
        }
        let middle = [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]));
        let beside = |mm: f64| [middle[0] - mm * dy / length, middle[1] + mm * dx / length];
        [-0.2, 0.2].iter().all(|mm| {
            let over = self.outermost(beside(*mm));
            over.is_some_and(|outermost| outermost < height + BEFORE_MM)
        })
    }
}
