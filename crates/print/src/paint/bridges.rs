//! Search for the places where a stencil's material must be bridged. All functions work on the *core*: the possible centres of the square that
//! measures widths. Links in the core become bridges of the square's full width.

use std::collections::BTreeSet;

use super::plane::{Area, PlaneOutline, PlanePoint, edges, point};
use crate::buckets::{Buckets, bounds};
use scaleproof_core::geometry::{UnionFind, distance, nearest_share};

/// Bridge: the square is swept along this segment.
pub type Link = (PlanePoint, PlanePoint);

/// Extra search distance: slanted cuts are rounded to the unit.
const ROUNDING: i64 = 3;

/// Returns pairs of points in the core whose squares meet, while the segment between them is not in the core: the material between them is narrower
/// than the square. If `around` > 0, points that an outline joins within that length are no pair; such outlines have many short edges, so only the
/// nearest point to each corner counts.
pub fn necks(core: &Area, side: i32, around: i32) -> Vec<Link> {
    let reach = i64::from(side) + ROUNDING;
    let along = Along::all(core);
    let ways: Vec<Link> = along.iter().map(|edge| edge.way).collect();
    if ways.is_empty() {
        return Vec::new();
    }
    let places = |(a, b): &Link| bounds(&[point(*a), point(*b)], reach as f64);
    let corners: Vec<[f64; 2]> = ways.iter().map(|(corner, _)| point(*corner)).collect();
    let (low, high) = bounds(&corners, reach as f64);
    let buckets = Buckets::new(low, high, ways.iter().map(places));
    let mut found = BTreeSet::new();
    let mut links = Vec::new();
    for edge in &along {
        let corner = edge.way.0;
        let mut nearest: Option<(i64, PlanePoint)> = None;
        let near = buckets.at(point(corner)).unwrap_or_default().iter();
        for other in near.map(|i| &along[*i as usize]) {
            let way = other.way;
            if out_of_reach(corner, way, reach) || corner == way.0 || corner == way.1 {
                continue;
            }
            let end = nearest_on(way, corner);
            let away = apart(end, corner);
            if around > 0 && (nearest.is_some_and(|(known, _)| known <= away) || edge.reaches(other, end, around)) {
                continue;
            }
            let is_neck = (ROUNDING..=reach).contains(&away) && !holds_middle(&ways, corner, end);
            if is_neck && around > 0 {
                nearest = Some((away, end));
            } else if is_neck && !found.contains(&(end, corner)) {
                found.insert((corner, end));
                links.push((corner, end));
            }
        }
        links.extend(nearest.map(|(_, end)| (corner, end)));
    }
    links
}

/// Edge with its position along its outline.
struct Along {
    way: Link,
    outline: usize,
    start: f64,
    /// Length of the outline.
    length: f64,
}

impl Along {
    /// Returns the edges of all outlines in their order.
    fn all(core: &Area) -> Vec<Self> {
        let mut all = Vec::new();
        for (outline, corners) in core.outlines().enumerate() {
            let length = edges(corners).map(|(a, b)| between(a, b)).sum();
            let mut start = 0.0;
            for way in edges(corners) {
                all.push(Self {
                    way,
                    outline,
                    start,
                    length,
                });
                start += between(way.0, way.1);
            }
        }
        all
    }

    /// Returns true if the path along the outline from this edge's start to a point on another edge is no longer than `around`.
    fn reaches(&self, other: &Self, place: PlanePoint, around: i32) -> bool {
        let way = (other.start + between(other.way.0, place) - self.start).abs();
        self.outline == other.outline && way.min(self.length - way) <= f64::from(around)
    }
}

fn between(a: PlanePoint, b: PlanePoint) -> f64 {
    distance(point(a), point(b))
}

/// Returns the larger of the distances along x and y.
fn apart(a: PlanePoint, b: PlanePoint) -> i64 {
    let along = |a: i32, b: i32| (i64::from(a) - i64::from(b)).abs();
    along(a.x, b.x).max(along(a.y, b.y))
}

/// Returns the midpoint of a link.
pub fn middle((p, q): Link) -> PlanePoint {
    PlanePoint::new(i32::midpoint(p.x, q.x), i32::midpoint(p.y, q.y))
}

/// Returns a link from every piece of the core to the nearest other piece; none if there is one piece only. Links that would close a circle are left
/// out; pieces that remain apart are joined in the next round (Borůvka 1926).
pub fn nearest(core: &Area) -> Vec<Link> {
    let count = core.pieces.len();
    if count < 2 {
        return Vec::new();
    }
    let mut best: Vec<Option<(f64, usize, Link)>> = vec![None; count];
    let ways = |piece: &Vec<PlaneOutline>| piece.iter().flat_map(edges).collect();
    let piece_ways: Vec<Vec<Link>> = core.pieces.iter().map(ways).collect();
    for (a, ways_a) in piece_ways.iter().enumerate() {
        for (corner, _) in ways_a {
            for (b, ways_b) in piece_ways.iter().enumerate().filter(|(b, _)| *b != a) {
                for way in ways_b {
                    let known = |i: usize| best[i].map_or(f64::INFINITY, |(far, _, _)| far);
                    let worth = known(a).max(known(b));
                    if worth.is_finite() && out_of_reach(*corner, *way, worth as i64 + 1) {
                        continue;
                    }
                    let at = nearest_on(*way, *corner);
                    let far = between(at, *corner);
                    for (from, to) in [(a, b), (b, a)] {
                        if best[from].is_none_or(|(known, _, _)| far < known) {
                            best[from] = Some((far, to, (*corner, at)));
                        }
                    }
                }
            }
        }
    }
    without_circles(&best)
}

fn without_circles(best: &[Option<(f64, usize, Link)>]) -> Vec<Link> {
    let mut groups = UnionFind::new(best.len());
    let mut links = Vec::new();
    for (from, held) in best.iter().enumerate() {
        let Some((_, to, link)) = held else { continue };
        if groups.root(from) != groups.root(*to) {
            links.push(*link);
            groups.unite(from, *to);
        }
    }
    links
}

/// Returns true if a segment is certainly farther from a point than `reach`, along x or y.
fn out_of_reach(place: PlanePoint, (a, b): Link, reach: i64) -> bool {
    let beyond = |p: i32, a: i32, b: i32| {
        let (low, high) = (i64::from(a.min(b)), i64::from(a.max(b)));
        i64::from(p) < low - reach || i64::from(p) > high + reach
    };
    beyond(place.x, a.x, b.x) || beyond(place.y, a.y, b.y)
}

fn nearest_on((a, b): Link, to: PlanePoint) -> PlanePoint {
    let (dx, dy) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
    let along = nearest_share(point(to), [point(a), point(b)]);
    PlanePoint::new(a.x + (along * dx).round() as i32, a.y + (along * dy).round() as i32)
}

/// Returns true if the midpoint of two points is inside the edges or on them, by the crossings of a ray to the right (in doubled coordinates, so that
/// the midpoint is an integer).
fn holds_middle(ways: &[Link], p: PlanePoint, q: PlanePoint) -> bool {
    let (x, y) = (i64::from(p.x) + i64::from(q.x), i64::from(p.y) + i64::from(q.y));
    let mut inside = false;
    for (a, b) in ways {
        let doubled = |p: &PlanePoint| (2 * i64::from(p.x), 2 * i64::from(p.y));
        let ((ax, ay), (bx, by)) = (doubled(a), doubled(b));
        let side = i128::from(bx - ax) * i128::from(y - ay) - i128::from(by - ay) * i128::from(x - ax);
        let between = x >= ax.min(bx) && x <= ax.max(bx) && y >= ay.min(by) && y <= ay.max(by);
        if side == 0 && between {
            return true;
        }
        if (ay > y) != (by > y) && (side > 0) == (by > ay) {
            inside = !inside;
        }
    }
    inside
}
