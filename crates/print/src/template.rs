//! Tiled template: a repeated pattern at true size, on sheets that are cut, overlapped and glued.

pub mod cover;
pub(super) mod furniture;
pub mod layout;
mod request;

pub use request::{Front, TemplateRequest};

use std::sync::Arc;

use image::RgbImage;

pub use furniture::{Captions, around, guides, making, rulers};
pub use layout::LayoutRequest;
pub use layout::{MAX_SHEETS, SheetLayout, SheetPlan, TemplateRect, layout, letters};

use super::sheet::{Fill, Mark, RectMm, Sheet, Stamp};
use super::{SheetError, printer};
use scaleproof_core::geometry::Point2;
use scaleproof_core::geometry::length::{SCALES, shown};
use scaleproof_plot::lettering::number;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::area::averaged;
use scaleproof_surface::pattern::picture::Picture;

/// Minimum size of a cell; smaller ones are illegible from an office printer (about 5 dots at 600 dpi).
pub const MIN_CELL_MM: f64 = 0.2;
const MM_PER_INCH: f64 = 25.4;
/// Minimum repeat of a texture; a smaller one looks like a single colour.
const LEAST_REPEAT_MM: f64 = 1.0;
/// Maximum repeat: twice a full-size car. Beyond it the numbers of a PDF lose their hundredths of a millimetre.
pub const MAX_TILE_MM: f64 = 10_000.0;

/// Length up to which a stamp combines repeats, so that tiny patterns do not fill the file with placements.
const STAMP_MM: f64 = 50.0;
/// Maximum number of placements; more fill hundreds of megabytes: 2400 m² of pattern on the largest sheets.
const MOST_PLACEMENTS: f64 = 1e6;

/// Reason why no template was printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TemplateError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(
        "tile width cannot be {}; give the printed width of one repeat of the pattern, above 0 and up to 10000 mm",
        shown(*tile_mm)
    )]
    TileWidth { tile_mm: f64 },
    #[error("scale cannot be {}; give 10 for a 1:10 model, from 0.01 to 10000", shown(*scale))]
    Scale { scale: f64 },
    #[error(
        "a cell would be {cell_mm:.3} mm, smaller than the {MIN_CELL_MM} mm a printer can show; use a larger tile or fewer cells"
    )]
    CellTooSmall { cell_mm: f64 },
    #[error(
        "the pattern would be placed {count:.0} times, more than {MOST_PLACEMENTS:.0}; use a larger tile, a smaller size, or less overlap and bleed"
    )]
    TooManyPlacements { count: f64 },
    #[error("one repeat of the texture would be {width} × {height} mm; make it wider, so that both are 1 mm or more")]
    TextureTooSmall { width: String, height: String },
    #[error("a texture cannot be printed at {} dots per inch; give 36 to 2400", shown(*dpi))]
    Resolution { dpi: f64 },
}

/// Drawn template, and its layout on the paper.
#[derive(Debug, Clone)]
pub struct Template {
    /// Part of the template on each sheet.
    pub layout: SheetLayout,
    /// Width and height of a cell, or of a texture's pixel, mm.
    pub cell_mm: f64,
    /// Assembly instructions with the scale check; then one page per `SheetLayout::sheets`, in the same order. Corrected for the printer.
    pub pages: Vec<Sheet>,
}

impl Template {
    /// Returns a name for each page, used if it becomes a file of its own.
    pub fn page_names(&self) -> Vec<String> {
        let ids = self.layout.sheets.iter().map(SheetPlan::id);
        ["assembly".to_owned()].into_iter().chain(ids).collect()
    }
}

/// Draws the sheets of a template. The pattern's top-left cell starts at the template's top-left corner.
///
/// # Errors
/// Numbers that are not positive, cells below `MIN_CELL_MM`, more placements of the pattern than a file can hold, and whatever
/// `layout` refuses.
pub fn template(pattern: &Pattern, request: &TemplateRequest) -> Result<Template, TemplateError> {
    let cell_mm = cell_mm(pattern, request)?;
    let stamp = PatternStamp::new(pattern, cell_mm, request.layout.size_mm);
    drawn(&stamp, &Captions::new(pattern, request, cell_mm), cell_mm, request)
}

/// Draws the sheets of a texture without cells: a repeated image of at most `dpi` pixels per inch.
pub fn texture_template(texture: &Picture, dpi: f64, request: &TemplateRequest) -> Result<Template, TemplateError> {
    let tile_mm = check_tile(request)?;
    if !(36.0..=2400.0).contains(&dpi) {
        return Err(TemplateError::Resolution { dpi });
    }
    let repeat_mm = (tile_mm, texture.height_for(tile_mm));
    if repeat_mm.0 < LEAST_REPEAT_MM || repeat_mm.1 < LEAST_REPEAT_MM {
        return Err(TemplateError::TextureTooSmall {
            width: number(repeat_mm.0),
            height: number(repeat_mm.1),
        });
    }
    let repeat = resampled(texture, repeat_mm, dpi);
    let pixel_mm = tile_mm / f64::from(repeat.width());
    let stamp = PatternStamp::from_image(&repeat, repeat_mm, request.layout.size_mm);
    let captions = Captions::from_texture(texture, request, pixel_mm);
    drawn(&stamp, &captions, pixel_mm, request)
}

/// Resamples one repeat of this width and height to pixels of the mean light of their areas; an image with fewer pixels is unchanged.
fn resampled(texture: &Picture, (width_mm, height_mm): (f64, f64), dpi: f64) -> Arc<RgbImage> {
    let (width, height) = texture.pixels.dimensions();
    let most = |mm: f64| (mm / MM_PER_INCH * dpi).round().max(1.0);
    let size = [(width, width_mm), (height, height_mm)].map(|(pixels, mm)| most(mm).min(f64::from(pixels)) as u32);
    if size == [width, height] {
        return Arc::clone(&texture.pixels);
    }
    Arc::new(averaged(&texture.pixels, size, 1.0))
}

fn drawn(
    stamp: &PatternStamp,
    captions: &Captions,
    cell_mm: f64,
    request: &TemplateRequest,
) -> Result<Template, TemplateError> {
    let layout = layout(&request.layout)?;
    stamp.check_placements(&layout.sheets)?;
    let sheet = |plan: &SheetPlan| {
        let mut marks = vec![stamp.on(plan, [0.0; 2])];
        marks.extend(furniture::all(&layout, plan, captions));
        layout.frame.sheet(plan.trim, plan.printed, marks)
    };
    let sheets = layout.sheets.iter().map(sheet).collect();
    let cover = cover::cover(&layout, captions, "How to assemble", &cover::assembly(&layout));
    let mut pages = printer::corrected(vec![cover], layout.cover.setup.stretch());
    pages.extend(printer::corrected(sheets, layout.frame.setup.stretch()));
    Ok(Template { layout, cell_mm, pages })
}

/// Returns width and height of a printed cell of the pattern.
pub fn cell_mm(pattern: &Pattern, request: &TemplateRequest) -> Result<f64, TemplateError> {
    let cell_mm = check_tile(request)? / f64::from(pattern.columns());
    if cell_mm < MIN_CELL_MM {
        return Err(TemplateError::CellTooSmall { cell_mm });
    }
    Ok(cell_mm)
}

fn check_tile(request: &TemplateRequest) -> Result<f64, TemplateError> {
    let tile_mm = request.tile_mm;
    if !(tile_mm > 0.0 && tile_mm <= MAX_TILE_MM) {
        return Err(TemplateError::TileWidth { tile_mm });
    }
    check_scale(request.scale)?;
    Ok(tile_mm)
}

/// Returns an error for a scale such as 1:0, 1:NaN or 1:1e308, which the captions would show.
pub fn check_scale(scale: f64) -> Result<(), TemplateError> {
    // False for NaN too.
    if SCALES.contains(&scale) {
        Ok(())
    } else {
        Err(TemplateError::Scale { scale })
    }
}

/// Block of whole repeats that is drawn once in the file. Frame: origin at the block's top-left corner, y up.
pub(super) struct PatternStamp {
    block: Block,
    width_mm: f64,
    height_mm: f64,
}

enum Block {
    Cells(Arc<Stamp>),
    /// Image with its width and height in mm, slightly larger than the block's: it extends into the next repeat.
    Image(Arc<RgbImage>, (f64, f64)),
}

impl PatternStamp {
    fn from_image(repeat: &RgbImage, (wide_mm, high_mm): (f64, f64), size_mm: (f64, f64)) -> Self {
        let (columns, rows) = repeat.dimensions();
        let pixel_mm = (wide_mm / f64::from(columns), high_mm / f64::from(rows));
        let across = repeats(wide_mm, size_mm.0) * columns;
        let down = repeats(high_mm, size_mm.1) * rows;
        // As `run_on_mm`, in whole pixels.
        let more = |pixel_mm: f64| (0.5 / pixel_mm).ceil() as u32;
        let block = RgbImage::from_fn(across + more(pixel_mm.0), down + more(pixel_mm.1), |x, y| {
            *repeat.get_pixel(x % columns, y % rows)
        });
        let size = |width: u32, height: u32| (f64::from(width) * pixel_mm.0, f64::from(height) * pixel_mm.1);
        let (width_mm, height_mm) = size(across, down);
        let drawn = size(block.width(), block.height());
        Self {
            width_mm,
            height_mm,
            block: Block::Image(Arc::new(block), drawn),
        }
    }

    pub(super) fn new(pattern: &Pattern, cell_mm: f64, size_mm: (f64, f64)) -> Self {
        let (columns, rows) = (pattern.columns(), pattern.rows());
        let across = repeats(cell_mm * f64::from(columns), size_mm.0) * columns;
        let down = repeats(cell_mm * f64::from(rows), size_mm.1) * rows;
        let cells = (0..down).flat_map(|row| (0..across).map(move |column| (row, column)));
        let fills = cells.map(|(row, column)| Fill {
            area: cell_area(row, column, cell_mm),
            colour: pattern.cells().get_pixel(column % columns, row % rows).0,
        });
        let (width_mm, height_mm) = (cell_mm * f64::from(across), cell_mm * f64::from(down));
        let more = run_on_mm(cell_mm);
        let stamp = Stamp {
            bounds: RectMm::new(0.0, -height_mm - more, width_mm + more, 0.0),
            fills: fills.collect(),
        };
        Self {
            block: Block::Cells(Arc::new(stamp)),
            width_mm,
            height_mm,
        }
    }

    /// Returns an error if the sheets need more placements of the block than a file can hold.
    pub(super) fn check_placements<'a>(
        &self,
        sheets: impl IntoIterator<Item = &'a SheetPlan>,
    ) -> Result<(), TemplateError> {
        let along = |sheet_mm: f64, block_mm: f64| (sheet_mm / block_mm).ceil() + 1.0;
        let on = |plan: &SheetPlan| {
            let (width, height) = (plan.printed.width_mm(), plan.printed.height_mm());
            along(width, self.width_mm) * along(height, self.height_mm)
        };
        let count: f64 = sheets.into_iter().map(on).sum();
        if count > MOST_PLACEMENTS {
            return Err(TemplateError::TooManyPlacements { count });
        }
        Ok(())
    }

    /// Returns the part of the repeated pattern on a sheet; a top-left cell begins at `start_x`, `start_y` of the template frame.
    pub(super) fn on(&self, plan: &SheetPlan, [start_x, start_y]: Point2) -> Mark {
        let (carried, printed) = (plan.carried, plan.printed);
        let columns = blocks(carried.left_mm - start_x, carried.right_mm - start_x, self.width_mm);
        let rows = blocks(carried.top_mm - start_y, carried.bottom_mm - start_y, self.height_mm);
        let at = rows
            .flat_map(|row| columns.clone().map(move |column| (row, column)))
            .map(|(row, column)| {
                let x = printed.left_mm + (start_x + f64::from(column) * self.width_mm - carried.left_mm);
                let y = printed.top_mm - (start_y + f64::from(row) * self.height_mm - carried.top_mm);
                [x, y]
            });
        match &self.block {
            Block::Cells(stamp) => Mark::Stamped {
                stamp: Arc::clone(stamp),
                at: at.collect(),
                clip: printed,
            },
            Block::Image(image, size_mm) => {
                let placed = at.map(|[x, y]: Point2| Mark::Image {
                    image: Arc::clone(image),
                    area: RectMm::new(x, y - size_mm.1, x + size_mm.0, y),
                });
                Mark::clipped(printed, placed.collect())
            }
        }
    }
}

/// Returns the number of repeats of length `repeat_mm` in a stamp, at most what the template needs.
fn repeats(repeat_mm: f64, size_mm: f64) -> u32 {
    (STAMP_MM.min(size_mm) / repeat_mm).ceil().max(1.0) as u32
}

/// Returns the indices of the blocks of length `block_mm` that overlap an interval of the template; those before its edge are negative.
fn blocks(from_mm: f64, to_mm: f64, block_mm: f64) -> std::ops::Range<i32> {
    (from_mm / block_mm).floor() as i32..(to_mm / block_mm).ceil() as i32
}

/// Returns the area of a cell, extended slightly to its right and below. Later cells and blocks cover the excess, and the sheet's clip cuts the rest,
/// so every edge is in its place; but if a viewer antialiases an edge, the neighbour's colour shines through instead of the paper's: no white
/// hairlines.
fn cell_area(row: u32, column: u32, cell_mm: f64) -> RectMm {
    let (x, y) = (f64::from(column) * cell_mm, f64::from(row) * -cell_mm);
    let side = cell_mm + run_on_mm(cell_mm);
    RectMm::new(x, y - side, x + side, y)
}

/// Returns the extension of a cell: at least a pixel of any screen, but no more than needed: where a sheet's clip cuts through covered colours, a
/// viewer mixes them all into the pixel of the cut.
fn run_on_mm(cell_mm: f64) -> f64 {
    (0.25 * cell_mm).max(cell_mm.min(0.5))
}
