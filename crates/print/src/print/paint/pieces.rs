//! A panel spread over sheets that stand alone: each has a rim around its part, and seams follow the cells' borders where they can,
//! so that no cell is cut into slivers.

use crate::print::SheetError;
use crate::print::frame::PageFrame;
use crate::print::sheet::RectMm;
use crate::print::template::{LayoutRequest, MAX_SHEETS, SheetLayout, SheetPlan, TemplateRect, layout};

/// The sheets: of each, `own` is its part of the panel, `carried` that and the rim. `trim` and `printed` are the rim's
/// outer edge. Overlap and bleed of the request do not matter.
pub fn pieces(request: &LayoutRequest, cell_mm: f64, rim_mm: f64) -> Result<SheetLayout, SheetError> {
    // A strip of two rims between sheets and one around them leaves each sheet its part and its own rim.
    let spread = layout(&LayoutRequest {
        overlap_mm: 2.0 * rim_mm,
        bleed_mm: rim_mm,
        ..request.clone()
    })?;
    let usable = spread.frame.usable;
    let x = cuts(
        request.size_mm.0,
        cell_mm,
        usable.width_mm() - 2.0 * rim_mm,
        spread.columns,
    );
    let y = cuts(
        request.size_mm.1,
        cell_mm,
        usable.height_mm() - 2.0 * rim_mm,
        spread.rows,
    );
    let (columns, rows) = (x.len() - 1, y.len() - 1);
    if columns * rows > MAX_SHEETS {
        return Err(SheetError::TooManySheets { most: MAX_SHEETS });
    }
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let sheet = |(row, column): (usize, usize)| {
        let own = TemplateRect {
            left_mm: x[column],
            top_mm: y[row],
            right_mm: x[column + 1],
            bottom_mm: y[row + 1],
        };
        on_page(&spread.frame, row, column, own, rim_mm)
    };
    let sheets = places.map(sheet).collect();
    Ok(SheetLayout {
        sheets,
        rows,
        columns,
        ..spread
    })
}

fn on_page(frame: &PageFrame, row: usize, column: usize, own: TemplateRect, rim_mm: f64) -> SheetPlan {
    let carried = TemplateRect {
        left_mm: own.left_mm - rim_mm,
        top_mm: own.top_mm - rim_mm,
        right_mm: own.right_mm + rim_mm,
        bottom_mm: own.bottom_mm + rim_mm,
    };
    let (left, top) = (frame.usable.left_mm, frame.usable.top_mm);
    let (width, height) = (carried.right_mm - carried.left_mm, carried.bottom_mm - carried.top_mm);
    let outer = RectMm::new(left, top - height, left + width, top);
    SheetPlan {
        row,
        column,
        own,
        carried,
        trim: outer,
        printed: outer,
    }
}

/// Where the panel is cut along one axis: between cells, as many of them on each sheet as on any other or one less. Cells that
/// are larger than a sheet are cut into `parts` equal parts.
fn cuts(size_mm: f64, cell_mm: f64, most_mm: f64, parts: usize) -> Vec<f64> {
    // A millionth of slack for sizes made to measure.
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
