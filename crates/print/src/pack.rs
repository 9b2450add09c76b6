//! Packing of rectangles on pages, in rows from the top left.

use crate::sheet::RectMm;
use scaleproof_core::geometry::Point2;

const GAP_MM: f64 = 4.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Index of the page, from 0.
    pub page: usize,
    /// Lower left corner of the rectangle (page frame).
    pub at: Point2,
}

/// Packs rectangles of some (width, height) into an area: the highest first, each into the first row of any page that has room for it. The spots come
/// in the order of the sizes.
///
/// # Errors
/// The index of the first size that is larger than the area.
pub fn tight(sizes: &[(f64, f64)], area: RectMm) -> Result<Vec<Spot>, usize> {
    if let Some(i) = sizes
        .iter()
        .position(|(w, h)| *w > area.width_mm() || *h > area.height_mm())
    {
        return Err(i);
    }
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    // Heights that differ only by rounding keep their order.
    let high = |i: &usize| (sizes[*i].1 * 100.0).round();
    order.sort_by(|a, b| high(b).total_cmp(&high(a)));
    let mut rows: Vec<PackedRow> = Vec::new();
    let mut spots = vec![None; sizes.len()];
    for i in order {
        let (width, height) = sizes[i];
        let room = rows.iter().position(|row| row.x_mm + width <= area.right_mm);
        let at = room.unwrap_or_else(|| {
            rows.push(PackedRow::below(&rows, area, height));
            rows.len() - 1
        });
        let row = &mut rows[at];
        spots[i] = Some(Spot {
            page: row.page,
            at: [row.x_mm, row.top_mm - height],
        });
        row.x_mm += width + GAP_MM;
        row.bottom_mm = row.bottom_mm.min(row.top_mm - height);
    }
    Ok(spots.into_iter().flatten().collect())
}

struct PackedRow {
    page: usize,
    /// Left edge of the next rectangle.
    x_mm: f64,
    top_mm: f64,
    bottom_mm: f64,
}

impl PackedRow {
    /// Starts a row of some height on the first page that has room below its last row.
    fn below(rows: &[PackedRow], area: RectMm, height: f64) -> PackedRow {
        let pages = rows.iter().map(|row| row.page + 1).max().unwrap_or(0);
        let top_of = |page: usize| {
            let on_page = rows.iter().filter(|row| row.page == page);
            on_page.map(|row| row.bottom_mm - GAP_MM).fold(area.top_mm, f64::min)
        };
        let page = (0..pages)
            .find(|page| top_of(*page) - height >= area.bottom_mm)
            .unwrap_or(pages);
        let top_mm = top_of(page);
        PackedRow {
            page,
            x_mm: area.left_mm,
            top_mm,
            bottom_mm: top_mm - height,
        }
    }
}
