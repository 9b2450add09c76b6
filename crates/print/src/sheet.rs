//! Printed page in millimetres, independent of file formats. [`crate::pdf`] writes it.
//!
//! Page frame: origin at the paper's bottom-left corner, x right, y up, millimetres.

use std::sync::Arc;

use image::RgbImage;
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm};

/// 8-bit sRGB.
pub type Srgb8 = [u8; 3];

pub const BLACK: Srgb8 = [0, 0, 0];
pub const WHITE: Srgb8 = [255, 255, 255];

/// Returns the corners of a closed outline, each with the next one.
pub fn sides<T>(outline: &[T]) -> impl Iterator<Item = (&T, &T)> {
    outline.iter().zip(outline.iter().cycle().skip(1))
}

/// Upright rectangle on the page, given by its edges so that neighbours share an edge exactly.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RectMm {
    pub left_mm: f64,
    pub bottom_mm: f64,
    pub right_mm: f64,
    pub top_mm: f64,
}

impl RectMm {
    pub fn new(left_mm: f64, bottom_mm: f64, right_mm: f64, top_mm: f64) -> Self {
        Self {
            left_mm,
            bottom_mm,
            right_mm,
            top_mm,
        }
    }

    pub fn sized([left_mm, bottom_mm]: Point2, (width_mm, height_mm): (f64, f64)) -> Self {
        Self::new(left_mm, bottom_mm, left_mm + width_mm, bottom_mm + height_mm)
    }

    pub fn around<'a>(points: impl IntoIterator<Item = &'a Point2>) -> Self {
        let none = Self::new(f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
        let point = |p: &Point2| Self::new(p[0], p[1], p[0], p[1]);
        points.into_iter().fold(none, |all, p| all.union(point(p)))
    }

    pub fn union(self, other: Self) -> Self {
        Self::new(
            self.left_mm.min(other.left_mm),
            self.bottom_mm.min(other.bottom_mm),
            self.right_mm.max(other.right_mm),
            self.top_mm.max(other.top_mm),
        )
    }

    /// Returns the rectangle with `by_mm` more on every side.
    pub fn grown(self, by_mm: f64) -> Self {
        Self::new(
            self.left_mm - by_mm,
            self.bottom_mm - by_mm,
            self.right_mm + by_mm,
            self.top_mm + by_mm,
        )
    }

    /// Returns the rectangle moved by (x, y).
    pub fn moved(self, [x, y]: Point2) -> Self {
        Self::new(self.left_mm + x, self.bottom_mm + y, self.right_mm + x, self.top_mm + y)
    }

    pub fn is_within(&self, outer: &Self) -> bool {
        self.left_mm >= outer.left_mm
            && self.right_mm <= outer.right_mm
            && self.bottom_mm >= outer.bottom_mm
            && self.top_mm <= outer.top_mm
    }

    /// Returns the edges: left, bottom, right, top.
    pub fn edges(&self) -> [f64; 4] {
        [self.left_mm, self.bottom_mm, self.right_mm, self.top_mm]
    }

    pub fn middle(&self) -> Point2 {
        [
            0.5 * (self.left_mm + self.right_mm),
            0.5 * (self.bottom_mm + self.top_mm),
        ]
    }

    pub fn width_mm(&self) -> f64 {
        self.right_mm - self.left_mm
    }

    pub fn height_mm(&self) -> f64 {
        self.top_mm - self.bottom_mm
    }

    pub fn outline(&self) -> Vec<Point2> {
        let [l, b, r, t] = self.edges();
        vec![[l, b], [r, b], [r, t], [l, t]]
    }
}

/// Horizontal anchor of a text; vertically it is always the baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextAnchor {
    Left,
    Centre,
    Right,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fill {
    pub area: RectMm,
    pub colour: Srgb8,
}

/// Fills that are drawn once in the file and placed many times. Its frame: any point as origin, x right, y up, millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Stamp {
    /// Bounds of all fills.
    pub bounds: RectMm,
    /// Fills in painting order: later ones cover earlier ones.
    pub fills: Vec<Fill>,
}

/// A straight line with butt ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    pub from: Point2,
    pub to: Point2,
    pub width_mm: f64,
    /// Lengths of dash and gap; `None` is solid.
    pub dash_mm: Option<(f64, f64)>,
    pub colour: Srgb8,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    pub at: Point2,
    /// Font size (em).
    pub size_mm: f64,
    pub anchor: TextAnchor,
    pub text: String,
    pub colour: Srgb8,
}

/// Graphic element of a page. Marks are painted in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    Fill(Fill),
    Line(Line),
    Text(Text),
    /// A filled area: everything inside any of the closed outlines. It is painted in one go, so that outlines which share an
    /// edge show no hairline; all run the same way round.
    Area {
        outlines: Vec<Vec<Point2>>,
        colour: Srgb8,
    },
    /// A stamp with its origin at each place, in order, cut off at `clip`.
    Stamped {
        stamp: Arc<Stamp>,
        at: Vec<Point2>,
        clip: RectMm,
    },
    /// Marks clipped to the inside of any of the closed outlines; holes run the other way round.
    Clipped {
        to: Vec<Vec<Point2>>,
        marks: Vec<Mark>,
    },
    /// Closed outlines for a cutter, in the layer "cut" in SVG; not printed.
    Cut {
        outlines: Vec<Vec<Point2>>,
        /// True if they are the finished piece, so that the sheet's trim is not cut as well.
        is_piece: bool,
    },
    /// Image that fills an area; its pixels are neither mixed nor left out.
    Image {
        image: Arc<RgbImage>,
        area: RectMm,
    },
}

impl Mark {
    /// Creates a line, solid or dashed by (dash, gap).
    pub fn stroke([from, to]: [Point2; 2], width_mm: f64, dash_mm: Option<(f64, f64)>, colour: Srgb8) -> Self {
        Self::Line(Line {
            from,
            to,
            width_mm,
            dash_mm,
            colour,
        })
    }

    /// Creates a solid black line.
    pub fn line(from: Point2, to: Point2, width_mm: f64) -> Self {
        Self::stroke([from, to], width_mm, None, BLACK)
    }

    /// Creates solid lines along a closed outline.
    pub fn outline(outline: &[Point2], width_mm: f64, colour: Srgb8) -> impl Iterator<Item = Self> {
        sides(outline).map(move |(from, to)| Self::stroke([*from, *to], width_mm, None, colour))
    }

    pub fn fill(area: RectMm, colour: Srgb8) -> Self {
        Self::Fill(Fill { area, colour })
    }

    /// Creates a filled area of black.
    pub fn black(outlines: Vec<Vec<Point2>>) -> Self {
        let colour = BLACK;
        Self::Area { outlines, colour }
    }

    pub fn text(at: Point2, size_mm: f64, anchor: TextAnchor, text: impl Into<String>) -> Self {
        Self::Text(Text {
            at,
            size_mm,
            anchor,
            text: text.into(),
            colour: BLACK,
        })
    }

    /// Creates black text of this size, or smaller to be no wider than `most_mm`.
    pub fn fitted(at: Point2, (size_mm, most_mm): (f64, f64), anchor: TextAnchor, text: impl Into<String>) -> Self {
        let text = text.into();
        Self::text(at, fitting_size_mm(&text, size_mm, most_mm), anchor, text)
    }

    /// Creates black text whose capitals are centred at a point; sized as by [`Mark::fitted`].
    pub fn centred([x, y]: Point2, (size_mm, most_mm): (f64, f64), text: impl Into<String>) -> Self {
        let text = text.into();
        let size_mm = fitting_size_mm(&text, size_mm, most_mm);
        Self::text([x, y - 0.5 * CAP_HEIGHT * size_mm], size_mm, TextAnchor::Centre, text)
    }

    /// Creates lines of text from `left_mm` on, with each line's baseline by its index; sized as by [`Mark::fitted`].
    pub fn lines<'a>(
        lines: impl IntoIterator<Item = &'a str>,
        left_mm: f64,
        size: (f64, f64),
        baseline: impl Fn(usize) -> f64,
    ) -> Vec<Self> {
        let line = |(i, line): (usize, &str)| Self::fitted([left_mm, baseline(i)], size, TextAnchor::Left, line);
        lines.into_iter().enumerate().map(line).collect()
    }

    /// Clips marks to a rectangle.
    pub fn clipped(to: RectMm, marks: Vec<Self>) -> Self {
        let to = vec![to.outline()];
        Self::Clipped { to, marks }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    pub width_mm: f64,
    pub height_mm: f64,
    /// Rectangle at which the finished piece is cut out.
    pub trim: RectMm,
    /// Extent of the content, beyond the cut too; encloses `trim`.
    pub bleed: RectMm,
    pub marks: Vec<Mark>,
}

/// Returns the index of a shared item in a list, to which it is added if it is new, and true if it was.
pub(super) fn number_of<T>(known: &mut Vec<Arc<T>>, thing: &Arc<T>) -> (usize, bool) {
    let found = known.iter().position(|k| Arc::ptr_eq(k, thing));
    if found.is_none() {
        known.push(Arc::clone(thing));
    }
    (found.unwrap_or(known.len() - 1), found.is_none())
}
