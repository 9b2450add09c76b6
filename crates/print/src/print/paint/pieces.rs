//! A panel spread over sheets that stand alone: each has a rim around its part, and seams follow the cells' borders where they can,
//! so that no cell is cut into slivers.

use crate::print::SheetError;
use crate::print::template::layout::Strips;
use crate::print::template::{LayoutRequest, MAX_SHEETS, SheetLayout, layout};

/// The sheets: of each, `own` is its part of the panel, `carried` that and the rim. `trim` and `printed` are the rim's
/// outer edge. Overlap and bleed of the request do not matter.
pub fn pieces(request: &LayoutRequest, cell_mm: f64, rim_mm: f64) -> Result<SheetLayout, SheetError> {
    // A strip of two rims between sheets and one around them leaves each sheet its part and its own rim.
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
    let strips = Strips {
        before_mm: rim_mm,
        after_mm: rim_mm,
        outer_mm: rim_mm,
    };
    let mut made = SheetLayout::cut_at(spread.frame, &x, &y, strips);
    made.cover = spread.cover;
    made.sheets.iter_mut().for_each(|plan| plan.trim = plan.printed);
    Ok(made)
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
