//! Exact box around the visible part of a surface: edges are distorted by the lens and clipped to the photo's border.
//!
//! The box of the surface's part in the photo ends either on an edge of the surface or in a corner of the photo that the surface covers, so only
//! edges and corners are tested.

use std::borrow::Cow;

use nalgebra::{Point3, Vector3};

use super::cone::part_inside;
use super::error::NoTruth;
use scaleproof_core::geometry::BoxPx;
use scaleproof_pose::camera::Camera;

/// Distance from the centre of a pixel to its corner.
const HALF_PX: f64 = 0.5;
/// Maximum distance between a chord and its distorted edge, px.
const CHORD_ERROR_PX: f64 = 0.01;
/// Length above which chords are halved without a test of their error.
const CHORD_PX: f64 = 64.0;
/// Maximum number of halvings: 64 px times 2^20 is beyond every photo.
const HALVINGS: u32 = 20;

/// Surface in the camera frame, mm: points, and the edges and triangles between them.
pub(super) struct Pieces<'a> {
    pub points: Vec<Point3<f64>>,
    pub edges: Cow<'a, [[usize; 2]]>,
    pub triangles: Cow<'a, [[usize; 3]]>,
}

/// Returns the box around the part of the surface that is in the photo.
pub(super) fn box_of(pieces: &Pieces, camera: &Camera) -> Result<BoxPx, NoTruth> {
    let mut view = VisibleBox::new(camera);
    let pixels: Vec<_> = pieces.points.iter().map(|p| view.pixel(p)).collect();
    pixels.iter().flatten().for_each(|pixel| view.add(*pixel));
    for [a, b] in pieces.edges.iter() {
        match (pixels[*a], pixels[*b]) {
            (Some(p), Some(q)) => {
                let [from, to] = [*a, *b].map(|i| at_depth_1(&pieces.points[i]));
                view.bent((from, p), (to, q), 0);
            }
            _ => view.cut_edge(&pieces.points[*a], &pieces.points[*b]),
        }
    }
    if view.is_cut_by_lens && !view.lens_reaches_beyond_the_photo() {
        return Err(NoTruth::BeyondCamera);
    }
    if view.is_cut || view.found.is_none() {
        view.add_covered_corners(pieces);
    }
    view.found.filter(BoxPx::is_solid).ok_or(NoTruth::OutOfPhoto)
}

fn at_depth_1(p: &Point3<f64>) -> [f64; 2] {
    [p.x / p.z, p.y / p.z]
}

/// Box found in a photo so far.
struct VisibleBox<'a> {
    camera: &'a Camera,
    photo: BoxPx,
    /// Largest distance from the axis, at depth 1, that projects.
    radius: f64,
    found: Option<BoxPx>,
    /// True if part of the surface is outside the photo.
    is_cut: bool,
    /// True if part of the surface is beyond the lens model's range.
    is_cut_by_lens: bool,
}

impl<'a> VisibleBox<'a> {
    fn new(camera: &'a Camera) -> Self {
        Self {
            camera,
            photo: BoxPx::new(0.0, 0.0, f64::from(camera.width), f64::from(camera.height)),
            // Slightly inside, so that rounding leaves nothing outside.
            radius: camera.widest_radius() * (1.0 - 1e-9),
            found: None,
            is_cut: false,
            is_cut_by_lens: false,
        }
    }

    /// Adds a point on the surface; a point outside the photo only marks the surface as cut.
    fn add(&mut self, [x, y]: [f64; 2]) {
        if self.is_outside([x, y]) {
            self.is_cut = true;
            return;
        }
        let b = self.found.unwrap_or(BoxPx::new(x, y, x, y));
        self.found = Some(BoxPx::new(b.x1.min(x), b.y1.min(y), b.x2.max(x), b.y2.max(y)));
    }

    fn is_outside(&self, [x, y]: [f64; 2]) -> bool {
        let p = &self.photo;
        x < p.x1 || x > p.x2 || y < p.y1 || y > p.y2
    }

    /// Adds an edge with an end that cannot be projected.
    fn cut_edge(&mut self, a: &Point3<f64>, b: &Point3<f64>) {
        (self.is_cut, self.is_cut_by_lens) = (true, true);
        let Some([from, to]) = part_inside(a, b, self.radius) else {
            return;
        };
        if let (Some(p), Some(q)) = (self.lensed(from), self.lensed(to)) {
            self.bent((from, p), (to, q), 0);
        }
    }

    /// Projects a point of the camera frame to the photo, counted as boxes are: from the photo's corner, not from the centre of its first pixel.
    fn pixel(&self, p: &Point3<f64>) -> Option<[f64; 2]> {
        self.camera.project(p).map(|pixel| pixel.map(|c| c + HALF_PX))
    }

    /// Projects a point (x, y) of the camera frame at depth 1 to the photo, counted from the photo's corner.
    fn lensed(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        self.pixel(&Point3::new(x, y, 1.0))
    }

    /// Adds an edge between two points at depth 1 with their pixels: straight before the lens, curved after it.
    fn bent(&mut self, a: ([f64; 2], [f64; 2]), b: ([f64; 2], [f64; 2]), halvings: u32) {
        let ((from, p), (to, q)) = (a, b);
        let chord = (q[0] - p[0]).hypot(q[1] - p[1]);
        if self.adds_nothing(p, q, chord) {
            return;
        }
        let middle = [0, 1].map(|i| (from[i] + to[i]) / 2.0);
        let Some(m) = self.lensed(middle) else { return };
        let off = ((q[0] - p[0]) * (m[1] - p[1]) - (q[1] - p[1]) * (m[0] - p[0])).abs();
        if halvings >= HALVINGS || chord <= CHORD_PX && off <= CHORD_ERROR_PX * chord {
            return self.straight(p, q);
        }
        self.bent(a, (middle, m), halvings + 1);
        self.bent((middle, m), b, halvings + 1);
    }

    /// Returns true if all of the edge is in the box already or beyond one side of the photo: a curved edge deviates from its chord by less than half
    /// the chord, as a semicircle does.
    fn adds_nothing(&self, p: [f64; 2], q: [f64; 2], chord: f64) -> bool {
        let (bend, photo) = (chord / 2.0, &self.photo);
        let lies = |x1: f64, y1: f64, x2: f64, y2: f64| {
            [p, q].iter().all(|[x, y]| *x >= x1 && *x <= x2 && *y >= y1 && *y <= y2)
        };
        let far = f64::INFINITY;
        self.found
            .is_some_and(|b| lies(b.x1 + bend, b.y1 + bend, b.x2 - bend, b.y2 - bend))
            || lies(-far, -far, photo.x1 - bend, far)
            || lies(photo.x2 + bend, -far, far, far)
            || lies(-far, -far, far, photo.y1 - bend)
            || lies(-far, photo.y2 + bend, far, far)
    }

    /// Adds the part of a chord inside the photo (Liang and Barsky 1984).
    fn straight(&mut self, p: [f64; 2], q: [f64; 2]) {
        let (photo, d) = (self.photo, [q[0] - p[0], q[1] - p[1]]);
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (step, room) in [
            (-d[0], p[0] - photo.x1),
            (d[0], photo.x2 - p[0]),
            (-d[1], p[1] - photo.y1),
            (d[1], photo.y2 - p[1]),
        ] {
            if step == 0.0 && room < 0.0 {
                return;
            }
            if step < 0.0 {
                first = first.max(room / step);
            } else if step > 0.0 {
                last = last.min(room / step);
            }
        }
        if first <= last {
            for t in [first, last] {
                // Rounding must not leave it outside.
                let x = (p[0] + t * d[0]).clamp(photo.x1, photo.x2);
                let y = (p[1] + t * d[1]).clamp(photo.y1, photo.y2);
                self.add([x, y]);
            }
        }
    }

    /// Returns true if everything beyond the lens model's range is outside the photo.
    fn lens_reaches_beyond_the_photo(&self) -> bool {
        const DIRECTIONS: u32 = 256;
        (0..DIRECTIONS).all(|i| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(DIRECTIONS)).sin_cos();
            let edge = self.lensed([self.radius * cos, self.radius * sin]);
            edge.is_some_and(|edge| self.is_outside(edge))
        })
    }

    /// Adds the photo's corners that the surface covers. A corner beyond the lens model's range is not covered, or the surface would have been cut by
    /// the lens.
    fn add_covered_corners(&mut self, pieces: &Pieces) {
        let p = self.photo;
        for corner in [[p.x1, p.y1], [p.x2, p.y1], [p.x2, p.y2], [p.x1, p.y2]] {
            let Some([x, y]) = self.camera.point_at(corner.map(|c| c - HALF_PX)) else {
                continue;
            };
            let ray = Vector3::new(x, y, 1.0);
            let covers = |t: &[usize; 3]| is_hit(&ray, t.map(|i| pieces.points[i].coords));
            if pieces.triangles.iter().any(covers) {
                self.add(corner);
            }
        }
    }
}

/// Returns true if a ray from the camera hits a triangle in front of it.
fn is_hit(ray: &Vector3<f64>, [a, b, c]: [Vector3<f64>; 3]) -> bool {
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| ray.dot(&p.cross(&q)));
    let normal = (b - a).cross(&(c - a));
    let is_within = sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0);
    is_within && a.dot(&normal) / ray.dot(&normal) > 0.0
}
