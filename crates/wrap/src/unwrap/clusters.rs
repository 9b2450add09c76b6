//! Initial clusters: adjacent faces whose normals are close to the first one's, without creases between them.

use nalgebra::{Point3, Vector3};

use super::surface::{Neighbours, Surface};
use scaleproof_surface::mesh::doubled_area;

/// Maximum angle to the first face's normal: projection shortens such a face by 1.02.
const CONE_DEG: f64 = 11.0;

/// Returns the clusters; every face is in one.
pub(super) fn grow(surface: &Surface, across: &Neighbours, fits_mm: Option<[f64; 2]>) -> Vec<Vec<usize>> {
    let normals: Vec<Vector3<f64>> = (0..surface.faces.len())
        .map(|f| doubled_area(&surface.corners(f)).normalize())
        .collect();
    let least = CONE_DEG.to_radians().cos();
    // A piece of this size fits in any rotation.
    let widest = fits_mm.map_or(f64::INFINITY, |[a, b]| 0.5 * a.min(b));
    let (mut is_taken, mut clusters) = (vec![false; normals.len()], Vec::new());
    let mut seeds: Vec<usize> = (0..normals.len()).collect();
    seeds.sort_by(|a, b| surface.area(*b).total_cmp(&surface.area(*a)));
    for seed in seeds {
        if is_taken[seed] {
            continue;
        }
        is_taken[seed] = true;
        let (mut cluster, mut next) = (vec![seed], 0);
        let centre = surface.corners(seed)[0];
        while let Some(face) = cluster.get(next).copied() {
            next += 1;
            for (neighbour, _) in across[face].into_iter().flatten() {
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
