//! Paper, printer and date of a print.

use super::SheetError;
use super::date::Date;
use super::frame::{PageFrame, PageSetup};
use super::paper::Stock;
use super::printer::Printer;
use super::sheet::RectMm;

/// Border of the paper that office printers cannot reach.
pub const MARGIN_MM: f64 = 5.0;

/// Paper, printer and date of a print.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Media {
    pub paper: Stock,
    /// Border of the paper that the printer cannot reach.
    pub margin_mm: f64,
    /// Measured stretch of the printer, which is corrected.
    pub printer: Printer,
    /// Date for the captions, if given; the clock is never read, so that the same input gives the same bytes.
    pub date: Option<Date>,
}

impl Media {
    /// Creates media of a paper with the usual margin, and an unmeasured printer.
    pub fn new(paper: impl Into<Stock>) -> Self {
        Self {
            paper: paper.into(),
            margin_mm: MARGIN_MM,
            printer: Printer::EXACT,
            date: None,
        }
    }

    /// Checks that the paper is a cut sheet, for content that must lie on one.
    ///
    /// # Errors
    /// A roll.
    pub fn check_is_cut(&self) -> Result<(), SheetError> {
        match self.paper {
            Stock::Cut(_) => Ok(()),
            Stock::Roll { .. } => Err(SheetError::Roll),
        }
    }

    /// Returns the setup of a page that is used upright or `turned`.
    pub fn setup(&self, turned: bool) -> PageSetup {
        PageSetup {
            margin_mm: self.margin_mm,
            printer: self.printer,
            turned,
        }
    }

    /// Returns the frame of the paper used upright or `turned`. A roll's page is as long as a page can be; [`PageFrame::cut_off`] shortens it.
    ///
    /// # Errors
    /// A margin that is no length, paper too small for the rulers.
    pub fn frame(&self, turned: bool) -> Result<PageFrame, SheetError> {
        PageFrame::new(self.paper.page(turned), self.setup(turned))
    }

    /// Returns the frames of the paper used upright and across, as far as the paper allows; never empty.
    ///
    /// # Errors
    /// Paper too small for the rulers either way.
    pub fn both_ways(self) -> Result<Vec<PageFrame>, SheetError> {
        let [upright, across] = [false, true].map(|turned| self.frame(turned));
        match upright {
            Ok(upright) => Ok([upright].into_iter().chain(across).collect()),
            Err(error) => across.map(|across| vec![across]).map_err(|_| error),
        }
    }

    /// Returns a page with room for a width and height with `quiet_mm` around it, and the centred area; `None` if neither orientation has room.
    ///
    /// # Errors
    /// Paper too small for the rulers.
    pub fn with_room(
        self,
        (width_mm, height_mm): (f64, f64),
        quiet_mm: f64,
    ) -> Result<Option<(PageFrame, RectMm)>, SheetError> {
        let fits = |page: &PageFrame| {
            let (free_width, free_height) = page.usable_size();
            width_mm <= free_width - 2.0 * quiet_mm && height_mm <= free_height - 2.0 * quiet_mm
        };
        let page = self.both_ways()?.into_iter().find(fits);
        Ok(page.map(|page| (page, page.centred((width_mm, height_mm)))))
    }
}
