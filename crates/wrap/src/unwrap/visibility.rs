//! Visibility of the paint from outside, and of either side: z-buffers of the whole mesh from around and above.

use nalgebra::{Point3, Vector3};

use super::surface::{Neighbours, Surface};
use scaleproof_core::geometry::{self, extent, view_axes};
use scaleproof_surface::mesh::{Mesh, doubled_area};

/// Elevations of the views and their number around at each. A person looks at a model on a table slightly from below, too.
const VIEWS: [(f64, usize); 5] = [(-10.0, 12), (10.0, 12), (32.0, 12), (58.0, 8), (90.0, 1)];
/// Number of pixels along the mesh's longest side.
const PIXELS: f64 = 700.0;
/// Share of a face that one view must show; otherwise the face is hidden.
const LEAST_SHARE: f64 = 0.15;
/// Share from which a face between visible ones is visible, so that borders are smooth.
const LEAST_BETWEEN: f64 = 0.02;
/// Minimum cosine of the angle between a face's normal and a view that shows it; excludes a floor seen from just below.
const LEAST_COSINE: f64 = 0.2;
/// Depth difference within which surfaces count as one, in pixels.
const SAME_DEPTH: f64 = 0.02;

/// Visibility of a face.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Seen {
    /// Largest share of it shown in one view; `None` if it is too small for all of them.
    share: Option<f64>,
    /// Number of pixels in all views that show its front, by its winding, less those that show its back.
    pub front_px: i64,
}

/// Renders all views and measures the visibility of each face.
pub(super) fn seen(mesh: &Mesh, surface: &Surface) -> Vec<Seen> {
    let mut seen = vec![Seen::default(); surface.faces.len()];
    let (low, high) = mesh.bounds_mm();
    let pixel = (high - low).amax() / PIXELS;
    for (elevation, around) in VIEWS {
        for i in 0..around {
            let azimuth = 360.0 * i as f64 / around as f64;
            let mut view = View::new(&[low, high], azimuth, elevation, pixel);
            for triangle in mesh.triangles() {
                view.draw(&mesh.corners_mm(triangle));
            }
            for (face, seen) in seen.iter_mut().enumerate() {
                view.look(&surface.corners(face), seen);
            }
        }
    }
    seen
}

/// Returns, for each face, true if it is visible. A face that is too small for all views is.
pub(super) fn visible(seen: &[Seen], beside: &Neighbours) -> Vec<bool> {
    let shows = |f: usize, least: f64| seen[f].share.is_none_or(|share| share >= least);
    let is_shown: Vec<bool> = (0..seen.len()).map(|f| shows(f, LEAST_SHARE)).collect();
    let is_between = |f: usize| beside[f].iter().flatten().filter(|(g, _)| is_shown[*g]).count() >= 2;
    let is_visible = |f: usize| is_shown[f] || (shows(f, LEAST_BETWEEN) && is_between(f));
    (0..seen.len()).map(is_visible).collect()
}

/// Orthographic view: the depth of the nearest surface at each pixel.
struct View {
    /// Axes to the right, up and towards the viewer, in pixels.
    axes: [Vector3<f64>; 3],
    origin: [f64; 2],
    size: [usize; 2],
    nearest: Vec<f64>,
}

impl View {
    fn new(bounds: &[Point3<f64>; 2], azimuth_deg: f64, elevation_deg: f64, pixel: f64) -> Self {
        let axes = view_axes(azimuth_deg, elevation_deg).map(|a| a / pixel);
        let corner = |i: usize| Point3::from([0, 1, 2].map(|k| bounds[i >> k & 1][k]));
        let [x, y] = [0, 1].map(|a: usize| extent((0..8).map(|i| axes[a].dot(&corner(i).coords))));
        let size = [x, y].map(|(low, high)| (high - low).ceil() as usize + 2);
        Self {
            axes,
            // Off the pixels' centres, which would otherwise coincide with the edges of a box.
            origin: [x.0 - 0.63, y.0 - 0.59],
            size,
            nearest: vec![f64::NEG_INFINITY; size[0] * size[1]],
        }
    }

    fn project(&self, p: &Point3<f64>) -> [f64; 3] {
        let [x, y, z] = [0, 1, 2].map(|a| self.axes[a].dot(&p.coords));
        [x - self.origin[0], y - self.origin[1], z]
    }

    fn draw(&mut self, corners: &[Point3<f64>; 3]) {
        let corners = corners.map(|p| self.project(&p));
        let nearest = &mut self.nearest;
        pixels(&corners, self.size, |at, depth| nearest[at] = nearest[at].max(depth));
    }

    fn look(&self, corners: &[Point3<f64>; 3], seen: &mut Seen) {
        let normal = doubled_area(corners);
        let is_grazed = normal.dot(&self.axes[2]).abs() < LEAST_COSINE * normal.norm() * self.axes[2].norm();
        let corners = corners.map(|p| self.project(&p));
        let (mut covered, mut shown) = (0_u32, 0_u32);
        pixels(&corners, self.size, |at, depth| {
            covered += 1;
            shown += u32::from(!is_grazed && depth >= self.nearest[at] - SAME_DEPTH);
        });
        if covered > 0 {
            let share = f64::from(shown) / f64::from(covered);
            seen.share = Some(seen.share.map_or(share, |most| most.max(share)));
            seen.front_px += i64::from(shown) * if doubled(&corners) > 0.0 { 1 } else { -1 };
        }
    }
}

fn doubled(corners: &[[f64; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|[x, y, _]| [x, y]);
    geometry::doubled_area(a, b, c)
}

/// Calls `each` with the index and the depth at each pixel whose centre the triangle covers.
fn pixels(corners: &[[f64; 3]; 3], size: [usize; 2], mut each: impl FnMut(usize, f64)) {
    let area = doubled(corners);
    if area.abs() < 1e-9 {
        return;
    }
    let [a, b, c] = corners;
    // Depth is a linear function of the pixel.
    let slope = |j: usize| ((b[2] - a[2]) * (c[j] - a[j]) - (c[2] - a[2]) * (b[j] - a[j])) / area;
    let (by_x, by_y) = (slope(1), -slope(0));
    let (lowest, highest) = extent([a[1], b[1], c[1]]);
    let mut y = lowest.ceil().max(0.0) as usize;
    while y < size[1] && y as f64 <= highest.floor() {
        let at = y as f64;
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if (p[1] - at) * (q[1] - at) > 0.0 {
                continue;
            }
            let share = if p[1] == q[1] { 0.0 } else { (at - p[1]) / (q[1] - p[1]) };
            let x = p[0] + share * (q[0] - p[0]);
            (from, to) = (from.min(x), to.max(x));
        }
        let mut x = from.ceil().max(0.0) as usize;
        while x < size[0] && x as f64 <= to {
            each(y * size[0] + x, a[2] + by_x * (x as f64 - a[0]) + by_y * (at - a[1]));
            x += 1;
        }
        y += 1;
    }
}
