//! Which part of a template each sheet carries and where it sits on the paper: geometry only, nothing is drawn here.
//!
//! Two frames, both in millimetres. *Template frame*: origin at the template's top-left corner, x right, y **down**, as the
//! pattern's rows run. *Page frame*: see [`crate::print::sheet`], y up.

use crate::print::PrintError;
use crate::print::lettering::number;
use crate::print::paper::{Orientation, Paper};
use crate::print::ruler;
use crate::print::sheet::{PointMm, RectMm};

/// More sheets than this are a mistake in the numbers, not a plan.
pub const MAX_SHEETS: usize = 400;

/// Free strip around the pattern in which the crop marks stand.
pub const CROP_STRIP_MM: f64 = 5.5;
/// Height of the captions at the foot of the page.
pub const FOOTER_MM: f64 = 13.0;
/// Width of the block at the foot's right end that holds the sheet's id and the mini-map.
pub const KEY_WIDTH_MM: f64 = 18.0;
/// From the end of the horizontal ruler to the key block: half a label and some air.
const RULER_END_MM: f64 = 3.0;

/// What the pages must carry and what they are printed on. All lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutRequest {
    /// Width and height of the whole template.
    pub size_mm: (f64, f64),
    pub paper: Paper,
    pub orientation: Orientation,
    /// Width of the strip that a sheet shares with its right and its lower neighbour, for gluing.
    pub overlap_mm: f64,
    /// Border of the paper that the printer cannot reach.
    pub margin_mm: f64,
}

/// A rectangle in the template frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    pub left_mm: f64,
    pub top_mm: f64,
    pub right_mm: f64,
    pub bottom_mm: f64,
}

/// One sheet of a template.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetPlan {
    /// From 0, from the top.
    pub row: usize,
    /// From 0, from the left.
    pub column: usize,
    /// The part of the template that only this sheet shows once all are glued. These tile the template exactly:
    /// neighbours have bit-equal edges.
    pub own: Region,
    /// `own` and the overlap under the right and the lower neighbour.
    pub carried: Region,
    /// Where `own` sits on the paper (page frame): the sheet is cut here.
    pub trim: RectMm,
    /// Where `carried` sits on the paper (page frame).
    pub printed: RectMm,
}

/// A template spread over sheets.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// The paper as it is used: portrait or landscape.
    pub page: Paper,
    /// The part of the page a printer can reach (page frame).
    pub printable: RectMm,
    /// The part of the page that may carry pattern (page frame); rulers, marks and captions stay outside it.
    pub usable: RectMm,
    /// Zero of the ruler along x (page frame); its ticks and labels hang below.
    pub horizontal_ruler: PointMm,
    /// Zero of the ruler along y (page frame); its ticks and labels stand to the left.
    pub vertical_ruler: PointMm,
    pub rows: usize,
    pub columns: usize,
    /// Row by row from the top left.
    pub sheets: Vec<SheetPlan>,
}

/// Spreads a template over the fewest sheets. All sheets carry equally large pieces, so that none is a sliver.
///
/// # Errors
/// Lengths that are not positive and finite, paper too small for the rulers, an overlap as large as the usable area, more
/// than [`MAX_SHEETS`] sheets.
pub fn layout(request: &LayoutRequest) -> Result<Layout, PrintError> {
    check(request)?;
    let (portrait, landscape) = (request.paper.portrait(), request.paper.landscape());
    let plan = match request.orientation {
        Orientation::Portrait => plan(request, portrait)?,
        Orientation::Landscape => plan(request, landscape)?,
        Orientation::Auto => better(plan(request, portrait), plan(request, landscape))?,
    };
    Ok(plan.into_layout(request))
}

fn check(request: &LayoutRequest) -> Result<(), PrintError> {
    let refuse = |what, value, wanted| Err(PrintError::BadNumber { what, value, wanted });
    for (what, side) in [
        ("template width", request.size_mm.0),
        ("template height", request.size_mm.1),
    ] {
        if !(side > 0.0 && side.is_finite()) {
            return refuse(what, side, "a width and height above 0 mm");
        }
    }
    for (what, strip) in [("overlap", request.overlap_mm), ("margin", request.margin_mm)] {
        if !(strip >= 0.0 && strip.is_finite()) {
            return refuse(what, strip, "0 mm or more");
        }
    }
    Ok(())
}

/// A page and the number of sheets along each axis.
struct Plan {
    page: Paper,
    printable: RectMm,
    usable: RectMm,
    columns: usize,
    rows: usize,
}

fn better(portrait: Result<Plan, PrintError>, landscape: Result<Plan, PrintError>) -> Result<Plan, PrintError> {
    match (portrait, landscape) {
        (Ok(p), Ok(l)) => Ok(if l.columns * l.rows < p.columns * p.rows { l } else { p }),
        (Ok(plan), Err(_)) | (Err(_), Ok(plan)) => Ok(plan),
        (Err(e), Err(_)) => Err(e),
    }
}

fn plan(request: &LayoutRequest, page: Paper) -> Result<Plan, PrintError> {
    let (printable, usable) = areas(page, request.margin_mm)?;
    let (across, down) = (usable.width_mm(), usable.height_mm());
    if request.overlap_mm >= across.min(down) {
        let usable_mm = format!("{} × {}", number(across), number(down));
        return Err(PrintError::OverlapTooLarge {
            overlap_mm: request.overlap_mm,
            usable_mm,
        });
    }
    let columns = sheets_along(request.size_mm.0, across, request.overlap_mm);
    let rows = sheets_along(request.size_mm.1, down, request.overlap_mm);
    // Compared before it becomes an integer: a template of 1e300 mm must not overflow.
    if columns * rows > MAX_SHEETS as f64 {
        return Err(PrintError::TooManySheets { most: MAX_SHEETS });
    }
    Ok(Plan {
        page,
        printable,
        usable,
        columns: columns as usize,
        rows: rows as usize,
    })
}

/// The printable and the usable area of a page (page frame).
fn areas(page: Paper, margin_mm: f64) -> Result<(RectMm, RectMm), PrintError> {
    let needed_width =
        2.0 * margin_mm + ruler::DEPTH_MM + CROP_STRIP_MM + ruler::LENGTH_MM + RULER_END_MM + KEY_WIDTH_MM;
    let needed_height = 2.0 * margin_mm + FOOTER_MM + ruler::DEPTH_MM + 2.0 * CROP_STRIP_MM + ruler::LENGTH_MM;
    if page.width_mm < needed_width || page.height_mm < needed_height {
        return Err(PrintError::PaperTooSmall {
            paper_mm: format!("{} × {}", number(page.width_mm), number(page.height_mm)),
            margin_mm,
            needed_mm: format!("{} × {}", number(needed_width), number(needed_height)),
        });
    }
    let printable = RectMm::new(
        margin_mm,
        margin_mm,
        page.width_mm - margin_mm,
        page.height_mm - margin_mm,
    );
    let usable = RectMm::new(
        printable.left_mm + ruler::DEPTH_MM + CROP_STRIP_MM,
        printable.bottom_mm + FOOTER_MM + ruler::DEPTH_MM + CROP_STRIP_MM,
        printable.right_mm - CROP_STRIP_MM,
        printable.top_mm - CROP_STRIP_MM,
    );
    Ok((printable, usable))
}

/// The fewest sheets `n` with `n · usable − (n − 1) · overlap ≥ size`.
fn sheets_along(size_mm: f64, usable_mm: f64, overlap_mm: f64) -> f64 {
    // A millionth of a millimetre of slack, so that a template made to measure does not cost a sheet to rounding.
    let exact = (size_mm - overlap_mm) / (usable_mm - overlap_mm);
    (exact - 1e-6 / usable_mm).ceil().max(1.0)
}

impl Plan {
    fn into_layout(self, request: &LayoutRequest) -> Layout {
        let x = cuts(request.size_mm.0, self.columns, request.overlap_mm);
        let y = cuts(request.size_mm.1, self.rows, request.overlap_mm);
        let places = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (row, column)));
        let sheets = places
            .map(|(row, column)| {
                let own = Region {
                    left_mm: x[column],
                    top_mm: y[row],
                    right_mm: x[column + 1],
                    bottom_mm: y[row + 1],
                };
                let carried = Region {
                    right_mm: (own.right_mm + request.overlap_mm).min(request.size_mm.0),
                    bottom_mm: (own.bottom_mm + request.overlap_mm).min(request.size_mm.1),
                    ..own
                };
                let (trim, printed) = (self.on_page(own, own), self.on_page(own, carried));
                SheetPlan {
                    row,
                    column,
                    own,
                    carried,
                    trim,
                    printed,
                }
            })
            .collect();
        let Self {
            page,
            printable,
            usable,
            columns,
            rows,
        } = self;
        let horizontal_ruler = PointMm::new(usable.left_mm, usable.bottom_mm - CROP_STRIP_MM);
        let vertical_ruler = PointMm::new(usable.left_mm - CROP_STRIP_MM, usable.bottom_mm);
        Layout {
            page,
            printable,
            usable,
            horizontal_ruler,
            vertical_ruler,
            rows,
            columns,
            sheets,
        }
    }

    /// Where a region sits on the page of the sheet whose own region is `own`: its top-left corner is that of the usable area.
    fn on_page(&self, own: Region, region: Region) -> RectMm {
        let x = |template_mm: f64| self.usable.left_mm + (template_mm - own.left_mm);
        let y = |template_mm: f64| self.usable.top_mm - (template_mm - own.top_mm);
        RectMm::new(
            x(region.left_mm),
            y(region.bottom_mm),
            x(region.right_mm),
            y(region.top_mm),
        )
    }
}

/// Where the template is cut along one axis, from 0 to its size, so that every sheet carries equally much with its overlap.
fn cuts(size_mm: f64, sheets: usize, overlap_mm: f64) -> Vec<f64> {
    let carried = (size_mm + (sheets - 1) as f64 * overlap_mm) / sheets as f64;
    let inner = (0..sheets).map(|i| i as f64 * (carried - overlap_mm));
    inner.chain([size_mm]).collect()
}

impl SheetPlan {
    /// Row letter and column number, as in `B2`. After row Z comes AA.
    pub fn id(&self) -> String {
        format!("{}{}", row_letters(self.row), self.column + 1)
    }
}

fn row_letters(row: usize) -> String {
    let last = char::from(b'A' + (row % 26) as u8);
    if row < 26 {
        last.to_string()
    } else {
        format!("{}{last}", row_letters(row / 26 - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(size_mm: (f64, f64)) -> LayoutRequest {
        LayoutRequest {
            size_mm,
            paper: Paper::A4,
            orientation: Orientation::Auto,
            overlap_mm: 8.0,
            margin_mm: 5.0,
        }
    }

    #[test]
    fn the_fewest_sheets_win() {
        let wide = layout(&request((260.0, 160.0))).unwrap();
        assert_eq!((wide.sheets.len(), wide.page), (1, Paper::A4.landscape()));
        let tall = layout(&request((160.0, 240.0))).unwrap();
        assert_eq!((tall.sheets.len(), tall.page), (1, Paper::A4));
    }

    #[test]
    fn a_template_made_to_measure_needs_one_sheet() {
        let usable = layout(&request((10.0, 10.0))).unwrap().usable;
        assert_eq!(
            layout(&request((usable.width_mm(), usable.height_mm())))
                .unwrap()
                .sheets
                .len(),
            1
        );
    }

    #[test]
    fn rows_have_letters() {
        let letters: Vec<_> = [0, 1, 25, 26, 51, 52, 399].map(row_letters).into();
        assert_eq!(letters, ["A", "B", "Z", "AA", "AZ", "BA", "OJ"]);
    }
}
