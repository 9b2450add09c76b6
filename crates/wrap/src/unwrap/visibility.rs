//! Visibility of the paint from outside, and of either side: z-buffers of the whole mesh from around and above.

use nalgebra::{Point3, Vector3};

use super::surface::{Neighbours, Surface};
use scaleproof_core::geometry::{self, PlaneTriangle, Point2, extent, view_axes};
use scaleproof_surface::mesh::{Mesh, doubled_area};
use scaleproof_surface::zbuffer::ZBuffer;

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

/// Orthographic view of the whole mesh.
struct View {
    /// Axes to the right, up and towards the viewer, in pixels.
    axes: [Vector3<f64>; 3],
    origin: Point2,
    size: [usize; 2],
    nearest: ZBuffer<()>,
}

/// Triangle in a view: its corners in pixels, and how far each is towards the viewer.
struct Projected {
    corners: [Point2; 3],
    doubled_area: f64,
    towards: [f64; 3],
}

impl Projected {
    /// Returns true if the view is along the triangle's plane, so that it covers no pixel.
    fn is_edge_on(&self) -> bool {
        self.doubled_area.abs() < 1e-9
    }

    /// Returns the distance from the viewer at a point by its barycentric coordinates; its origin is arbitrary.
    fn depth(&self, shares: [f64; 3]) -> f64 {
        -(0..3).map(|i| shares[i] * self.towards[i]).sum::<f64>()
    }
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
            nearest: ZBuffer::new(0..size[0] as i64, 0..size[1] as i64, 0.0),
        }
    }

    fn project(&self, corners: &[Point3<f64>; 3]) -> Projected {
        let along = |axis: usize, p: &Point3<f64>| self.axes[axis].dot(&p.coords);
        let flat = corners.map(|p| [0, 1].map(|axis| along(axis, &p) - self.origin[axis]));
        Projected {
            doubled_area: geometry::doubled_area(flat[0], flat[1], flat[2]),
            corners: flat,
            towards: corners.map(|p| along(2, &p)),
        }
    }

    fn draw(&mut self, corners: &[Point3<f64>; 3]) {
        let triangle = self.project(corners);
        if !triangle.is_edge_on() {
            self.nearest
                .draw(triangle.corners, |shares| triangle.depth(shares), |_| ());
        }
    }

    /// Adds to a face's visibility the pixels of this view that show it.
    fn look(&self, corners: &[Point3<f64>; 3], seen: &mut Seen) {
        let normal = doubled_area(corners);
        let is_grazed = normal.dot(&self.axes[2]).abs() < LEAST_COSINE * normal.norm() * self.axes[2].norm();
        let triangle = self.project(corners);
        let Some(flat) = PlaneTriangle::new(triangle.corners).filter(|_| !triangle.is_edge_on()) else {
            return;
        };
        let (mut covered, mut shown) = (0_u32, 0_u32);
        flat.draw(self.size, 0.0, |column, row, shares| {
            covered += 1;
            let nearest = self.nearest.at(column as i64, row as i64);
            let is_nearest = nearest.is_some_and(|nearest| triangle.depth(shares) <= nearest.depth + SAME_DEPTH);
            shown += u32::from(!is_grazed && is_nearest);
        });
        if covered > 0 {
            let share = f64::from(shown) / f64::from(covered);
            seen.share = Some(seen.share.map_or(share, |most| most.max(share)));
            seen.front_px += i64::from(shown) * if triangle.doubled_area > 0.0 { 1 } else { -1 };
        }
    }
}
