//! Areas of a page with measured content: the part a printer can reach, the rulers, and the printer's correction.
//!
//! Everything is planned in the millimetres measured on paper. The stretch of a printer is corrected last, by [`crate::printer::corrected`];
//! the frame only reserves the room for it.

use super::paper::{MAX_SIDE_MM, Paper, Stock, roll_page};
use super::printer::Printer;
use super::sheet::{Mark, RectMm, Sheet};
use super::{SheetError, ruler};
use scaleproof_core::geometry::{Point2, length};
use scaleproof_plot::lettering::size;

/// Width of the free strip around the content for the crop marks.
pub const CROP_STRIP_MM: f64 = 5.5;
/// Height of the captions at the foot of the page.
pub const FOOTER_MM: f64 = 13.0;
/// Width of the block at the foot's right end with arrows, the sheet's id and the mini-map.
pub const KEY_WIDTH_MM: f64 = 18.0;
/// Gap between the end of the horizontal ruler and the key block: half a label and some air.
const RULER_END_MM: f64 = 3.0;

/// Space of a page outside its usable area: (across, down).
const TAKEN_MM: (f64, f64) = (
    ruler::DEPTH_MM + 2.0 * CROP_STRIP_MM,
    FOOTER_MM + ruler::DEPTH_MM + 2.0 * CROP_STRIP_MM,
);
/// Minimum printable size, for rulers and captions: (across, down).
const LEAST_MM: (f64, f64) = (
    ruler::DEPTH_MM + CROP_STRIP_MM + ruler::LENGTH_MM + RULER_END_MM + KEY_WIDTH_MM,
    TAKEN_MM.1 + ruler::LENGTH_MM,
);

/// Orientation and printer of a page of any size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PageSetup {
    /// Border of the paper that the printer cannot reach.
    pub margin_mm: f64,
    pub printer: Printer,
    /// True if the paper's short side, or the roll's width, runs along the page's y.
    pub turned: bool,
}

impl PageSetup {
    /// Returns drawn length over true length, along the page's x and y.
    pub fn stretch(&self) -> (f64, f64) {
        let (x, y) = self.printer.factors();
        if self.turned { (y, x) } else { (x, y) }
    }

    /// Returns the usable share of a page's reachable sides, so that neither the drawn nor the printed page exceeds them.
    fn share(&self) -> (f64, f64) {
        let (x, y) = self.stretch();
        (x.recip().min(1.0), y.recip().min(1.0))
    }
}

/// Page with its areas (page frame).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PageFrame {
    /// The paper as oriented: portrait or landscape.
    pub page: Paper,
    pub setup: PageSetup,
    /// Part of the page that a printer can reach.
    pub printable: RectMm,
    /// Part of the page for content; rulers, marks and captions stay outside it.
    pub usable: RectMm,
    /// Zero of the ruler along x; its ticks and labels are below.
    pub horizontal_ruler: Point2,
    /// Zero of the ruler along y; its ticks and labels are to the left.
    pub vertical_ruler: Point2,
}

impl PageFrame {
    /// Computes the areas of a page with this setup.
    pub fn new(page: Paper, setup: PageSetup) -> Result<Self, SheetError> {
        let margin_mm = length::strip_mm("margin", setup.margin_mm)?;
        let share = setup.share();
        let needed = (
            LEAST_MM.0 / share.0 + 2.0 * margin_mm,
            LEAST_MM.1 / share.1 + 2.0 * margin_mm,
        );
        if page.width_mm < needed.0 || page.height_mm < needed.1 {
            return Err(SheetError::PaperTooSmall {
                paper_mm: size((page.width_mm, page.height_mm)),
                margin_mm,
                needed_mm: size(needed),
            });
        }
        let border = |side: f64, share: f64| 0.5 * (side - (side - 2.0 * margin_mm) * share);
        let (x, y) = (border(page.width_mm, share.0), border(page.height_mm, share.1));
        let printable = RectMm::new(x, y, page.width_mm - x, page.height_mm - y);
        let usable = RectMm::new(
            printable.left_mm + ruler::DEPTH_MM + CROP_STRIP_MM,
            printable.bottom_mm + FOOTER_MM + ruler::DEPTH_MM + CROP_STRIP_MM,
            printable.right_mm - CROP_STRIP_MM,
            printable.top_mm - CROP_STRIP_MM,
        );
        Ok(Self {
            page,
            setup,
            printable,
            usable,
            horizontal_ruler: [usable.left_mm, usable.bottom_mm - CROP_STRIP_MM],
            vertical_ruler: [usable.left_mm - CROP_STRIP_MM, usable.bottom_mm],
        })
    }

    /// Returns the page itself or, for a roll, a piece just long enough for a usable area of this length.
    pub fn cut_off(self, stock: Stock, usable_mm: f64) -> Result<Self, SheetError> {
        match stock {
            Stock::Cut(_) => Ok(self),
            Stock::Roll { width_mm } => Self::new(cut_from_roll(width_mm, usable_mm, &self.setup), self.setup),
        }
    }

    pub fn whole(&self) -> RectMm {
        RectMm::new(0.0, 0.0, self.page.width_mm, self.page.height_mm)
    }

    /// Returns a rectangle of this size in the middle of the usable area.
    pub fn centred(&self, (width_mm, height_mm): (f64, f64)) -> RectMm {
        let left = self.usable.left_mm + (self.usable.width_mm() - width_mm) / 2.0;
        let bottom = self.usable.bottom_mm + (self.usable.height_mm() - height_mm) / 2.0;
        RectMm::sized([left, bottom], (width_mm, height_mm))
    }

    pub fn usable_size(&self) -> (f64, f64) {
        (self.usable.width_mm(), self.usable.height_mm())
    }

    pub fn sheet(&self, trim: RectMm, bleed: RectMm, marks: Vec<Mark>) -> Sheet {
        Sheet {
            width_mm: self.page.width_mm,
            height_mm: self.page.height_mm,
            trim,
            bleed,
            marks,
        }
    }
}

/// Returns a piece of a roll in whole millimetres, just long enough for a usable area of this length.
pub fn cut_from_roll(width_mm: f64, usable_mm: f64, setup: &PageSetup) -> Paper {
    let share = setup.share();
    let (taken, least, share) = if setup.turned {
        (TAKEN_MM.0, LEAST_MM.0, share.0)
    } else {
        (TAKEN_MM.1, LEAST_MM.1, share.1)
    };
    let length_mm = (usable_mm + taken).max(least) / share + 2.0 * setup.margin_mm;
    roll_page(width_mm, length_mm.ceil().min(MAX_SIDE_MM), setup.turned)
}
