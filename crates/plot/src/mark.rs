//! Elements of charts, in CSS pixels: x to the right, y down.
//!
//! Sheets have marks of their own (`print::sheet`): they are in millimetres with y up, and are stamped, clipped and cut; these can be rotated,
//! transparent, and have a tooltip.

use std::fmt;

/// sRGB colour as `0xrrggbb`; as text `#rrggbb`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u32);

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "#{:06x}", self.0)
    }
}

/// Graphic element of a chart. Marks are painted in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    pub shape: Shape,
    pub fill: Option<Colour>,
    /// Opacity of the fill: 0 is invisible, 1 hides what is below it.
    pub opacity: f64,
    /// Colour and width of the line around a shape; for text it is drawn below the letters.
    pub stroke: Option<(Colour, f64)>,
    pub is_dashed: bool,
    /// Tooltip, in SVG only.
    pub title: Option<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Line([[f64; 2]; 2]),
    /// Polyline with round joins, so that no tip exceeds its value.
    Polyline(Vec<[f64; 2]>),
    Polygon(Vec<[f64; 2]>),
    /// Upper left corner, and width and height.
    Rect([f64; 2], [f64; 2]),
    /// Centre and radius.
    Circle([f64; 2], f64),
    Text(Text),
    /// Marks, moved by an offset.
    Group([f64; 2], Vec<Mark>),
}

/// Line of text on its baseline.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    pub at: [f64; 2],
    /// Font size (em).
    pub size: f64,
    pub anchor: Anchor,
    pub is_bold: bool,
    /// True if the text runs upwards.
    pub is_upright: bool,
    pub words: String,
}

/// Horizontal anchor of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Mark {
    fn new(shape: Shape) -> Self {
        Self {
            shape,
            fill: None,
            opacity: 1.0,
            stroke: None,
            is_dashed: false,
            title: None,
        }
    }

    pub fn line(from: [f64; 2], to: [f64; 2], colour: Colour) -> Self {
        Self::new(Shape::Line([from, to].map(round))).outlined(colour, 1.0)
    }

    pub fn polyline(points: impl IntoIterator<Item = [f64; 2]>, colour: Colour, width: f64) -> Self {
        Self::new(Shape::Polyline(points.into_iter().map(round).collect())).outlined(colour, width)
    }

    pub fn polygon(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self::new(Shape::Polygon(points.into_iter().map(round).collect()))
    }

    /// Creates an upright rectangle; neighbours share an edge exactly.
    pub fn rect(corner: [f64; 2], [width, height]: [f64; 2]) -> Self {
        let ([left, top], [right, bottom]) = (round(corner), round([corner[0] + width, corner[1] + height]));
        Self::new(Shape::Rect([left, top], round([right - left, bottom - top])))
    }

    pub fn circle(centre: [f64; 2], radius: f64) -> Self {
        Self::new(Shape::Circle(round(centre), radius))
    }

    pub fn group(by: [f64; 2], marks: Vec<Self>) -> Self {
        Self::new(Shape::Group(round(by), marks))
    }

    pub fn text(at: [f64; 2], size: f64, anchor: Anchor, colour: Colour, words: impl fmt::Display) -> Self {
        let (at, words) = (round(at), words.to_string());
        let (is_bold, is_upright) = (false, false);
        let text = Text {
            at,
            size,
            anchor,
            is_bold,
            is_upright,
            words,
        };
        Self::new(Shape::Text(text)).filled(colour)
    }

    pub fn filled(self, colour: Colour) -> Self {
        let fill = Some(colour);
        Self { fill, ..self }
    }

    /// Sets the opacity of the fill.
    pub fn sheer(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    pub fn outlined(self, colour: Colour, width: f64) -> Self {
        let stroke = Some((colour, width));
        Self { stroke, ..self }
    }

    pub fn dashed(self, is_dashed: bool) -> Self {
        Self { is_dashed, ..self }
    }

    pub fn titled(self, title: String) -> Self {
        let title = Some(title);
        Self { title, ..self }
    }

    /// Makes text bold.
    pub fn bold(self) -> Self {
        self.lettered(|text| text.is_bold = true)
    }

    /// Makes text run upwards.
    pub fn upright(self) -> Self {
        self.lettered(|text| text.is_upright = true)
    }

    fn lettered(mut self, change: impl FnOnce(&mut Text)) -> Self {
        if let Shape::Text(text) = &mut self.shape {
            change(text);
        }
        self
    }
}

/// Rounds to a tenth of a pixel, which is a screen's resolution; fewer digits, smaller files. NaN and infinity become 0.
fn round(at: [f64; 2]) -> [f64; 2] {
    // Adding 0 removes the sign of a zero.
    let tenth = |v: f64| (v * 10.0).round() / 10.0 + 0.0;
    at.map(|v| if v.is_finite() { tenth(v) } else { 0.0 })
}
