//! Layout of the colour charts: one pure function used by both printing and reading.
//!
//! Chart frame: origin at the chart's upper left corner, x right, y **down**, millimetres. The chart is a grid of cells; five
//! tags of two by two cells stand in its corners and its middle. A layout never changes: a new one takes new tag ids.

use scaleproof_pose::scene::TagFamily;

/// Side of a grid cell, mm.
pub const CELL_MM: f64 = 11.0;
/// Side of the printed patch in the middle of its cell, mm; the rest is bare paper.
pub const PATCH_MM: f64 = 10.0;
pub const FAMILY: TagFamily = TagFamily::Tag36h11;
/// Outer edge of a tag's black border, mm: its white ring ends with its two by two cells.
pub const TAG_MM: f64 = TAG_CELLS as f64 * CELL_MM * 0.8;

const TAG_CELLS: usize = 2;
/// Interval of the cells of bare paper, the reference for white.
const WHITE_EVERY: usize = 8;
/// Number of black patches beside the one among the colours; they must agree.
pub const MORE_BLACKS: usize = 3;

/// Available charts, by their levels per channel of sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChartKind {
    Rgb6,
    Rgb5,
    Rgb4,
}

impl ChartKind {
    /// All charts, the largest first.
    pub const ALL: [Self; 3] = [Self::Rgb6, Self::Rgb5, Self::Rgb4];

    fn row(self) -> (&'static str, &'static [u8], u32, (usize, usize)) {
        match self {
            Self::Rgb6 => ("rgb6", &[0, 51, 102, 153, 204, 255], 582, (16, 18)),
            Self::Rgb5 => ("rgb5", &[0, 64, 128, 191, 255], 577, (12, 14)),
            Self::Rgb4 => ("rgb4", &[0, 85, 170, 255], 572, (10, 10)),
        }
    }

    /// Returns the chart's name in captions and files.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// Returns the levels of each channel, evenly from 0 to 255; every combination is a patch.
    pub fn levels(self) -> &'static [u8] {
        self.row().1
    }

    /// Returns the ids of its tags: upper left, upper right, lower right, lower left, middle. They are the family's last, which a scene hardly uses.
    pub fn tag_ids(self) -> [u32; 5] {
        [0, 1, 2, 3, 4].map(|i| self.row().2 + i)
    }

    pub fn grid(self) -> (usize, usize) {
        self.row().3
    }
}

/// Cell of the grid, counted from 0 at the upper left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ChartCell {
    pub row: usize,
    pub column: usize,
}

impl ChartCell {
    /// Returns its middle (chart frame, mm).
    pub fn centre_mm(self) -> [f64; 2] {
        [self.column, self.row].map(|i| (i as f64 + 0.5) * CELL_MM)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ColourPatch {
    pub cell: ChartCell,
    /// 8-bit sRGB sent to the printer.
    pub asked_rgb: [u8; 3],
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChartTag {
    pub id: u32,
    pub centre_mm: [f64; 2],
}

impl ChartTag {
    /// Returns the corners top-left, top-right, bottom-right, bottom-left of the upright tag (chart frame, mm).
    pub fn corners_mm(&self) -> [[f64; 2]; 4] {
        let ([x, y], h) = (self.centre_mm, TAG_MM / 2.0);
        [[x - h, y - h], [x + h, y - h], [x + h, y + h], [x - h, y + h]]
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct ChartLayout {
    pub kind: ChartKind,
    pub size_mm: (f64, f64),
    pub tags: Vec<ChartTag>,
    /// Cells of bare paper, spread evenly.
    pub whites: Vec<ChartCell>,
    /// The colours of the cube, a few blacks, and greys between its levels; neighbours are unrelated colours.
    pub patches: Vec<ColourPatch>,
}

impl ChartLayout {
    pub fn new(kind: ChartKind) -> Self {
        let (columns, rows) = kind.grid();
        let (right, bottom) = (columns - TAG_CELLS, rows - TAG_CELLS);
        let corners = [(0, 0), (right, 0), (right, bottom), (0, bottom)];
        let blocks = corners.into_iter().chain([(right / 2, bottom / 2)]);
        let in_block = |at: usize, first: usize| (first..first + TAG_CELLS).contains(&at);
        let is_in = |cell: &ChartCell, (column, row)| in_block(cell.column, column) && in_block(cell.row, row);
        let is_tag = |cell: &ChartCell| blocks.clone().any(|block| is_in(cell, block));
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| ChartCell { row, column }));
        // Shifted by three from row to row: every row, column and diagonal has one.
        let is_white = |cell: &ChartCell| (cell.column + 3 * cell.row).is_multiple_of(WHITE_EVERY);
        let (whites, inked): (Vec<_>, Vec<_>) = cells.filter(|cell| !is_tag(cell)).partition(is_white);
        let tag = |(id, (column, row)): (u32, (usize, usize))| ChartTag {
            id,
            centre_mm: [column, row].map(|i| (i as f64 + TAG_CELLS as f64 / 2.0) * CELL_MM),
        };
        let colours = scattered(colours(kind, inked.len()));
        let patch = |(cell, asked_rgb)| ColourPatch { cell, asked_rgb };
        Self {
            kind,
            size_mm: (columns as f64 * CELL_MM, rows as f64 * CELL_MM),
            tags: kind.tag_ids().into_iter().zip(blocks).map(tag).collect(),
            whites,
            patches: inked.into_iter().zip(colours).map(patch).collect(),
        }
    }
}

/// Returns `count` colours: the cube, then blacks, then greys between the cube's that divide the grey axis nearly evenly.
fn colours(kind: ChartKind, count: usize) -> Vec<[u8; 3]> {
    let levels = kind.levels();
    let mut all = Vec::new();
    for r in levels {
        all.extend(levels.iter().flat_map(|g| levels.iter().map(|b| [*r, *g, *b])));
    }
    all.extend([[0; 3]; MORE_BLACKS]);
    let greys = count.saturating_sub(all.len());
    let grey = |i: usize| {
        let level = (255.0 * (i as f64 + 1.0) / (greys as f64 + 1.0)).round() as u8;
        // The cube has its own levels already.
        if levels.contains(&level) { level - 20 } else { level }
    };
    all.extend((0..greys).map(|i| [grey(i); 3]));
    all
}

/// Reorders colours so that neighbours differ, and light fall-off does not correlate with colour.
fn scattered(colours: Vec<[u8; 3]>) -> Vec<[u8; 3]> {
    let n = colours.len();
    // A step near the golden section samples a row of any length evenly; a step coprime to the length visits all.
    let start = (0.618 * n as f64) as usize;
    let step = (start..).find(|step| divisor(*step, n) == 1).unwrap_or(1);
    (0..n).map(|i| colours[i * step % n]).collect()
}

/// Returns the greatest common divisor (Euclid).
fn divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { divisor(b, a % b) }
}
