//! Outlines on the paper: tests for self-intersection, and for fitting into a rectangle.

use nalgebra::Vector2;

use scaleproof_core::geometry::{convex_hull, extent};

/// Side of an outline: place index and position of both ends.
pub(super) type Side = [(usize, Vector2<f64>); 2];

/// Returns true if any two sides without a common place cross.
pub(super) fn is_crossing(sides: &[Side]) -> bool {
    let extent = |s: &Side, i: usize| (s[0].1[i].min(s[1].1[i]), s[0].1[i].max(s[1].1[i]));
    let mut order: Vec<&Side> = sides.iter().collect();
    order.sort_by(|a, b| extent(a, 0).0.total_cmp(&extent(b, 0).0));
    order.iter().enumerate().any(|(i, a)| {
        let (right, (low, high)) = (extent(a, 0).1, extent(a, 1));
        let near = order[i + 1..].iter().take_while(|b| extent(b, 0).0 <= right);
        let is_apart = |b: &Side| !a.iter().any(|(p, _)| b.iter().any(|(q, _)| p == q));
        near.filter(|b| extent(b, 1).0 <= high && extent(b, 1).1 >= low && is_apart(b))
            .any(|b| parts(a, b) && parts(b, a))
    })
}

/// Returns true if the ends of the second side are on different sides of the first's line.
fn parts(a: &Side, b: &Side) -> bool {
    let beside = b.map(|(_, p)| (a[1].1 - a[0].1).perp(&(p - a[0].1)));
    beside[0].min(beside[1]) < 0.0 && beside[0].max(beside[1]) > 0.0
}

/// Returns the area of an outline's smallest rectangle of at most the given size, and the rotation to it. Tests the rectangles along the sides of the
/// convex hull, one of which is the smallest of all (Freeman and Shapira 1975); if none of them fits, the smallest fitting one over all whole
/// degrees. `None` if the outline does not fit.
pub(super) fn rectangle(points: impl Iterator<Item = Vector2<f64>>, most_mm: Option<[f64; 2]>) -> Option<(f64, f64)> {
    let hull = convex_hull(points.map(Into::into).collect());
    let fitting = |turn: f64| {
        let (sin, cos) = turn.sin_cos();
        let length = |x: f64, y: f64| {
            let (low, high) = extent(hull.iter().map(|p| x * p[0] + y * p[1]));
            high - low
        };
        let (width, height) = (length(cos, -sin), length(sin, cos));
        let is_fitting = most_mm.is_none_or(|most| width <= most[0] && height <= most[1]);
        is_fitting.then_some((width * height, turn))
    };
    let smallest = |turns: &mut dyn Iterator<Item = f64>| turns.filter_map(fitting).min_by(|a, b| a.0.total_cmp(&b.0));
    let along = (0..hull.len()).map(|i| {
        let (p, q) = (hull[i], hull[(i + 1) % hull.len()]);
        -(q[1] - p[1]).atan2(q[0] - p[0])
    });
    let right_angle = std::f64::consts::FRAC_PI_2;
    smallest(&mut along.flat_map(|angle| [angle, angle + right_angle]))
        .or_else(|| smallest(&mut (0..180).map(|deg| f64::from(deg).to_radians())))
}
