//! A page for things that are not tiled: rulers along two edges, captions at the foot, and a free area between them.

use super::SheetError;
use super::frame::{PageFrame, PageSetup};
use super::paper::{MAX_SIDE_MM, Orientation, Stock};
use super::printer::{Printer, corrected_one};
use super::sheet::{Mark, RectMm, Sheet, TextAnchor};
use super::template::layout::{cut_from_roll, roll_page};
use super::template::rulers;
use scaleproof_plot::lettering::{fitting_size_mm, printable};

/// Border of the paper that office printers do not reach.
pub const MARGIN_MM: f64 = 5.0;

const CAPTION_MM: f64 = 2.5;
const LEADING_MM: f64 = 3.3;
const LABEL_MM: f64 = 5.0;
const LABEL_WIDTH_MM: f64 = 24.0;

/// What is printed on, and by what.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Media {
    pub paper: Stock,
    pub printer: Printer,
}

impl Media {
    /// # Errors
    /// A roll, for what must lie on one cut sheet.
    pub fn check_is_cut(&self) -> Result<(), SheetError> {
        match self.paper {
            Stock::Cut(_) => Ok(()),
            Stock::Roll { .. } => Err(SheetError::Roll),
        }
    }
}

/// A page that is drawn on freely: its frame's usable area is for the content.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreePage(pub PageFrame);

impl FreePage {
    /// The areas of a paper used upright or across. A roll's page is as long as a page can be; [`FreePage::shortened`] cuts it off.
    ///
    /// # Errors
    /// Paper too small for the rulers.
    pub fn new(media: Media, orientation: Orientation) -> Result<Self, SheetError> {
        let turned = orientation == Orientation::Landscape;
        let setup = PageSetup {
            margin_mm: MARGIN_MM,
            printer: media.printer,
            turned,
        };
        let page = match media.paper {
            Stock::Cut(paper) if turned => paper.landscape(),
            Stock::Cut(paper) => paper.portrait(),
            Stock::Roll { width_mm } => roll_page(width_mm, MAX_SIDE_MM, turned),
        };
        Ok(Self(PageFrame::new(page, setup)?))
    }

    /// The page itself, or a piece of the roll that is just long enough for a usable area of this length.
    ///
    /// # Errors
    /// Paper too small for the rulers.
    pub fn shortened(self, media: Media, usable_mm: f64) -> Result<Self, SheetError> {
        let Stock::Roll { width_mm } = media.paper else {
            return Ok(self);
        };
        let setup = self.0.setup;
        Ok(Self(PageFrame::new(cut_from_roll(width_mm, usable_mm, &setup), setup)?))
    }

    /// Upright and across, as far as the paper allows; never empty.
    ///
    /// # Errors
    /// Paper too small for the rulers either way.
    pub fn both_ways(media: Media) -> Result<Vec<Self>, SheetError> {
        let upright = Self::new(media, Orientation::Portrait);
        let across = Self::new(media, Orientation::Landscape);
        match (upright, across) {
            (Ok(upright), Ok(across)) => Ok(vec![upright, across]),
            (Ok(page), Err(_)) | (Err(_), Ok(page)) => Ok(vec![page]),
            (Err(e), Err(_)) => Err(e),
        }
    }

    /// A sheet with some marks, the rulers, captions at the foot (four lines at most) and a label in the corner, drawn so that it
    /// comes out of the printer in true size.
    pub fn sheet(&self, marks: Vec<Mark>, captions: &[String], label: &str) -> Sheet {
        self.cut_sheet(self.0.printable, marks, captions, label)
    }

    /// A sheet like that of [`Self::sheet`], but cut out at `trim`.
    pub fn cut_sheet(&self, trim: RectMm, marks: Vec<Mark>, captions: &[String], label: &str) -> Sheet {
        let frame = &self.0;
        let mut all = marks;
        all.extend(rulers(frame));
        all.extend(self.captions(captions));
        all.push(self.label(label));
        corrected_one(frame.sheet(trim, trim, all), frame.setup.stretch())
    }

    fn captions(&self, lines: &[String]) -> impl Iterator<Item = Mark> {
        let most_mm = self.0.printable.width_mm() - LABEL_WIDTH_MM;
        lines.iter().rev().enumerate().map(move |(i, line)| {
            let baseline = self.0.printable.bottom_mm + 0.8 + i as f64 * LEADING_MM;
            let line = printable(line);
            let size_mm = fitting_size_mm(&line, CAPTION_MM, most_mm);
            Mark::text((self.0.printable.left_mm, baseline), size_mm, TextAnchor::Left, line)
        })
    }

    fn label(&self, text: &str) -> Mark {
        let size_mm = fitting_size_mm(text, LABEL_MM, LABEL_WIDTH_MM - 2.0);
        let at = (self.0.printable.right_mm, self.0.printable.bottom_mm + 0.8);
        Mark::text(at, size_mm, TextAnchor::Right, text)
    }
}
