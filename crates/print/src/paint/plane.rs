//! Areas of the plane in integer ten-thousandths of a millimetre, so that shared edges are shared exactly and areas add up exactly.
//!
//! The boolean operations are those of `i_overlay`; growing and shrinking by a square use the union of the square's sweeps.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

use crate::sheet::sides;
use scaleproof_core::geometry::Point2;

/// Units per millimetre.
pub const PER_MM: f64 = 10_000.0;

pub type PlanePoint = IntPoint<i32>;
pub type PlaneOutline = Vec<PlanePoint>;

/// Converts millimetres to the nearest unit. Beyond 100 m, where nothing is printed, the value is clamped.
pub fn units(mm: f64) -> i32 {
    (mm * PER_MM).round().clamp(-1e9, 1e9) as i32
}

pub fn mm(units: i32) -> f64 {
    f64::from(units) / PER_MM
}

/// Converts a point of the plane to millimetres.
pub fn place(p: PlanePoint) -> Point2 {
    [mm(p.x), mm(p.y)]
}

/// Converts a point of the plane to floating point, in units.
pub fn point(p: PlanePoint) -> Point2 {
    [f64::from(p.x), f64::from(p.y)]
}

/// Set of any number of pieces, with or without holes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Area {
    /// Connected pieces: each has its outline counter-clockwise, then its holes clockwise.
    pub pieces: Vec<Vec<PlaneOutline>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Bounds {
    pub left: i32,
    pub bottom: i32,
    pub right: i32,
    pub top: i32,
}

impl Bounds {
    pub fn new(left: i32, bottom: i32, right: i32, top: i32) -> Self {
        Self {
            left,
            bottom,
            right,
            top,
        }
    }

    pub fn grown(self, by: i32) -> Self {
        Self::new(self.left - by, self.bottom - by, self.right + by, self.top + by)
    }

    pub fn outline(self) -> PlaneOutline {
        let (low, high) = ((self.left, self.bottom), (self.right, self.top));
        [(low.0, low.1), (high.0, low.1), (high.0, high.1), (low.0, high.1)]
            .map(|(x, y)| PlanePoint::new(x, y))
            .to_vec()
    }
}

impl Area {
    /// Returns the union of the outlines; they may overlap, and all run counter-clockwise.
    pub fn of(outlines: &[PlaneOutline]) -> Self {
        operation(outlines, &[], OverlayRule::Subject)
    }

    /// Creates the area of one piece: its outline, then its holes.
    pub fn from_piece(piece: &[PlaneOutline]) -> Self {
        let pieces = vec![piece.to_vec()];
        Self { pieces }
    }

    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    pub fn outlines(&self) -> impl Iterator<Item = &PlaneOutline> {
        self.pieces.iter().flatten()
    }

    /// Returns the edges of every piece, each as a corner and the next.
    pub fn edges(&self) -> impl Iterator<Item = (PlanePoint, PlanePoint)> {
        self.outlines().flat_map(edges)
    }

    pub fn bounds(&self) -> Option<Bounds> {
        let place = |p: &PlanePoint| Bounds::new(p.x, p.y, p.x, p.y);
        let around = |a: Bounds, b: Bounds| {
            let (right, top) = (a.right.max(b.right), a.top.max(b.top));
            Bounds::new(a.left.min(b.left), a.bottom.min(b.bottom), right, top)
        };
        self.outlines().flatten().map(place).reduce(around)
    }

    pub fn and(&self, other: &Self) -> Self {
        operation(&self.flat(), &other.flat(), OverlayRule::Intersect)
    }

    pub fn without(&self, other: &Self) -> Self {
        operation(&self.flat(), &other.flat(), OverlayRule::Difference)
    }

    pub fn with(&self, more: &[PlaneOutline]) -> Self {
        operation(&self.flat(), more, OverlayRule::Union)
    }

    /// Returns the Minkowski sum with a square of half side `half`: all it covers while its centre is in this area.
    pub fn grown(&self, half: i32) -> Self {
        if half == 0 {
            return self.clone();
        }
        let sweeps: Vec<PlaneOutline> = self.edges().map(|(a, b)| swept(a, b, half)).collect();
        self.with(&sweeps)
    }

    /// Returns the erosion by a square of half side `half`: the centres at which all of the square is in this area.
    pub fn shrunk(&self, half: i32) -> Self {
        let Some(bounds) = self.bounds() else {
            return Self::default();
        };
        let outside = Self::of(&[bounds.grown(2 * half + 1).outline()]).without(self);
        self.without(&outside.grown(half))
    }

    /// Returns the morphological opening: all that squares of half side `half` inside this area cover.
    pub fn opened(&self, half: i32) -> Self {
        self.shrunk(half).grown(half)
    }

    /// Returns true if a point is inside, by the winding number.
    pub fn contains(&self, p: PlanePoint) -> bool {
        let crossing = |(a, b): (PlanePoint, PlanePoint)| {
            let side = i128::from(b.x - a.x) * i128::from(p.y - a.y) - i128::from(b.y - a.y) * i128::from(p.x - a.x);
            match (a.y <= p.y, b.y <= p.y) {
                (true, false) if side > 0 => 1,
                (false, true) if side < 0 => -1,
                _ => 0,
            }
        };
        self.edges().map(crossing).sum::<i32>() != 0
    }

    /// Returns twice the area in square units; exact.
    pub fn doubled_area(&self) -> i128 {
        let cross =
            |(a, b): (PlanePoint, PlanePoint)| i128::from(a.x) * i128::from(b.y) - i128::from(b.x) * i128::from(a.y);
        self.edges().map(cross).sum()
    }

    pub fn mm2(&self) -> f64 {
        self.doubled_area() as f64 / (2.0 * PER_MM * PER_MM)
    }

    fn flat(&self) -> Vec<PlaneOutline> {
        self.outlines().cloned().collect()
    }
}

/// Returns each corner of an outline with the next.
pub fn edges(outline: &PlaneOutline) -> impl Iterator<Item = (PlanePoint, PlanePoint)> {
    sides(outline).map(|(a, b)| (*a, *b))
}

/// Returns the area that a square of half side `half` covers while its centre moves straight from `a` to `b`: a hexagon, or a rectangle.
pub fn swept(a: PlanePoint, b: PlanePoint, half: i32) -> PlaneOutline {
    let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
    let corners = if a.y <= b.y {
        [(a, -1, -1), (a, 1, -1), (b, 1, -1), (b, 1, 1), (b, -1, 1), (a, -1, 1)]
    } else {
        [(a, -1, -1), (b, -1, -1), (b, 1, -1), (b, 1, 1), (a, 1, 1), (a, -1, 1)]
    };
    corners
        .map(|(p, x, y)| PlanePoint::new(p.x + x * half, p.y + y * half))
        .to_vec()
}

fn operation(subject: &[PlaneOutline], clip: &[PlaneOutline], rule: OverlayRule) -> Area {
    // Pieces that touch in a point are separate pieces.
    let options = IntOverlayOptions {
        ogc: true,
        ..IntOverlayOptions::default()
    };
    let mut overlay = Overlay::<i32>::from_subj_and_clip_custom(subject, clip, options, Default::default());
    Area {
        pieces: overlay.overlay(rule, FillRule::NonZero),
    }
}
