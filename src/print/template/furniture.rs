//! Everything on a template's page that is not pattern: crop marks, ghost lines, rulers, captions, sheet id and mini-map.

use super::TemplateRequest;
use super::layout::{CROP_STRIP_MM, KEY_WIDTH_MM, Layout, SheetPlan};
use crate::pattern::Pattern;
use crate::print::lettering::{fitting_size_mm, number, printable, shortened};
use crate::print::ruler;
use crate::print::sheet::{Anchor, BLACK, Fill, Mark, PointMm, RectMm, Rgb, WHITE};

const CROP_LINE_MM: f64 = 0.15;
/// Between the pattern and the near end of a crop mark, and between its far end and whatever comes next.
const CROP_GAP_MM: f64 = 1.0;
const GHOST_LINE_MM: f64 = 0.4;
const GREY: Rgb = [120, 120, 120];

const CAPTION_MM: f64 = 2.5;
const CAPTION_LEADING_MM: f64 = 3.3;
/// The largest file name, as a share of the caption line.
const NAME_SHARE: f64 = 0.4;

const ID_MM: f64 = 5.0;
/// Between the map and the foot of the id above it.
const ID_GAP_MM: f64 = 1.5;
const MAP_HEIGHT_MM: f64 = 11.0;
/// A map of one row of many sheets would otherwise be a hairline.
const MAP_LEAST_MM: f64 = 1.5;

/// All marks of one sheet besides the pattern.
pub fn all(layout: &Layout, plan: &SheetPlan, captions: &Captions) -> Vec<Mark> {
    let mut marks = ghost_lines(plan);
    marks.extend(crop_marks(plan));
    marks.extend(ruler::horizontal(layout.horizontal_ruler));
    marks.extend(ruler::vertical(layout.vertical_ruler));
    marks.extend(captions.marks(layout.printable));
    marks.extend(key(layout, plan));
    marks
}

/// Dashes where the neighbouring sheets begin. They lie wholly in the overlap, so that the cut sheet stays clean, and are
/// black on white so that they show on any pattern.
fn ghost_lines(plan: &SheetPlan) -> Vec<Mark> {
    let (trim, printed) = (plan.trim, plan.printed);
    let mut marks = Vec::new();
    let mut ghost = |from: (f64, f64), to: (f64, f64)| {
        let (from, to) = (PointMm::new(from.0, from.1), PointMm::new(to.0, to.1));
        for (colour, dash_mm) in [(WHITE, None), (BLACK, Some((2.0, 2.0)))] {
            marks.push(Mark::Line {
                from,
                to,
                width_mm: GHOST_LINE_MM,
                dash_mm,
                colour,
            });
        }
    };
    // A strip too narrow for the line is its own mark.
    if printed.right_mm - trim.right_mm > 2.0 * GHOST_LINE_MM {
        let x = trim.right_mm + 0.5 * GHOST_LINE_MM;
        ghost((x, printed.top_mm), (x, printed.bottom_mm));
    }
    if trim.bottom_mm - printed.bottom_mm > 2.0 * GHOST_LINE_MM {
        let y = trim.bottom_mm - 0.5 * GHOST_LINE_MM;
        ghost((printed.left_mm, y), (printed.right_mm, y));
    }
    marks
}

/// Eight short lines outside the printed area that point at the edges of the trim.
fn crop_marks(plan: &SheetPlan) -> Vec<Mark> {
    let (trim, printed) = (plan.trim, plan.printed);
    let length = CROP_STRIP_MM - 2.0 * CROP_GAP_MM;
    let spans = |low: f64, high: f64| {
        [
            (low - CROP_GAP_MM - length, low - CROP_GAP_MM),
            (high + CROP_GAP_MM, high + CROP_GAP_MM + length),
        ]
    };
    let mut marks = Vec::new();
    for x in [trim.left_mm, trim.right_mm] {
        for (from, to) in spans(printed.bottom_mm, printed.top_mm) {
            marks.push(Mark::line((x, from), (x, to), CROP_LINE_MM));
        }
    }
    for y in [trim.bottom_mm, trim.top_mm] {
        for (from, to) in spans(printed.left_mm, printed.right_mm) {
            marks.push(Mark::line((from, y), (to, y), CROP_LINE_MM));
        }
    }
    marks
}

/// The captions at the foot, the same on every sheet.
pub struct Captions {
    name: String,
    facts: String,
    true_size: String,
}

impl Captions {
    pub fn new(pattern: &Pattern, request: &TemplateRequest, cell_mm: f64) -> Self {
        let scale = request.scale;
        let short_hash = pattern.sha256().get(..12).unwrap_or_default();
        let facts = [
            format!("sha256 {short_hash}"),
            format!("tile {} mm", number(request.tile_mm)),
            format!("cell {} mm", number(cell_mm)),
            format!("scale 1:{}", number(scale)),
            concat!("scaleproof ", env!("CARGO_PKG_VERSION")).to_owned(),
        ];
        Self {
            name: printable(&request.pattern_name),
            facts: facts.join(" · "),
            true_size: format!(
                "True size: 45 mm here = {} mm on the car (1:{}).",
                number(45.0 * scale),
                number(scale)
            ),
        }
    }

    fn marks(&self, printable: RectMm) -> Vec<Mark> {
        let most_mm = printable.width_mm() - KEY_WIDTH_MM - 2.0;
        let name = shortened(&self.name, CAPTION_MM, NAME_SHARE * most_mm);
        let lines = [
            "Print at 100 % (no fit to page): both rulers must measure 100 mm.".to_owned(),
            self.true_size.clone(),
            "Cut at the crop marks. A strip beyond a dashed line goes under the next sheet.".to_owned(),
            format!("{name} · {}", self.facts),
        ];
        let last = lines.len() - 1;
        let place = |(i, line): (usize, String)| {
            let baseline = printable.bottom_mm + 0.8 + (last - i) as f64 * CAPTION_LEADING_MM;
            let size_mm = fitting_size_mm(&line, CAPTION_MM, most_mm);
            Mark::text((printable.left_mm, baseline), size_mm, Anchor::Left, line)
        };
        lines.into_iter().enumerate().map(place).collect()
    }
}

/// The sheet's id above a tiny map of all sheets with this one filled.
fn key(layout: &Layout, plan: &SheetPlan) -> Vec<Mark> {
    let map = map_area(layout);
    let x = |column: usize| map.left_mm + map.width_mm() * column as f64 / layout.columns as f64;
    let y = |row: usize| map.top_mm - map.height_mm() * row as f64 / layout.rows as f64;
    let here = RectMm::new(x(plan.column), y(plan.row + 1), x(plan.column + 1), y(plan.row));
    let mut marks = vec![Mark::Fill(Fill {
        area: here,
        colour: GREY,
    })];
    for column in 0..=layout.columns {
        marks.push(Mark::line(
            (x(column), map.bottom_mm),
            (x(column), map.top_mm),
            CROP_LINE_MM,
        ));
    }
    for row in 0..=layout.rows {
        marks.push(Mark::line((map.left_mm, y(row)), (map.right_mm, y(row)), CROP_LINE_MM));
    }
    let id = plan.id();
    let size_mm = fitting_size_mm(&id, ID_MM, KEY_WIDTH_MM);
    marks.push(Mark::text(
        (map.right_mm, map.top_mm + ID_GAP_MM),
        size_mm,
        Anchor::Right,
        id,
    ));
    marks
}

/// The mini-map's place: bottom right, in the template's proportions.
fn map_area(layout: &Layout) -> RectMm {
    let (width, height) = match (layout.sheets.first(), layout.sheets.last()) {
        (Some(first), Some(last)) => (
            last.own.right_mm - first.own.left_mm,
            last.own.bottom_mm - first.own.top_mm,
        ),
        _ => (1.0, 1.0),
    };
    let inset = 0.5 * CROP_LINE_MM;
    let (right, bottom) = (layout.printable.right_mm - inset, layout.printable.bottom_mm + inset);
    let factor = ((KEY_WIDTH_MM - 2.0 * inset) / width).min(MAP_HEIGHT_MM / height);
    let (wide, high) = ((width * factor).max(MAP_LEAST_MM), (height * factor).max(MAP_LEAST_MM));
    RectMm::new(right - wide, bottom, right, bottom + high)
}
