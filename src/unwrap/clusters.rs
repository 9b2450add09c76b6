//! First clusters: faces beside each other whose normals are almost those of the first.

use nalgebra::{Point3, Vector3};

use super::UnwrapRequest;
use super::surface::Surface;
use super::topology::Topology;
use crate::mesh::doubled_area;

/// A face at this angle is shown 1.02 times too short.
const CONE_DEG: f64 = 11.0;

/// Every face is in one.
pub(super) fn grow(surface: &Surface, topology: &Topology, request: &UnwrapRequest) -> Vec<Vec<usize>> {
    let normals: Vec<Vector3<f64>> = (0..surface.faces.len())
        .map(|f| doubled_area(&surface.corners(f)).normalize())
        .collect();
    let least = CONE_DEG.to_radians().cos();
    // In whatever way such a piece is turned, it fits.
    let widest = request.fits_mm.map_or(f64::INFINITY, |[a, b]| 0.5 * a.min(b));
    let (mut is_taken, mut clusters) = (vec![false; normals.len()], Vec::new());
    for seed in 0..normals.len() {
        if is_taken[seed] {
            continue;
        }
        is_taken[seed] = true;
        let (mut cluster, mut next) = (vec![seed], 0);
        let centre = surface.corners(seed)[0];
        while let Some(face) = cluster.get(next).copied() {
            next += 1;
            for neighbour in topology.across[face].into_iter().flatten() {
                let near = |p: &Point3<f64>| (p - centre).norm() <= widest;
                if !is_taken[neighbour]
                    && normals[neighbour].dot(&normals[seed]) >= least
                    && surface.corners(neighbour).iter().all(near)
                {
                    is_taken[neighbour] = true;
                    cluster.push(neighbour);
                }
            }
        }
        clusters.push(cluster);
    }
    clusters
}
