//! A page for things that are not tiled: rulers along two edges, captions at the foot, and a free area between them.

use super::PrintError;
use super::lettering::{fitting_size_mm, printable};
use super::paper::{Orientation, Paper};
use super::printer::Printer;
use super::ruler;
use super::sheet::{Anchor, Mark, PointMm, RectMm, Sheet};
use super::template::{LayoutRequest, layout};

/// Border of the paper that office printers do not reach.
pub const MARGIN_MM: f64 = 5.0;

const CAPTION_MM: f64 = 2.5;
const LEADING_MM: f64 = 3.3;
const LABEL_MM: f64 = 5.0;
const LABEL_WIDTH_MM: f64 = 24.0;

/// Where things go on a page (page frame).
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    pub paper: Paper,
    pub printable: RectMm,
    /// The free area; rulers and captions stay outside it.
    pub usable: RectMm,
    horizontal_ruler: PointMm,
    vertical_ruler: PointMm,
}

impl Page {
    /// The areas of a paper used upright or across.
    ///
    /// # Errors
    /// Paper too small for the rulers.
    pub fn new(paper: Paper, orientation: Orientation) -> Result<Self, PrintError> {
        // The areas are the tiled template's, so that all pages of this program look alike.
        let areas = layout(&LayoutRequest {
            size_mm: (1.0, 1.0),
            paper: paper.into(),
            orientation,
            overlap_mm: 0.0,
            bleed_mm: 0.0,
            margin_mm: MARGIN_MM,
            printer: Printer::EXACT,
        })?
        .frame;
        Ok(Self {
            paper: areas.page,
            printable: areas.printable,
            usable: areas.usable,
            horizontal_ruler: areas.horizontal_ruler,
            vertical_ruler: areas.vertical_ruler,
        })
    }

    /// Upright and across, as far as the paper allows; never empty.
    ///
    /// # Errors
    /// Paper too small for the rulers either way.
    pub fn both_ways(paper: Paper) -> Result<Vec<Self>, PrintError> {
        let upright = Self::new(paper, Orientation::Portrait);
        let across = Self::new(paper, Orientation::Landscape);
        match (upright, across) {
            (Ok(upright), Ok(across)) => Ok(vec![upright, across]),
            (Ok(page), Err(_)) | (Err(_), Ok(page)) => Ok(vec![page]),
            (Err(e), Err(_)) => Err(e),
        }
    }

    /// A sheet with some marks, the rulers, captions at the foot (four lines at most) and a label in the corner.
    pub fn sheet(&self, marks: Vec<Mark>, captions: &[String], label: &str) -> Sheet {
        let mut all = marks;
        all.extend(ruler::horizontal(self.horizontal_ruler));
        all.extend(ruler::vertical(self.vertical_ruler));
        all.extend(self.captions(captions));
        all.push(self.label(label));
        Sheet {
            width_mm: self.paper.width_mm,
            height_mm: self.paper.height_mm,
            trim: self.printable,
            bleed: self.printable,
            marks: all,
        }
    }

    fn captions(&self, lines: &[String]) -> impl Iterator<Item = Mark> {
        let most_mm = self.printable.width_mm() - LABEL_WIDTH_MM;
        lines.iter().rev().enumerate().map(move |(i, line)| {
            let baseline = self.printable.bottom_mm + 0.8 + i as f64 * LEADING_MM;
            let line = printable(line);
            let size_mm = fitting_size_mm(&line, CAPTION_MM, most_mm);
            Mark::text((self.printable.left_mm, baseline), size_mm, Anchor::Left, line)
        })
    }

    fn label(&self, text: &str) -> Mark {
        let size_mm = fitting_size_mm(text, LABEL_MM, LABEL_WIDTH_MM - 2.0);
        let at = (self.printable.right_mm, self.printable.bottom_mm + 0.8);
        Mark::text(at, size_mm, Anchor::Right, text)
    }
}
