//! Painting instead of printing: a pattern in a few paints, as sheets to paint by number and as stencils.
//!
//! [`stencil`] is geometry alone and takes any outlines; the rest draws it for a rectangle of a repeated pattern.

mod bridges;
mod legend;
pub mod plane;
mod regions;
mod request;
mod sheets;
mod stencil;

pub use request::{PaintArea, PaintRequest};

pub use legend::{Legend, sheets as legend_sheets, swatch};
pub use sheets::{OPENING, cross, disc, hole_mm, mirrored};
pub use stencil::{NoStencil, Rules, Slant, Stencil, openings_and_bridges, stencil};

use super::frame::PageFrame;
use super::sheet::Sheet;
use super::template::cover::cover;
use super::template::{Captions, LayoutRequest, MAX_SHEETS, SheetLayout, SheetPlan, TemplateError, cell_mm, layout};
use super::{SheetError, printer};
use regions::CellGrid;
use scaleproof_core::geometry::length::shown;
use scaleproof_plot::lettering::number;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::Painted;

/// Minimum width of bridges; thinner ones do not last in any stencil.
pub const MIN_FEATURE_MM: f64 = 0.2;
/// Maximum width of bridges; wider ones, with the rim that holds them, leave an office printer no room.
pub const MAX_FEATURE_MM: f64 = 10.0;
/// Minimum size of a cell in features: a bridge, and an opening on either side of it.
const FEATURES_PER_CELL: f64 = 3.0;
pub const RIM_MM: f64 = 10.0;
/// Maximum number of cells; nobody paints more by number, and stencils of more take hours.
pub const MOST_CELLS: usize = 250_000;

/// Reason why there are no paint sheets.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PaintError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(transparent)]
    Template(#[from] TemplateError),
    #[error(transparent)]
    NoStencil(#[from] NoStencil),
    #[error("minimum feature width cannot be {}; give 0.2 to 10 mm", shown(*feature_mm))]
    FeatureWidth { feature_mm: f64 },
    #[error(
        "cells of {cell} mm are too small for stencils with features of {feature} mm (a bridge and an opening on either side of it \
         take three times that)"
    )]
    CellTooSmall {
        cell: String,
        feature: String,
        /// Largest feature width that fits into these cells.
        most: String,
        /// Smallest tile width that fits these features.
        least_tile: String,
    },
    #[error(
        "{paints} paints on {sheets} sheets would be {pages} pages, more than {MAX_SHEETS}; use fewer paints, larger paper or a smaller size"
    )]
    TooManyPages { paints: usize, sheets: usize, pages: usize },
    #[error("the panel would have {cells} cells, more than {MOST_CELLS}; use a larger tile or a smaller size")]
    TooManyCells { cells: usize },
}

/// Returns the width of the rim of a stencil with features of this width: it holds registration holes.
pub fn rim_mm(min_feature_mm: f64) -> f64 {
    RIM_MM.max(hole_mm(min_feature_mm) + 2.0 * min_feature_mm)
}

#[derive(Debug, Clone)]
pub struct PaintSheets {
    pub layout: SheetLayout,
    pub cell_mm: f64,
    pub areas: Vec<PaintArea>,
    /// Instructions, the legend, the sheets to paint by number, then the stencils paint by paint; corrected for the printer.
    pub pages: Vec<Sheet>,
    /// Name of each page, used if it becomes a file of its own.
    pub names: Vec<String>,
}

impl PaintSheets {
    pub fn whole(&self) -> PaintArea {
        PaintArea::sum(&self.areas)
    }

    /// Returns the number of pages that are stencils: those of one paint on one sheet.
    pub fn stencils(&self) -> usize {
        let is_stencil = |name: &&String| name.starts_with("paint") && name.contains('-');
        self.names.iter().filter(is_stencil).count()
    }
}

/// Draws the sheets. A paint without cells on a sheet, or without an opening there, gets no stencil of it.
pub fn paint_sheets(pattern: &Pattern, painted: &Painted, request: &PaintRequest) -> Result<PaintSheets, PaintError> {
    let cell_mm = cell_mm(pattern, &request.template)?;
    check_features(cell_mm, pattern.columns(), request.min_feature_mm)?;
    let rules = Rules {
        min_feature_mm: request.min_feature_mm,
        rim_mm: rim_mm(request.min_feature_mm),
    };
    let layout = pieces(&request.template.layout, cell_mm, rules.rim_mm)?;
    check_pages(painted.paints.len(), layout.sheets.len())?;
    check_cells(cell_mm, request.template.layout.size_mm)?;
    let grid = CellGrid { painted, cell_mm };
    let (stencils, areas) = cut(&grid, &layout, rules)?;
    let captions = Captions::new(pattern, &request.template, cell_mm);
    let (mut pages, mut names) = (Vec::new(), Vec::new());
    let mut add = |frame: &PageFrame, name: String, sheet: Sheet| {
        pages.push(printer::corrected_one(sheet, frame.setup.stretch()));
        names.push(name);
    };
    let cover = cover(&layout, &captions, "How to paint", &legend::steps(request));
    add(&layout.cover, "paint".to_owned(), cover);
    let table = Legend {
        painted,
        areas: &areas,
        whole: "panel",
        notes: &["dE: CIEDE2000 of the paint against the pattern's colours. Stencil and touch up make up the area."],
    };
    let legend = legend::sheets(&layout.cover, &table, &captions).into_iter();
    legend
        .zip(1..)
        .for_each(|(sheet, i)| add(&layout.cover, format!("legend{i}"), sheet));
    for plan in &layout.sheets {
        let sheet = sheets::numbers(&layout, plan, &grid, &captions);
        add(&layout.frame, format!("numbers-{}", plan.id()), sheet);
    }
    let pen = sheets::StencilPen::new(&layout, pattern, request, cell_mm);
    for (paint, plan, stencil) in &stencils {
        let sheet = pen.sheet(plan, *paint + 1, &painted.paints[*paint].paint, stencil);
        add(&layout.frame, format!("paint{}-{}", paint + 1, plan.id()), sheet);
    }
    Ok(PaintSheets {
        layout,
        cell_mm,
        areas,
        pages,
        names,
    })
}

/// Returns an error for features that no printer can show or that do not fit into these cells.
pub fn check_features(cell_mm: f64, columns: u32, feature_mm: f64) -> Result<(), PaintError> {
    if !(MIN_FEATURE_MM..=MAX_FEATURE_MM).contains(&feature_mm) {
        return Err(PaintError::FeatureWidth { feature_mm });
    }
    if cell_mm < FEATURES_PER_CELL * feature_mm {
        return Err(PaintError::CellTooSmall {
            cell: number(cell_mm),
            feature: number(feature_mm),
            // Rounded towards the side on which the advice is valid.
            most: number((cell_mm / FEATURES_PER_CELL * 1e3).floor() / 1e3),
            least_tile: number((FEATURES_PER_CELL * feature_mm * f64::from(columns) * 1e3).ceil() / 1e3),
        });
    }
    Ok(())
}

pub fn check_pages(paints: usize, sheets: usize) -> Result<(), PaintError> {
    let pages = (paints + 1) * sheets;
    if pages > MAX_SHEETS {
        return Err(PaintError::TooManyPages { paints, sheets, pages });
    }
    Ok(())
}

fn check_cells(cell_mm: f64, (width_mm, height_mm): (f64, f64)) -> Result<(), PaintError> {
    let [columns, rows] = [width_mm, height_mm].map(|mm| (mm / cell_mm).ceil() as usize);
    let cells = columns * rows;
    if cells > MOST_CELLS {
        return Err(PaintError::TooManyCells { cells });
    }
    Ok(())
}

/// Lays out a panel over separate sheets: each has a rim around its part, and seams follow the cells' borders if possible, so that no cell is cut
/// into slivers. `own` is a sheet's part of the panel, `carried` that with the rim; `trim` and `printed` are the rim's outer edge. Overlap and bleed
/// of the request are ignored.
fn pieces(request: &LayoutRequest, cell_mm: f64, rim_mm: f64) -> Result<SheetLayout, SheetError> {
    // An overlap of two rims and a bleed of one leave each sheet its part and its own rim.
    let spread = layout(&LayoutRequest {
        overlap_mm: 2.0 * rim_mm,
        bleed_mm: rim_mm,
        ..request.clone()
    })?;
    let (width, height) = spread.frame.usable_size();
    let x = cuts(request.size_mm.0, cell_mm, width - 2.0 * rim_mm, spread.columns);
    let y = cuts(request.size_mm.1, cell_mm, height - 2.0 * rim_mm, spread.rows);
    if (x.len() - 1) * (y.len() - 1) > MAX_SHEETS {
        return Err(SheetError::TooManySheets { most: MAX_SHEETS });
    }
    let mut made = SheetLayout::cut_at(spread.frame, &x, &y, [rim_mm; 3]);
    made.cover = spread.cover;
    made.sheets.iter_mut().for_each(|plan| plan.trim = plan.printed);
    Ok(made)
}

/// Returns the cuts of the panel along one axis: between cells, with numbers of cells per sheet that differ by at most one. Cells larger than a sheet
/// are cut into `parts` equal parts.
fn cuts(size_mm: f64, cell_mm: f64, most_mm: f64, parts: usize) -> Vec<f64> {
    // A tolerance of a millionth for sizes made to measure.
    let fit = (most_mm / cell_mm + 1e-6).floor();
    if fit < 1.0 {
        let inner = (1..parts).map(|i| size_mm * i as f64 / parts as f64);
        return [0.0].into_iter().chain(inner).chain([size_mm]).collect();
    }
    let cells = (size_mm / cell_mm - 1e-6).ceil().max(1.0);
    let sheets = (cells / fit).ceil();
    let inner = (1..sheets as usize).map(|i| (i as f64 * cells / sheets).floor() * cell_mm);
    [0.0].into_iter().chain(inner).chain([size_mm]).collect()
}

/// Index of a paint, a sheet and its stencil.
type Cut<'a> = (usize, &'a SheetPlan, Stencil);

/// Returns all stencils with an opening, paint by paint, and each paint's areas.
fn cut<'a>(
    grid: &CellGrid,
    layout: &'a SheetLayout,
    rules: Rules,
) -> Result<(Vec<Cut<'a>>, Vec<PaintArea>), PaintError> {
    let mut stencils = Vec::new();
    let mut areas = Vec::new();
    for paint in 0..grid.painted.paints.len() {
        let mut area = PaintArea::default();
        for plan in &layout.sheets {
            let runs = grid.runs(paint, plan.own);
            let made = stencil(&runs, &[regions::bounds(plan.own).outline()], rules)?;
            area.cells_mm2 += runs.iter().map(regions::rectangle_mm2).sum::<f64>();
            area.openings_mm2 += made.openings.mm2();
            area.bridges_mm2 += made.bridges.mm2();
            if !made.openings.is_empty() {
                stencils.push((paint, plan, made));
            }
        }
        areas.push(area);
    }
    Ok((stencils, areas))
}
