//! Areas with concave outlines and holes in the plane of a panel: union, growth, distance. By `i_overlay`.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};

use crate::sheet::sides;
use scaleproof_core::geometry::{self, Point2, to_segment};

/// Closed outline in a plane, mm.
pub type Contour = Vec<Point2>;

/// Length of a segment of a rounded corner, as a share of its radius.
const ROUNDNESS: f64 = 0.4;

/// Area of the plane. Outer outlines run counter-clockwise, holes clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Region(Vec<Vec<Contour>>);

impl Region {
    /// Returns the union of the outlines, regardless of their direction.
    pub fn union(mut outlines: Vec<Contour>) -> Self {
        for outline in &mut outlines {
            if doubled_area(outline) < 0.0 {
                outline.reverse();
            }
        }
        let nothing: Vec<Contour> = Vec::new();
        Self(outlines.overlay(&nothing, OverlayRule::Union, FillRule::NonZero))
    }

    /// Creates a region of parts that do not overlap: each has its outline counter-clockwise, then its holes clockwise.
    pub fn new(parts: Vec<Vec<Contour>>) -> Self {
        Self(parts)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn and(&self, other: &Self) -> Self {
        Self(self.0.overlay(&other.0, OverlayRule::Intersect, FillRule::NonZero))
    }

    pub fn or(&self, other: &Self) -> Self {
        Self(self.0.overlay(&other.0, OverlayRule::Union, FillRule::NonZero))
    }

    pub fn without(&self, other: &Self) -> Self {
        Self(self.0.overlay(&other.0, OverlayRule::Difference, FillRule::NonZero))
    }

    /// Maps the region by a rigid motion of the plane, which keeps the direction of outlines.
    pub fn moved(&self, to: impl Fn(Point2) -> Point2) -> Self {
        let outline = |outline: &Contour| outline.iter().map(|p| to(*p)).collect();
        Self(self.0.iter().map(|shape| shape.iter().map(outline).collect()).collect())
    }

    pub fn border_mm(&self) -> f64 {
        self.edges().map(|(a, b)| geometry::distance(*b, *a)).sum()
    }

    /// Returns the region grown by all that is nearer to it than `by_mm`.
    pub fn grown(&self, by_mm: f64) -> Self {
        if by_mm <= 0.0 {
            return self.clone();
        }
        let style = OutlineStyle::new(by_mm).line_join(LineJoin::Round(ROUNDNESS));
        Self(self.0.outline(&style))
    }

    pub fn contours(&self) -> impl Iterator<Item = &Contour> {
        self.0.iter().flatten()
    }

    pub fn area_mm2(&self) -> f64 {
        0.5 * self.contours().map(|c| doubled_area(c)).sum::<f64>()
    }

    /// Returns the corners of its bounding box: lowest, highest; `None` for an empty region.
    pub fn bounds(&self) -> Option<(Point2, Point2)> {
        let (low, high) = corners(self.contours().flatten());
        low[0].is_finite().then_some((low, high))
    }

    pub fn contains(&self, p: Point2) -> bool {
        // Winding number: each edge that crosses the ray to the right counts up or down.
        let crossing = |(a, b): (&Point2, &Point2)| {
            let side = geometry::doubled_area(*a, *b, p);
            match (a[1] <= p[1], b[1] <= p[1]) {
                (true, false) if side > 0.0 => 1,
                (false, true) if side < 0.0 => -1,
                _ => 0,
            }
        };
        self.edges().map(crossing).sum::<i32>() != 0
    }

    /// Returns the distance of a point from the region's border; negative inside.
    pub fn distance_mm(&self, p: Point2) -> f64 {
        let nearest = self
            .edges()
            .map(|(a, b)| to_segment(p, [*a, *b]))
            .fold(f64::INFINITY, f64::min);
        if self.contains(p) { -nearest } else { nearest }
    }

    /// Returns approximately the inner point farthest from the border, for a name: the best of a grid over the bounding box.
    pub fn innermost(&self) -> Point2 {
        const STEPS: usize = 12;
        let (low, high) = self.bounds().unwrap_or_default();
        let at = |axis: usize, step: usize| low[axis] + (step as f64 + 0.5) / STEPS as f64 * (high[axis] - low[axis]);
        let places = (0..STEPS * STEPS).map(|i| [at(0, i % STEPS), at(1, i / STEPS)]);
        let inside = |p: &Point2| self.distance_mm(*p);
        places.min_by(|a, b| inside(a).total_cmp(&inside(b))).unwrap_or(low)
    }

    pub fn edges(&self) -> impl Iterator<Item = (&Point2, &Point2)> {
        self.contours().flat_map(|c| sides(c))
    }
}

/// Returns the corners of the bounding box of points: lowest, highest.
pub fn corners<'a>(places: impl IntoIterator<Item = &'a Point2>) -> (Point2, Point2) {
    let wider = |(low, high): (Point2, Point2), p: &Point2| {
        (
            [low[0].min(p[0]), low[1].min(p[1])],
            [high[0].max(p[0]), high[1].max(p[1])],
        )
    };
    places
        .into_iter()
        .fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), wider)
}

/// Returns twice the area inside an outline; negative if it runs clockwise.
pub fn doubled_area(outline: &[Point2]) -> f64 {
    sides(outline).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}
