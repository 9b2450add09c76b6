//! Paper sizes.

use std::str::FromStr;

use super::SheetError;

/// The longest side a PDF page may have without a user unit: 14 400 pt (ISO 32000-1, annex C.2), rounded down.
pub const MAX_SIDE_MM: f64 = 5000.0;

/// A sheet of paper as it is named; which way round it is used is an [`Orientation`].
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

    /// A sheet of this width and height.
    pub const fn new(width_mm: f64, height_mm: f64) -> Self {
        Self { width_mm, height_mm }
    }

    /// The paper turned so that its short side is across.
    pub fn portrait(self) -> Self {
        Self::new(self.width_mm.min(self.height_mm), self.width_mm.max(self.height_mm))
    }

    /// The paper turned so that its long side is across.
    pub fn landscape(self) -> Self {
        let Self { width_mm, height_mm } = self.portrait();
        Self::new(height_mm, width_mm)
    }
}

/// A piece of a roll; `turned`, the roll's width is the page's height.
pub fn roll_page(width_mm: f64, length_mm: f64, turned: bool) -> Paper {
    if turned {
        Paper::new(length_mm, width_mm)
    } else {
        Paper::new(width_mm, length_mm)
    }
}

impl FromStr for Paper {
    type Err = SheetError;

    /// A name (`a4`, `a3`, `letter`, `tabloid`) or `WIDTHxHEIGHT` in millimetres.
    fn from_str(text: &str) -> Result<Self, SheetError> {
        match text.to_ascii_lowercase().as_str() {
            "a4" => Ok(Self::A4),
            "a3" => Ok(Self::A3),
            "letter" => Ok(Self::LETTER),
            "tabloid" => Ok(Self::TABLOID),
            size => {
                let is_side = |mm: &f64| *mm > 0.0 && *mm <= MAX_SIDE_MM;
                let sides = two_lengths(size).filter(|(width, height)| is_side(width) && is_side(height));
                let (width_mm, height_mm) = sides.ok_or_else(|| SheetError::UnknownPaper { text: text.to_owned() })?;
                Ok(Self { width_mm, height_mm })
            }
        }
    }
}

/// What lies in the printer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stock {
    /// Cut sheets.
    Cut(Paper),
    /// A roll: its width is fixed, a page is as long as needed.
    Roll { width_mm: f64 },
}

impl Stock {
    /// The page, upright or `turned`; of a roll as long as a page can be.
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

    /// A [`Paper`], or `roll` and a width in millimetres, as in `roll610`.
    fn from_str(text: &str) -> Result<Self, SheetError> {
        let Some(width) = text.to_ascii_lowercase().strip_prefix("roll").map(str::to_owned) else {
            return Ok(Self::Cut(text.parse()?));
        };
        match width.trim().parse() {
            Ok(width_mm) if width_mm > 0.0 && width_mm <= MAX_SIDE_MM => Ok(Self::Roll { width_mm }),
            _ => Err(SheetError::UnknownPaper { text: text.to_owned() }),
        }
    }
}

/// Which way round the paper is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Orientation {
    /// Whichever needs fewer sheets; portrait if both need the same.
    #[default]
    Auto,
    /// The short side across.
    Portrait,
    /// The long side across.
    Landscape,
}

/// Reads `WIDTHxHEIGHT` in millimetres.
///
/// # Errors
/// Anything but two numbers with an `x` between them. Whether the numbers make sense is for the caller to say.
pub fn size_mm(text: &str) -> Result<(f64, f64), SheetError> {
    two_lengths(&text.to_ascii_lowercase()).ok_or_else(|| SheetError::UnknownSize { text: text.to_owned() })
}

fn two_lengths(text: &str) -> Option<(f64, f64)> {
    let (width, height) = text.split_once(['x', '×'])?;
    Some((width.trim().parse().ok()?, height.trim().parse().ok()?))
}
