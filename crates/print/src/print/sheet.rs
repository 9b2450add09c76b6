//! One printed page in millimetres, free of any file format. [`crate::print::pdf`] writes it.
//!
//! Page frame: origin at the paper's bottom-left corner, x right, y up, millimetres.

use std::sync::Arc;

use image::RgbImage;

/// 8-bit sRGB.
pub type Srgb8 = [u8; 3];

pub const BLACK: Srgb8 = [0, 0, 0];
pub const WHITE: Srgb8 = [255, 255, 255];

/// A place on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointMm {
    pub x_mm: f64,
    pub y_mm: f64,
}

impl PointMm {
    pub fn new(x_mm: f64, y_mm: f64) -> Self {
        Self { x_mm, y_mm }
    }
}

/// An upright rectangle on the page, given by its edges so that neighbours share an edge exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
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

    pub fn width_mm(&self) -> f64 {
        self.right_mm - self.left_mm
    }

    pub fn height_mm(&self) -> f64 {
        self.top_mm - self.bottom_mm
    }

    /// The corners, counter-clockwise.
    pub fn outline(&self) -> Vec<PointMm> {
        let Self {
            left_mm: l,
            bottom_mm: b,
            right_mm: r,
            top_mm: t,
        } = *self;
        [(l, b), (r, b), (r, t), (l, t)]
            .map(|(x, y)| PointMm::new(x, y))
            .to_vec()
    }
}

/// Which point of a text its place names; vertically it is always the baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextAnchor {
    Left,
    Centre,
    Right,
}

/// A filled rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fill {
    pub area: RectMm,
    pub colour: Srgb8,
}

/// Fills that are drawn once in the file and placed many times. Its frame: any point as origin, x right, y up, millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Stamp {
    /// Encloses every fill.
    pub bounds: RectMm,
    /// In painting order: later ones cover earlier ones.
    pub fills: Vec<Fill>,
}

/// One thing on a page. Marks are painted in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    Fill(Fill),
    /// A straight line with butt ends. `dash_mm` is (dash, gap); `None` is solid.
    Line {
        from: PointMm,
        to: PointMm,
        width_mm: f64,
        dash_mm: Option<(f64, f64)>,
        colour: Srgb8,
    },
    /// One line of text; `size_mm` is the em.
    Text {
        at: PointMm,
        size_mm: f64,
        anchor: TextAnchor,
        text: String,
        colour: Srgb8,
    },
    /// A filled area: everything inside any of the closed outlines. It is painted in one go, so that outlines which share an
    /// edge show no hairline; all run the same way round.
    Area {
        outlines: Vec<Vec<PointMm>>,
        colour: Srgb8,
    },
    /// A stamp with its origin at each place, in order, cut off at `clip`.
    Stamped {
        stamp: Arc<Stamp>,
        at: Vec<PointMm>,
        clip: RectMm,
    },
    /// Marks of which only what lies inside any of the closed outlines is shown; holes run the other way round.
    Clipped {
        to: Vec<Vec<PointMm>>,
        marks: Vec<Mark>,
    },
    /// Closed outlines for a cutter, lines of the layer "cut" in SVG; not printed.
    Cut {
        outlines: Vec<Vec<PointMm>>,
        /// Whether they are the finished piece, so that the sheet's trim is not cut as well.
        is_piece: bool,
    },
    /// An image that fills an area; its pixels are neither mixed nor left out.
    Image {
        image: Arc<RgbImage>,
        area: RectMm,
    },
}

impl Mark {
    /// A solid black line.
    pub fn line(from: (f64, f64), to: (f64, f64), width_mm: f64) -> Self {
        let (from, to) = (PointMm::new(from.0, from.1), PointMm::new(to.0, to.1));
        Self::Line {
            from,
            to,
            width_mm,
            dash_mm: None,
            colour: BLACK,
        }
    }

    /// Black text.
    pub fn text(at: (f64, f64), size_mm: f64, anchor: TextAnchor, text: impl Into<String>) -> Self {
        Self::Text {
            at: PointMm::new(at.0, at.1),
            size_mm,
            anchor,
            text: text.into(),
            colour: BLACK,
        }
    }
}

/// One page.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    pub width_mm: f64,
    pub height_mm: f64,
    /// Where the finished piece is cut out.
    pub trim: RectMm,
    /// How far the content runs, beyond the cut too; encloses `trim`.
    pub bleed: RectMm,
    pub marks: Vec<Mark>,
}
