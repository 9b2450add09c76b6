//! Instructions for painting, and the table of the paints.

use super::{PaintArea, PaintRequest};
use crate::frame::PageFrame;
use crate::sheet::{BLACK, Mark, RectMm, Sheet, TextAnchor};
use crate::template::Captions;
use scaleproof_plot::lettering::{CAP_HEIGHT, number, printable, shortened};
use scaleproof_surface::pattern::palette::{Painted, UsedPaint};

const TEXT_MM: f64 = 2.8;
const ROW_MM: f64 = 6.5;
const SWATCH_MM: f64 = 4.5;
const RULE_MM: f64 = 0.15;
const CM2: f64 = 100.0;

/// Width of the table; on narrower paper the table shrinks.
const TABLE_MM: f64 = 168.0;
/// Positions of the columns: the right edges of numbers, else the left edges (number, swatch, name, sRGB); and their headings.
const NO_MM: f64 = 6.0;
const SWATCH_AT_MM: f64 = 9.0;
const NAME_AT_MM: f64 = 24.0;
const NAME_MM: f64 = 40.0;
const HEX_AT_MM: f64 = 66.0;
const NUMBERS_AT_MM: [f64; 5] = [98.0, 118.0, 138.0, 156.0, TABLE_MM];
/// The font of the sheets is Latin-1, so ΔE is written dE.
const NUMBER_HEADS: [&str; 5] = ["area cm²", "stencil", "touch up", "dE mean", "max"];

/// Returns the steps from printed sheets to a painted model.
pub fn steps(request: &PaintRequest) -> Vec<String> {
    let steps = [
        "Print at 100 %, without fit to page. Measure both rulers below before you cut anything.",
        "Mix or buy the paints of the legend; try each on a scrap of the model's material.",
        "With a brush: the sheets 'numbers' show each patch with its paint's number. They are cut at the crop marks and \
         laid edge to edge; seams that meet have the same letter.",
        "With a spray: every paint has a stencil for every sheet it occurs on. Cut out what is tinted, the holes in the \
         corners too, and the frame at its outer line.",
        "Mark the four corner holes of the first stencil of a sheet on the model or on masking tape, and lay every other \
         stencil of that sheet with its holes on these marks.",
        &format!(
            "Each stencil is one piece: bridges of at least {} mm hold its islands. What they cover is touched up with \
             the paint by number; the legend has its area.",
            number(request.min_feature_mm)
        ),
        "The stencils are mirrored: cut the film from its back and lay it with the printed side down.",
    ];
    let count = if request.mirror { steps.len() } else { steps.len() - 1 };
    steps.into_iter().take(count).map(str::to_owned).collect()
}

/// Index of a paint, from 0, the paint and its area.
type LegendLine<'a> = (usize, (&'a UsedPaint, &'a PaintArea));

pub struct Legend<'a> {
    pub painted: &'a Painted,
    pub areas: &'a [PaintArea],
    pub whole: &'a str,
    /// Lines below the table.
    pub notes: &'a [&'a str],
}

pub fn sheets(frame: &PageFrame, legend: &Legend, captions: &Captions) -> Vec<Sheet> {
    let Legend { painted, areas, .. } = *legend;
    let factor = (frame.usable.width_mm() / TABLE_MM).min(1.0);
    // Heading, column heads, and the lines below the table.
    let rows = ((frame.usable.height_mm() / (ROW_MM * factor)).floor() as usize)
        .saturating_sub(4 + legend.notes.len())
        .max(1);
    let lines: Vec<LegendLine> = painted.paints.iter().zip(areas).enumerate().collect();
    let last = lines.len().div_ceil(rows).saturating_sub(1);
    let page = |(i, lines): (usize, &[LegendLine])| {
        let mut table = Table {
            frame,
            factor,
            row: 0,
            marks: Vec::new(),
        };
        table.heads();
        for (index, (used, area)) in lines {
            table.paint(index + 1, used, area);
        }
        if i == last {
            table.totals(legend);
        }
        captions.sheet(frame, table.marks)
    };
    lines.chunks(rows).enumerate().map(page).collect()
}

struct Table<'a> {
    frame: &'a PageFrame,
    factor: f64,
    row: usize,
    marks: Vec<Mark>,
}

impl Table<'_> {
    fn heads(&mut self) {
        self.text(0.0, TextAnchor::Left, "Paints".to_owned());
        self.row += 1;
        self.text(NO_MM, TextAnchor::Right, "no.".to_owned());
        self.text(NAME_AT_MM, TextAnchor::Left, "name".to_owned());
        self.text(HEX_AT_MM, TextAnchor::Left, "sRGB".to_owned());
        for (x, head) in NUMBERS_AT_MM.into_iter().zip(NUMBER_HEADS) {
            self.text(x, TextAnchor::Right, head.to_owned());
        }
        self.row += 1;
    }

    fn paint(&mut self, number: usize, used: &UsedPaint, area: &PaintArea) {
        self.text(NO_MM, TextAnchor::Right, number.to_string());
        self.swatch(used.paint.rgb);
        let name = shortened(&printable(&used.paint.name), TEXT_MM, NAME_MM);
        self.text(NAME_AT_MM, TextAnchor::Left, name);
        self.text(HEX_AT_MM, TextAnchor::Left, used.paint.hex());
        self.numbers(area, (used.mean_delta_e, used.max_delta_e));
        self.row += 1;
    }

    fn totals(&mut self, legend: &Legend) {
        let y = self.baseline() + 0.75 * ROW_MM * self.factor;
        self.marks
            .push(Mark::line([self.x(0.0), y], [self.x(TABLE_MM), y], RULE_MM));
        self.text(NAME_AT_MM, TextAnchor::Left, legend.whole.to_owned());
        self.numbers(&PaintArea::sum(legend.areas), legend.painted.delta_e());
        self.row += 1;
        for note in legend.notes {
            self.text(0.0, TextAnchor::Left, (*note).to_owned());
            self.row += 1;
        }
    }

    fn numbers(&mut self, area: &PaintArea, (mean, largest): (f64, f64)) {
        let cm2 = [area.cells_mm2, area.openings_mm2, area.bridges_mm2].map(|mm2| format!("{:.2}", mm2 / CM2));
        let off = [mean, largest].map(|off| format!("{off:.1}"));
        for (x, value) in NUMBERS_AT_MM.into_iter().zip(cm2.into_iter().chain(off)) {
            self.text(x, TextAnchor::Right, value);
        }
    }

    fn x(&self, mm: f64) -> f64 {
        self.frame.usable.left_mm + mm * self.factor
    }

    fn baseline(&self) -> f64 {
        self.frame.usable.top_mm - (self.row as f64 + 0.7) * ROW_MM * self.factor
    }

    fn text(&mut self, at_mm: f64, anchor: TextAnchor, text: String) {
        let place = [self.x(at_mm), self.baseline()];
        self.marks.push(Mark::text(place, TEXT_MM * self.factor, anchor, text));
    }

    fn swatch(&mut self, colour: [u8; 3]) {
        let middle = self.baseline() + 0.5 * CAP_HEIGHT * TEXT_MM * self.factor;
        let half = 0.5 * SWATCH_MM * self.factor;
        let (left, right) = (self.x(SWATCH_AT_MM), self.x(SWATCH_AT_MM) + 4.0 * half);
        self.marks
            .extend(swatch(RectMm::new(left, middle - half, right, middle + half), colour));
    }
}

/// Draws a filled rectangle with a line around it, so that white is visible too.
pub fn swatch(area: RectMm, colour: [u8; 3]) -> [Mark; 2] {
    [Mark::fill(area.grown(RULE_MM), BLACK), Mark::fill(area, colour)]
}
