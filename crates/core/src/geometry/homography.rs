//! The projective map between two planes.

use std::cmp::Ordering;

use super::distance;
use nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

/// Gauss–Newton steps after the linear answer; it converges in three or four.
const STEPS: usize = 20;
/// Squares of normalised points below this are rounding: four points are met.
const EXACT: f64 = 1e-26;

/// Returns the map that takes each point of a plane nearest to its partner: the direct linear transform on normalised points (Hartley &
/// Zisserman 2004, algorithm 4.2), then least squares of the distances in the second plane (its section 4.2.3). Four points are met exactly.
///
/// `None` for fewer than four points, points on a line, or numbers that are not finite.
pub fn fitted(from: &[[f64; 2]], to: &[[f64; 2]]) -> Option<Matrix3<f64>> {
    if from.len() < 4 || from.len() != to.len() {
        return None;
    }
    let (there, back) = (normalising(from)?, normalising(to)?);
    let moved = |by: &Matrix3<f64>, points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().map(|point| mapped(by, *point)).collect()
    };
    let (from, to) = (moved(&there, from), moved(&back, to));
    let map = refined(linear(&from, &to)?, &from, &to)?;
    let map = back.try_inverse()? * map * there;
    map.iter().all(|v| v.is_finite()).then(|| map / map.norm())
}

/// Maps a point; infinite on the horizon.
pub fn mapped(by: &Matrix3<f64>, [x, y]: [f64; 2]) -> [f64; 2] {
    let p = by * Vector3::new(x, y, 1.0);
    [p.x / p.z, p.y / p.z]
}

/// Moves the points' centre to the origin and makes their mean distance from it √2.
fn normalising(points: &[[f64; 2]]) -> Option<Matrix3<f64>> {
    let count = points.len() as f64;
    let mean = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / count);
    let distances = points.iter().map(|p| distance(*p, mean));
    let scale = std::f64::consts::SQRT_2 * count / distances.sum::<f64>();
    let mut map = Matrix3::new_scaling(scale);
    (map[(0, 2)], map[(1, 2)]) = (-scale * mean[0], -scale * mean[1]);
    scale.is_finite().then_some(map)
}

/// Returns the unit vector of nine numbers that leaves the least of the linear equations.
fn linear(from: &[[f64; 2]], to: &[[f64; 2]]) -> Option<Matrix3<f64>> {
    let mut sums = SMatrix::<f64, 9, 9>::zeros();
    for ([x, y], [u, v]) in from.iter().zip(to) {
        let rows = [
            [*x, *y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y, -u],
            [0.0, 0.0, 0.0, *x, *y, 1.0, -v * x, -v * y, -v],
        ];
        for row in rows.map(SVector::<f64, 9>::from) {
            sums += row * row.transpose();
        }
    }
    let eigen = SymmetricEigen::try_new(sums, f64::EPSILON, 1000)?;
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    // Points on a line leave a second answer.
    let is_open = eigen.eigenvalues[order[1]] < 1e-12 * eigen.eigenvalues[order[8]];
    let answer = eigen.eigenvectors.column(order[0]);
    (!is_open).then(|| Matrix3::from_row_iterator(answer.iter().copied()))
}

/// Returns the least sum of squared distances near a map, which keeps its length 1.
fn refined(start: Matrix3<f64>, from: &[[f64; 2]], to: &[[f64; 2]]) -> Option<Matrix3<f64>> {
    let mut map = start / start.norm();
    let mut cost = squares(&map, from, to);
    for _ in 0..STEPS {
        if cost < EXACT {
            break;
        }
        let (mut information, mut gradient) = (SMatrix::<f64, 9, 9>::zeros(), SVector::<f64, 9>::zeros());
        for ([x, y], seen) in from.iter().zip(to) {
            let p = map * Vector3::new(*x, *y, 1.0);
            let at = [p.x / p.z, p.y / p.z];
            for (axis, (is, wanted)) in at.into_iter().zip(seen).enumerate() {
                let mut row = SVector::<f64, 9>::zeros();
                for (i, c) in [*x, *y, 1.0].into_iter().enumerate() {
                    row[3 * axis + i] = c / p.z;
                    row[6 + i] = -c * is / p.z;
                }
                information += row * row.transpose();
                gradient += row * (is - wanted);
            }
        }
        // The length of the map is no part of it: held.
        let length = SVector::<f64, 9>::from_iterator(map.transpose().iter().copied());
        information += length * length.transpose() * information.trace();
        let step = information.cholesky()?.solve(&gradient);
        let next = map - Matrix3::from_row_iterator(step.iter().copied());
        let next = next / next.norm();
        let next_cost = squares(&next, from, to);
        // What is not finite is no better either.
        match next_cost.partial_cmp(&cost) {
            Some(Ordering::Less) => (map, cost) = (next, next_cost),
            _ => break,
        }
    }
    cost.is_finite().then_some(map)
}

fn squares(map: &Matrix3<f64>, from: &[[f64; 2]], to: &[[f64; 2]]) -> f64 {
    let off = |(point, seen): (&[f64; 2], &[f64; 2])| {
        let [u, v] = mapped(map, *point);
        (u - seen[0]).powi(2) + (v - seen[1]).powi(2)
    };
    from.iter().zip(to).map(off).sum()
}
