//! Paper sizes.

use std::str::FromStr;

use super::SheetError;
use scaleproof_core::geometry::length::{parse_mm, parse_sides_mm};
use scaleproof_core::spelling;

/// Maximum side of a PDF page without a user unit: 14 400 pt (ISO 32000-1, annex C.2), rounded down.
pub const MAX_SIDE_MM: f64 = 5000.0;

/// Nominal size of a sheet of paper; its use as portrait or landscape is an [`Orientation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paper {
    /// Width of a sheet.
    pub width_mm: f64,
    /// Height of a sheet.
    pub height_mm: f64,
}

impl Paper {
    /// 210 × 297 mm.
    pub const A4: Self = Self::new(210.0, 297.0);
    /// 297 × 420 mm.
    pub const A3: Self = Self::new(297.0, 420.0);
    /// 215.9 × 279.4 mm.
    pub const LETTER: Self = Self::new(215.9, 279.4);
    /// 279.4 × 431.8 mm.
    pub const TABLOID: Self = Self::new(279.4, 431.8);

    /// Sizes with names: ISO 216, ANSI/ASME Y14.1 and US paper.
    pub const NAMED: [(&str, Self); 10] = [
        ("a0", Self::new(841.0, 1189.0)),
        ("a1", Self::new(594.0, 841.0)),
        ("a2", Self::new(420.0, 594.0)),
        ("a3", Self::A3),
        ("a4", Self::A4),
        ("a5", Self::new(148.0, 210.0)),
        ("letter", Self::LETTER),
        ("legal", Self::new(215.9, 355.6)),
        ("tabloid", Self::TABLOID),
        ("ledger", Self::TABLOID),
    ];

    /// Creates a sheet of this width and height.
    pub const fn new(width_mm: f64, height_mm: f64) -> Self {
        Self { width_mm, height_mm }
    }

    /// Returns the paper with its short side across.
    pub fn portrait(self) -> Self {
        Self::new(self.width_mm.min(self.height_mm), self.width_mm.max(self.height_mm))
    }

    /// Returns the paper with its long side across.
    pub fn landscape(self) -> Self {
        let Self { width_mm, height_mm } = self.portrait();
        Self::new(height_mm, width_mm)
    }
}

/// Returns the page of a piece of a roll; if `turned`, the roll's width is the page's height.
pub fn roll_page(width_mm: f64, length_mm: f64, turned: bool) -> Paper {
    if turned {
        Paper::new(length_mm, width_mm)
    } else {
        Paper::new(width_mm, length_mm)
    }
}

impl FromStr for Paper {
    type Err = SheetError;

    /// Parses a name of [`Paper::NAMED`], or `WIDTHxHEIGHT` in millimetres or with a unit.
    fn from_str(text: &str) -> Result<Self, SheetError> {
        let text = text.to_ascii_lowercase();
        if let Some((_, paper)) = Self::NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(*paper);
        }
        let is_side = |mm: &f64| *mm > 0.0 && *mm <= MAX_SIDE_MM;
        let sides = parse_sides_mm(&text).filter(|sides| sides.iter().all(is_side));
        let [width_mm, height_mm] = sides.ok_or_else(|| unknown(&text))?;
        Ok(Self { width_mm, height_mm })
    }
}

fn unknown(text: &str) -> SheetError {
    SheetError::UnknownPaper {
        text: text.to_owned(),
        near: spelling::hint(text, Paper::NAMED.map(|(name, _)| name)),
    }
}

/// Paper in the printer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stock {
    /// Cut sheets.
    Cut(Paper),
    /// A roll: its width is fixed, a page is as long as needed.
    Roll { width_mm: f64 },
}

impl Stock {
    /// Returns the page, upright or `turned`; for a roll as long as a page can be.
    pub fn page(self, turned: bool) -> Paper {
        match self {
            Self::Cut(paper) if turned => paper.landscape(),
            Self::Cut(paper) => paper.portrait(),
            Self::Roll { width_mm } => roll_page(width_mm, MAX_SIDE_MM, turned),
        }
    }
}

impl From<Paper> for Stock {
    fn from(paper: Paper) -> Self {
        Self::Cut(paper)
    }
}

impl FromStr for Stock {
    type Err = SheetError;

    /// Parses a [`Paper`], or `roll` and a width in millimetres or with a unit, as in `roll610`.
    fn from_str(text: &str) -> Result<Self, SheetError> {
        let Some(width) = text.to_ascii_lowercase().strip_prefix("roll").map(str::to_owned) else {
            return Ok(Self::Cut(text.parse()?));
        };
        match parse_mm(&width) {
            Ok(width_mm) if width_mm > 0.0 && width_mm <= MAX_SIDE_MM => Ok(Self::Roll { width_mm }),
            _ => Err(unknown(text)),
        }
    }
}

/// Orientation of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Orientation {
    /// Whichever needs fewer sheets; portrait if both need the same.
    #[default]
    Auto,
    Portrait,
    Landscape,
}

/// Parses `WIDTHxHEIGHT` in millimetres or with a unit.
pub fn size_mm(text: &str) -> Result<(f64, f64), SheetError> {
    let sides = parse_sides_mm(&text.to_ascii_lowercase()).map(<(f64, f64)>::from);
    sides.ok_or_else(|| SheetError::UnknownSize { text: text.to_owned() })
}
