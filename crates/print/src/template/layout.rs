//! Layout of a template on sheets: the part of each sheet and its position on the paper. Geometry only, nothing is drawn here.
//!
//! Two frames, both in millimetres. *Template frame*: origin at the template's top-left corner, x right, y **down**, as the
//! pattern's rows run. *Page frame*: see [`crate::sheet`], y up.

use crate::SheetError;
use crate::frame::PageFrame;
use crate::media::Media;
use crate::paper::{MAX_SIDE_MM, Orientation, Stock};
use crate::sheet::RectMm;
use scaleproof_core::geometry::{Point2, length};
use scaleproof_plot::lettering::size;

/// Maximum number of sheets; a van of life size on A4 takes fewer, more are a mistake in the numbers.
pub const MAX_SHEETS: usize = 2000;

/// Maximum side: all sheets of the longest paper in a row.
const MOST_MM: f64 = MAX_SHEETS as f64 * MAX_SIDE_MM;

/// Usable length of the instructions page on a roll.
pub const ROLL_COVER_MM: f64 = 160.0;

/// Size and media of a template. All lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutRequest {
    /// Width and height of the whole template.
    pub size_mm: (f64, f64),
    /// Paper, printer and date.
    pub media: Media,
    /// Orientation of the sheets.
    pub orientation: Orientation,
    /// Width of the strip that a sheet shares with its right and its lower neighbour, for gluing.
    pub overlap_mm: f64,
    /// Extension of the pattern beyond the template's outer edge, so that an imprecise cut shows no paper.
    pub bleed_mm: f64,
}

/// Rectangle in the template frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TemplateRect {
    pub left_mm: f64,
    pub top_mm: f64,
    pub right_mm: f64,
    pub bottom_mm: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct SheetPlan {
    /// Row, from 0 at the top.
    pub row: usize,
    /// Column, from 0 at the left.
    pub column: usize,
    /// Part of the template that only this sheet shows once all are glued. These parts tile the template exactly: neighbours have bit-equal edges.
    pub own: TemplateRect,
    /// `own` with the overlap under the right and the lower neighbour, and the bleed beyond the template's edges.
    pub carried: TemplateRect,
    /// Area of `own` on the paper (page frame): the sheet is cut here.
    pub trim: RectMm,
    /// Area of `carried` on the paper (page frame).
    pub printed: RectMm,
}

#[derive(Debug, Clone, PartialEq)]
pub struct SheetLayout {
    pub frame: PageFrame,
    /// Page with the instructions: as the sheets, or a short piece of the roll.
    pub cover: PageFrame,
    pub rows: usize,
    pub columns: usize,
    /// Row by row from the top left.
    pub sheets: Vec<SheetPlan>,
}

/// Distributes a template over the fewest sheets. All sheets have parts of equal size, so that none is a sliver.
pub fn layout(request: &LayoutRequest) -> Result<SheetLayout, SheetError> {
    check(request)?;
    let mut layout = match request.orientation {
        Orientation::Portrait => spread(request, false)?,
        Orientation::Landscape => spread(request, true)?,
        Orientation::Auto => match (spread(request, false), spread(request, true)) {
            (Ok(upright), Ok(across)) if across.cost() < upright.cost() => across,
            (Ok(layout), _) | (Err(_), Ok(layout)) => layout,
            (Err(e), Err(_)) => return Err(e),
        },
    };
    if matches!(request.media.paper, Stock::Roll { .. }) {
        layout.cover.setup.turned = false;
        layout.cover = layout.cover.cut_off(request.media.paper, ROLL_COVER_MM)?;
    }
    Ok(layout)
}

fn check(request: &LayoutRequest) -> Result<(), SheetError> {
    let (width, height) = request.size_mm;
    // Tested before the bounds of a length, since too many sheets is the clearer reason.
    if [width, height].iter().any(|side| side.is_finite() && *side > MOST_MM) {
        return Err(SheetError::TooManySheets { most: MAX_SHEETS });
    }
    length::size_mm("template width", width)?;
    length::size_mm("template height", height)?;
    length::strip_mm("overlap", request.overlap_mm)?;
    length::strip_mm("bleed", request.bleed_mm)?;
    Ok(())
}

/// Lays the template out on the paper used upright or `turned`.
fn spread(request: &LayoutRequest, turned: bool) -> Result<SheetLayout, SheetError> {
    let frame = request.media.frame(turned)?;
    let (columns, rows) = sheets(request, &frame)?;
    let (overlap_mm, bleed_mm) = (request.overlap_mm, request.bleed_mm);
    let (total, count) = if turned {
        (request.size_mm.0, columns)
    } else {
        (request.size_mm.1, rows)
    };
    let frame = frame.cut_off(request.media.paper, carried_mm(total, count, overlap_mm, bleed_mm))?;
    let x = cuts(request.size_mm.0, columns, overlap_mm, bleed_mm);
    let y = cuts(request.size_mm.1, rows, overlap_mm, bleed_mm);
    Ok(SheetLayout::cut_at(frame, &x, &y, [0.0, overlap_mm, bleed_mm]))
}

/// Returns the number of sheets: (across, down).
fn sheets(request: &LayoutRequest, frame: &PageFrame) -> Result<(usize, usize), SheetError> {
    let (across, down) = (frame.usable.width_mm(), frame.usable.height_mm());
    let (overlap_mm, bleed_mm) = (request.overlap_mm, request.bleed_mm);
    // With both bleeds beside the overlap, every sheet is sure to have a part of its own.
    if overlap_mm + 2.0 * bleed_mm >= across.min(down) {
        return Err(SheetError::OverlapTooLarge {
            overlap_mm,
            bleed_mm,
            usable_mm: size((across, down)),
        });
    }
    let columns = sheets_along(request.size_mm.0 + 2.0 * bleed_mm, across, overlap_mm);
    let rows = sheets_along(request.size_mm.1 + 2.0 * bleed_mm, down, overlap_mm);
    // Compared before the conversion to an integer, which the longest template on almost no usable area would overflow.
    if columns * rows > MAX_SHEETS as f64 {
        return Err(SheetError::TooManySheets { most: MAX_SHEETS });
    }
    Ok((columns as usize, rows as usize))
}

/// Returns the smallest number of sheets `n` with `n · usable − (n − 1) · overlap ≥ size`, both bleeds included in the size.
fn sheets_along(size_mm: f64, usable_mm: f64, overlap_mm: f64) -> f64 {
    // A tolerance of a millionth of a millimetre, so that rounding does not cost a template made to measure a sheet.
    let exact = (size_mm - overlap_mm) / (usable_mm - overlap_mm);
    (exact - 1e-6 / usable_mm).ceil().max(1.0)
}

/// Returns the area of a region on the page of the sheet with `carried`, whose top-left corner is the usable area's.
fn on_page(frame: &PageFrame, carried: TemplateRect, region: TemplateRect) -> RectMm {
    let x = |template_mm: f64| frame.usable.left_mm + (template_mm - carried.left_mm);
    let y = |template_mm: f64| frame.usable.top_mm - (template_mm - carried.top_mm);
    RectMm::new(
        x(region.left_mm),
        y(region.bottom_mm),
        x(region.right_mm),
        y(region.top_mm),
    )
}

/// Returns the length each of `sheets` sheets carries along one axis, with its overlap and bleed.
fn carried_mm(size_mm: f64, sheets: usize, overlap_mm: f64, bleed_mm: f64) -> f64 {
    (size_mm + 2.0 * bleed_mm + (sheets - 1) as f64 * overlap_mm) / sheets as f64
}

/// Returns the cuts of the template along one axis, from 0 to its size, so that every sheet carries the same length.
fn cuts(size_mm: f64, sheets: usize, overlap_mm: f64, bleed_mm: f64) -> Vec<f64> {
    let step = carried_mm(size_mm, sheets, overlap_mm, bleed_mm) - overlap_mm;
    let inner = (1..sheets).map(|i| i as f64 * step - bleed_mm);
    [0.0].into_iter().chain(inner).chain([size_mm]).collect()
}

impl SheetLayout {
    /// Returns sheets cut at given edges, ascending from 0 along each axis; the first and the last are the template's own. Every sheet must have room
    /// for its own part and strips towards the sheets `before` and `after` it along each axis, or an `outer` one at the template's edge.
    pub fn cut_at(frame: PageFrame, x: &[f64], y: &[f64], [before, after, outer]: [f64; 3]) -> Self {
        let (columns, rows) = (x.len().saturating_sub(1), y.len().saturating_sub(1));
        let before = |i: usize| if i == 0 { outer } else { before };
        let after = |is_last: bool| if is_last { outer } else { after };
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let sheet = |(row, column): (usize, usize)| {
            let own = TemplateRect {
                left_mm: x[column],
                top_mm: y[row],
                right_mm: x[column + 1],
                bottom_mm: y[row + 1],
            };
            let carried = TemplateRect {
                left_mm: own.left_mm - before(column),
                top_mm: own.top_mm - before(row),
                right_mm: own.right_mm + after(column + 1 == columns),
                bottom_mm: own.bottom_mm + after(row + 1 == rows),
            };
            SheetPlan {
                row,
                column,
                own,
                carried,
                trim: on_page(&frame, carried, own),
                printed: on_page(&frame, carried, carried),
            }
        };
        Self {
            frame,
            cover: frame,
            rows,
            columns,
            sheets: places.map(sheet).collect(),
        }
    }

    /// Returns the number of sheets, then the paper area: on a roll one sheet may do in both orientations.
    fn cost(&self) -> (usize, f64) {
        let (sheets, page) = (self.sheets.len(), self.frame.page);
        (sheets, page.width_mm * page.height_mm * sheets as f64)
    }

    pub fn size_mm(&self) -> (f64, f64) {
        let owns = || self.sheets.iter().map(|plan| plan.own);
        (
            owns().map(|own| own.right_mm).fold(1e-3, f64::max),
            owns().map(|own| own.bottom_mm).fold(1e-3, f64::max),
        )
    }

    /// Returns the seam letters of a sheet. Seams are lettered row by row: those between the sheets of a row, then those to the row below.
    pub fn seams(&self, row: usize, column: usize) -> SheetSeams {
        let row_starts = |row: usize| row * (2 * self.columns - 1);
        let right_of = |row: usize, column: usize| letters(row_starts(row) + column);
        let below = |row: usize, column: usize| letters(row_starts(row) + self.columns - 1 + column);
        SheetSeams {
            left: (column > 0 && self.has(row, column - 1)).then(|| right_of(row, column - 1)),
            right: self.has(row, column + 1).then(|| right_of(row, column)),
            above: (row > 0 && self.has(row - 1, column)).then(|| below(row - 1, column)),
            below: self.has(row + 1, column).then(|| below(row, column)),
        }
    }

    /// Returns true if a sheet is printed; an empty one may be left out.
    pub fn has(&self, row: usize, column: usize) -> bool {
        self.sheets.iter().any(|plan| (plan.row, plan.column) == (row, column))
    }
}

/// Letters of the seams around a sheet; the neighbour across a seam has the same letter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetSeams {
    pub left: Option<String>,
    pub right: Option<String>,
    pub above: Option<String>,
    pub below: Option<String>,
}

impl SheetPlan {
    /// Converts a point of the template with y turned up, (x, −y) of the template frame, to the page.
    pub fn on_page(&self, [x, y]: Point2) -> Point2 {
        [
            self.printed.left_mm + x - self.carried.left_mm,
            self.printed.top_mm + y + self.carried.top_mm,
        ]
    }

    /// Returns row letter and column number, as in `B2`. After row Z comes AA.
    pub fn id(&self) -> String {
        format!("{}{}", letters(self.row), self.column + 1)
    }
}

/// Returns the letters of an index: A to Z, then AA.
pub fn letters(index: usize) -> String {
    let last = char::from(b'A' + (index % 26) as u8);
    if index < 26 {
        last.to_string()
    } else {
        format!("{}{last}", letters(index / 26 - 1))
    }
}
