//! Nesting of shapes on the fewest pages: each at the lowest and leftmost free place over several rotations, on a grid of cells.

use scaleproof_core::geometry::Point2;
use scaleproof_print::raster::Pose;
use scaleproof_print::sheet::RectMm;
use scaleproof_print::wrap::Region;

/// Side of a cell, and the gap between two shapes in addition to the cells' rounding.
const CELL_MM: f64 = 1.5;
const GAP_MM: f64 = 1.0;
/// Step of the rotations that are tried; its multiples include the shape's own box along and across.
const TURN_DEG: f64 = 15.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Index of the page, from 0.
    pub page: usize,
    pub pose: Pose,
}

/// Places shapes onto pages that are free within `area` except for `taken`.
///
/// # Errors
/// The index of the first shape that fits on no page.
pub fn nest(shapes: &[Region], area: RectMm, taken: &[RectMm]) -> Result<Vec<Place>, usize> {
    let turns: Vec<Vec<Turned>> = shapes.iter().map(turned).collect();
    let blank = Cells::page(area, taken);
    let orders = [
        order(shapes, |shape| shape.area_mm2()),
        order(shapes, |shape| size(shape).0),
        order(shapes, |shape| size(shape).0 * size(shape).1),
    ];
    let tried = orders.iter().map(|order| nest_in_order(&turns, order, &blank, area));
    let tried: Vec<_> = tried.collect::<Result<_, _>>()?;
    let best = tried.into_iter().min_by_key(|(_, pages, last)| (*pages, *last));
    Ok(best.map_or(Vec::new(), |(places, ..)| places))
}

/// Returns the indices of the shapes, the largest by `by` first.
fn order(shapes: &[Region], by: impl Fn(&Region) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..shapes.len()).collect();
    // Sizes that differ only by rounding keep their order.
    let rank = |i: &usize| (by(&shapes[*i]) * 100.0).round();
    order.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    order
}

fn size(shape: &Region) -> (f64, f64) {
    let (low, high) = shape.bounds().unwrap_or_default();
    (high[0] - low[0], high[1] - low[1])
}

/// Returns the places, the number of pages, and the filled height of the last one.
fn nest_in_order(
    turns: &[Vec<Turned>],
    order: &[usize],
    blank: &Cells,
    area: RectMm,
) -> Result<(Vec<Place>, usize, usize), usize> {
    let mut pages: Vec<Cells> = Vec::new();
    let mut places = vec![None; turns.len()];
    for i in order {
        let mut all = pages.iter().chain(std::iter::once(blank)).enumerate();
        let found = all.find_map(|(p, page)| Some((p, page.lowest(&turns[*i])?)));
        let (p, spot) = found.ok_or(*i)?;
        if p == pages.len() {
            pages.push(blank.clone());
        }
        let turned = &turns[*i][spot.turn];
        pages[p].take(&turned.cells, spot.column, spot.row);
        places[*i] = Some(Place {
            page: p,
            pose: Pose {
                turn: turned.turn,
                by: [
                    area.left_mm + CELL_MM * spot.column as f64 - turned.low[0],
                    area.bottom_mm + CELL_MM * spot.row as f64 - turned.low[1],
                ],
            },
        });
    }
    let last = pages.last().map_or(0, Cells::filled_rows);
    Ok((places.into_iter().flatten().collect(), pages.len(), last))
}

/// Rotated shape.
struct Turned {
    turn: [f64; 2],
    /// Position of its first cell's lower left corner in the rotated plane.
    low: Point2,
    cells: Cells,
    /// Its runs of cells, the longest first: those block the most positions.
    runs: Vec<Run>,
}

/// Adjacent cells of one row of a shape.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: usize,
    column: usize,
    length: usize,
}

fn turned(shape: &Region) -> Vec<Turned> {
    // Cells count whose centre is within this distance of the shape, so that inks keep the gap.
    let around = shape.grown(0.5 * GAP_MM + 0.5 * std::f64::consts::SQRT_2 * CELL_MM);
    let by_step = |i: usize| {
        let (s, c) = (TURN_DEG * i as f64).to_radians().sin_cos();
        let (turn, by) = ([c, s], [0.0; 2]);
        let turned = around.moved(|p| Pose { turn, by }.at(p));
        let (low, high) = turned.bounds().unwrap_or_default();
        let cells = Cells::covered(&turned, low, high);
        let runs = cells.runs();
        Turned { turn, low, cells, runs }
    };
    (0..(360.0 / TURN_DEG) as usize).map(by_step).collect()
}

/// Rows of cells from the bottom up, one bit per cell.
#[derive(Debug, Clone)]
struct Cells {
    columns: usize,
    rows: Vec<Vec<u64>>,
}

#[derive(Debug, Clone, Copy)]
struct Spot {
    turn: usize,
    column: usize,
    row: usize,
}

impl Cells {
    fn blank(columns: usize, rows: usize) -> Self {
        let words = columns.div_ceil(64).max(1);
        Self {
            columns,
            rows: vec![vec![0; words]; rows],
        }
    }

    /// Creates the cells of a page's area without the taken ones.
    fn page(area: RectMm, taken: &[RectMm]) -> Self {
        let count = |mm: f64| (mm / CELL_MM).floor() as usize;
        let mut cells = Self::blank(count(area.width_mm()), count(area.height_mm()));
        for rect in taken {
            let span = |from: f64, to: f64, count: usize| {
                let cell = |mm: f64| (mm / CELL_MM).clamp(0.0, count as f64);
                cell(from).floor() as usize..cell(to).ceil() as usize
            };
            let columns = span(rect.left_mm - area.left_mm, rect.right_mm - area.left_mm, cells.columns);
            let (bottom, top) = (rect.bottom_mm - area.bottom_mm, rect.top_mm - area.bottom_mm);
            for row in span(bottom, top, cells.rows.len()) {
                columns.clone().for_each(|column| cells.set(row, column));
            }
        }
        cells
    }

    /// Returns the cells whose centre is in a region; its bounding box and the first cell share the lower left corner.
    fn covered(region: &Region, low: Point2, high: Point2) -> Self {
        let count = |axis: usize| ((high[axis] - low[axis]) / CELL_MM).ceil().max(1.0) as usize;
        let mut cells = Self::blank(count(0), count(1));
        for row in 0..cells.rows.len() {
            let y = low[1] + (row as f64 + 0.5) * CELL_MM;
            // Crossings of outlines with the row, with their direction: a point is inside while the sum is not zero.
            let crossing = |(a, b): (&Point2, &Point2)| {
                let up = a[1] <= y && b[1] > y;
                let down = b[1] <= y && a[1] > y;
                let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                (up || down).then_some((x, if up { 1 } else { -1 }))
            };
            let mut crossings: Vec<(f64, i32)> = region.edges().filter_map(crossing).collect();
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut depth = 0;
            for pair in crossings.windows(2) {
                depth += pair[0].1;
                if depth != 0 {
                    let first = ((pair[0].0 - low[0]) / CELL_MM - 0.5).ceil().max(0.0) as usize;
                    let end = ((pair[1].0 - low[0]) / CELL_MM + 0.5).floor().max(0.0) as usize;
                    (first..end.min(cells.columns)).for_each(|column| cells.set(row, column));
                }
            }
        }
        cells
    }

    fn set(&mut self, row: usize, column: usize) {
        self.rows[row][column / 64] |= 1 << (column % 64);
    }

    /// Returns the lowest position over all rotations; of equally low ones the leftmost.
    fn lowest(&self, turns: &[Turned]) -> Option<Spot> {
        let mut best: Option<(usize, Spot)> = None;
        for (turn, shape) in turns.iter().enumerate() {
            let cells = &shape.cells;
            if cells.columns > self.columns || cells.rows.len() > self.rows.len() {
                continue;
            }
            // The top of a spot counts, not its foot: flat orientations leave more room.
            let highest = best.map_or(self.rows.len(), |(top, _)| top - 1);
            let Some(feet) = (highest + 1).checked_sub(cells.rows.len()) else {
                continue;
            };
            let mut spots = (0..feet).filter_map(|row| Some((row, self.free_column(shape, row)?)));
            if let Some((row, column)) = spots.next() {
                best = Some((row + cells.rows.len(), Spot { turn, column, row }));
            }
        }
        best.map(|(_, spot)| spot)
    }

    /// Returns the leftmost column at which a shape with its foot on a row overlaps no taken cell.
    ///
    /// All columns are tested at once, one bit each: a run of the shape blocks every column from which it would reach a taken cell.
    fn free_column(&self, shape: &Turned, row: usize) -> Option<usize> {
        let columns = self.columns - shape.cells.columns + 1;
        let is_free = |blocked: &[u64], column: usize| blocked[column / 64] >> (column % 64) & 1 == 0;
        let mut blocked = vec![0; self.rows[row].len()];
        let mut first = 0;
        for run in &shape.runs {
            let mut reach = self.rows[row + run.row].clone();
            let mut length = 1;
            while length < run.length {
                let more = length.min(run.length - length);
                or_shifted(&mut reach, more);
                length += more;
            }
            for (word, blocked) in blocked.iter_mut().enumerate() {
                *blocked |= shifted(&reach, word, run.column);
            }
            first = (first..columns).find(|column| is_free(&blocked, *column))?;
        }
        Some(first)
    }

    fn runs(&self) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for (row, cells) in self.rows.iter().enumerate() {
            for column in (0..self.columns).filter(|c| cells[c / 64] >> (c % 64) & 1 == 1) {
                match runs.last_mut() {
                    Some(run) if run.row == row && run.column + run.length == column => run.length += 1,
                    _ => runs.push(Run { row, column, length: 1 }),
                }
            }
        }
        runs.sort_by_key(|run| std::cmp::Reverse(run.length));
        runs
    }

    fn take(&mut self, shape: &Self, column: usize, row: usize) {
        for (i, cells) in shape.rows.iter().enumerate() {
            for c in 0..shape.columns {
                if cells[c / 64] >> (c % 64) & 1 == 1 {
                    self.set(row + i, column + c);
                }
            }
        }
    }

    fn filled_rows(&self) -> usize {
        self.rows
            .iter()
            .rposition(|row| row.iter().any(|word| *word != 0))
            .map_or(0, |row| row + 1)
    }
}

/// Returns a word of a row of bits shifted down by some columns.
fn shifted(row: &[u64], word: usize, by: usize) -> u64 {
    let at = |word: usize| u128::from(row.get(word).copied().unwrap_or(0));
    let from = word + by / 64;
    ((at(from) | at(from + 1) << 64) >> (by % 64)) as u64
}

/// Ors each bit with the one `by` columns further.
fn or_shifted(row: &mut [u64], by: usize) {
    for word in 0..row.len() {
        row[word] |= shifted(row, word, by);
    }
}
