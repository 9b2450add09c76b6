//! Marks on a template's page besides the pattern: crop and registration marks, seam letters, ghost lines, rulers, captions, arrows, sheet id and
//! mini-map.

use super::layout::{SheetLayout, SheetPlan};
use super::{Front, TemplateRequest};
use crate::frame::{CROP_STRIP_MM, KEY_WIDTH_MM, PageFrame};
use crate::media::Media;
use crate::ruler;
use crate::sheet::{BLACK, Mark, RectMm, Sheet, Srgb8, TextAnchor, WHITE};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::{CAP_HEIGHT, number, printable, shortened, width_mm};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::picture::Picture;

const CROP_LINE_MM: f64 = 0.15;
/// Gap between the pattern and the near end of a crop mark, and beyond its far end.
const CROP_GAP_MM: f64 = 1.0;
/// Half length of a registration cross's arms.
const CROSS_MM: f64 = 2.0;
/// Distance of the seam's letter from the middle of a side, and of its cross.
const SEAM_OFFSET_MM: f64 = 5.0;
const SEAM_LETTER_MM: f64 = 4.2;
const GHOST_LINE_MM: f64 = 0.4;
const GREY: Srgb8 = [120, 120, 120];

const CAPTION_MM: f64 = 2.5;
const CAPTION_LEADING_MM: f64 = 3.3;
/// Maximum width of a file name, as a share of the caption line.
const NAME_SHARE: f64 = 0.4;

const ARROW_MM: f64 = 4.0;
const ARROW_LINE_MM: f64 = 0.35;
const ARROW_LABEL_MM: f64 = 1.9;

const ID_MM: f64 = 5.0;
/// Gap between the map and the foot of the id above it.
const ID_GAP_MM: f64 = 1.5;
const MAP_HEIGHT_MM: f64 = 11.0;
/// Minimum side of the map: one row of many sheets would otherwise be a hairline.
const MAP_LEAST_MM: f64 = 1.5;

pub fn all(layout: &SheetLayout, plan: &SheetPlan, captions: &Captions) -> Vec<Mark> {
    [guides(layout, plan), around(layout, plan, captions)].concat()
}

/// Draws the marks around any content: rulers, captions, arrows, sheet id and mini-map.
pub fn around(layout: &SheetLayout, plan: &SheetPlan, captions: &Captions) -> Vec<Mark> {
    [
        rulers(&layout.frame),
        captions.marks(layout.frame.printable),
        captions.arrows(&layout.frame),
        key(layout, plan, captions),
    ]
    .concat()
}

/// Draws the guides for cutting and gluing: ghost lines, crop marks, registration crosses, seam letters.
pub fn guides(layout: &SheetLayout, plan: &SheetPlan) -> Vec<Mark> {
    [ghost_lines(layout, plan), crop_marks(plan), sides(layout, plan)].concat()
}

pub fn rulers(frame: &PageFrame) -> Vec<Mark> {
    [
        ruler::horizontal(frame.horizontal_ruler),
        ruler::vertical(frame.vertical_ruler),
    ]
    .concat()
}

/// Draws dashes along the edges of the neighbouring sheets. They lie wholly in the overlap, so that the cut sheet stays clean, and are black on white
/// so that they are visible on any pattern.
fn ghost_lines(layout: &SheetLayout, plan: &SheetPlan) -> Vec<Mark> {
    let (trim, printed) = (plan.trim, plan.printed);
    let seams = layout.seams(plan.row, plan.column);
    let mut marks = Vec::new();
    let mut ghost = |from: Point2, to: Point2| {
        for (colour, dash_mm) in [(WHITE, None), (BLACK, Some((2.0, 2.0)))] {
            marks.push(Mark::stroke([from, to], GHOST_LINE_MM, dash_mm, colour));
        }
    };
    // A strip too narrow for the line needs none.
    if seams.right.is_some() && printed.right_mm - trim.right_mm > 2.0 * GHOST_LINE_MM {
        let x = trim.right_mm + 0.5 * GHOST_LINE_MM;
        ghost([x, printed.top_mm], [x, printed.bottom_mm]);
    }
    if seams.below.is_some() && trim.bottom_mm - printed.bottom_mm > 2.0 * GHOST_LINE_MM {
        let y = trim.bottom_mm - 0.5 * GHOST_LINE_MM;
        ghost([printed.left_mm, y], [printed.right_mm, y]);
    }
    marks
}

/// Draws eight short lines outside the printed area that point at the edges of the trim.
fn crop_marks(plan: &SheetPlan) -> Vec<Mark> {
    let (trim, printed) = (plan.trim, plan.printed);
    let length = CROP_STRIP_MM - 2.0 * CROP_GAP_MM;
    let spans = |low: f64, high: f64| {
        [
            (low - CROP_GAP_MM - length, low - CROP_GAP_MM),
            (high + CROP_GAP_MM, high + CROP_GAP_MM + length),
        ]
    };
    let crop = |at: [f64; 2], [low, high]: [f64; 2], point: fn(f64, f64) -> Point2| {
        let lines = at.map(|at| spans(low, high).map(|(from, to)| [point(at, from), point(at, to)]));
        lines
            .into_iter()
            .flatten()
            .map(|[from, to]| Mark::line(from, to, CROP_LINE_MM))
    };
    let ([left, bottom, right, top], [low_x, low_y, high_x, high_y]) = (trim.edges(), printed.edges());
    let upright = crop([left, right], [low_y, high_y], |x, y| [x, y]);
    upright
        .chain(crop([bottom, top], [low_x, high_x], |y, x| [x, y]))
        .collect()
}

/// Draws, outside the middle of each side, a registration cross, and the letter of the seam if there is a neighbour. The crosses of both sheets of a
/// seam are at the same place of the template.
fn sides(layout: &SheetLayout, plan: &SheetPlan) -> Vec<Mark> {
    let (trim, printed) = (plan.trim, plan.printed);
    let seams = layout.seams(plan.row, plan.column);
    let [x, y] = trim.middle();
    let out = 0.5 * CROP_STRIP_MM;
    let mut marks = Vec::new();
    let mut side = |[x, y]: Point2, length_mm: f64, [aside, above]: Point2, letter: Option<String>| {
        // On a sliver the crosses would overlap the crop marks.
        if length_mm > 2.0 * CROP_STRIP_MM {
            marks.push(Mark::line([x - CROSS_MM, y], [x + CROSS_MM, y], CROP_LINE_MM));
            marks.push(Mark::line([x, y - CROSS_MM], [x, y + CROSS_MM], CROP_LINE_MM));
        }
        let room = (SEAM_LETTER_MM, CROP_STRIP_MM - 1.0);
        marks.extend(letter.map(|letter| Mark::centred([x + aside, y + above], room, letter)));
    };
    let (upright, level) = ([0.0, SEAM_OFFSET_MM], [SEAM_OFFSET_MM, 0.0]);
    side([printed.left_mm - out, y], trim.height_mm(), upright, seams.left);
    side([printed.right_mm + out, y], trim.height_mm(), upright, seams.right);
    side([x, printed.top_mm + out], trim.width_mm(), level, seams.above);
    side([x, printed.bottom_mm - out], trim.width_mm(), level, seams.below);
    marks
}

/// Captions at the foot, identical on every sheet.
pub struct Captions {
    piece: Option<String>,
    name: String,
    facts: String,
    making: String,
    true_size: String,
    front: Front,
}

impl Captions {
    pub fn new(pattern: &Pattern, request: &TemplateRequest, cell_mm: f64) -> Self {
        Self::from_repeat(pattern.sha256(), request, &format!("cell {} mm", number(cell_mm)))
    }

    /// Creates the captions of a repeated image without cells.
    pub(super) fn from_texture(texture: &Picture, request: &TemplateRequest, pixel_mm: f64) -> Self {
        Self::from_repeat(&texture.sha256, request, &format!("{:.0} dpi", 25.4 / pixel_mm))
    }

    fn from_repeat(sha256: &str, request: &TemplateRequest, grain: &str) -> Self {
        let hash = sha256.get(..12).unwrap_or_default();
        let [tile, scale] = [request.tile_mm, request.scale].map(number);
        let facts = format!("sha256 {hash} · tile {tile} mm · {grain} · scale 1:{scale}");
        Self::of_image(request, &facts)
    }

    pub fn of_image(request: &TemplateRequest, facts: &str) -> Self {
        Self {
            piece: None,
            name: printable(&request.pattern_name),
            facts: printable(facts),
            making: making(&request.layout.media),
            true_size: format!(
                "True size: 45 mm here = {} mm on the car (1:{}).",
                number(45.0 * request.scale),
                number(request.scale)
            ),
            front: request.front,
        }
    }

    /// Adds the name of one panel of several to the captions and before the ids of its sheets.
    pub fn of_panel(mut self, panel: &str) -> Self {
        self.facts = format!("{panel} panel · {}", self.facts);
        self.of_piece(panel)
    }

    /// Adds the name of one piece of several before the ids of its sheets.
    pub fn of_piece(mut self, piece: &str) -> Self {
        self.piece = Some(piece.to_owned());
        self
    }

    /// Returns the pattern's name, shortened to a width.
    pub fn title(&self, size_mm: f64, most_mm: f64) -> String {
        shortened(&self.name, size_mm, most_mm)
    }

    /// Draws the captions in the printable part of a page.
    pub fn marks(&self, printable: RectMm) -> Vec<Mark> {
        let most_mm = printable.width_mm() - KEY_WIDTH_MM - 2.0;
        let name = shortened(&self.name, CAPTION_MM, NAME_SHARE * most_mm);
        let named = format!("{name} · {}", self.facts);
        let check = "Print at 100 % (no fit to page): both rulers must measure 100 mm.";
        let lines = [check, &self.true_size, &named, &self.making];
        Mark::lines(lines, printable.left_mm, (CAPTION_MM, most_mm), |i| {
            printable.bottom_mm + 0.8 + (lines.len() - 1 - i) as f64 * CAPTION_LEADING_MM
        })
    }

    /// Returns a whole page with these captions and rulers around some marks.
    pub fn sheet(&self, frame: &PageFrame, mut marks: Vec<Mark>) -> Sheet {
        marks.extend(rulers(frame));
        marks.extend(self.marks(frame.printable));
        frame.sheet(frame.whole(), frame.whole(), marks)
    }

    /// Draws the arrows to the piece's top and to the model's front, at the top of the key block.
    fn arrows(&self, frame: &PageFrame) -> Vec<Mark> {
        let middle = frame.horizontal_ruler[1] - 0.5 * ARROW_MM - 0.3;
        let baseline = middle - 0.5 * CAP_HEIGHT * ARROW_LABEL_MM;
        let label = |x: f64, text: &str| Mark::text([x, baseline], ARROW_LABEL_MM, TextAnchor::Left, text);
        let left = frame.printable.right_mm - KEY_WIDTH_MM;
        let mut marks = arrow([left + 1.0, middle], [0.0, 1.0]);
        marks.push(label(left + 2.5, "UP"));
        if let Some(direction) = self.front.direction() {
            let text_left = frame.printable.right_mm - width_mm("FRONT", ARROW_LABEL_MM);
            marks.extend(arrow([text_left - 0.5 * ARROW_MM - 0.5, middle], direction));
            marks.push(label(text_left, "FRONT"));
        }
        marks
    }
}

/// Returns a clause that names the printer correction, the program and the date.
pub fn making(media: &Media) -> String {
    let program = concat!("scaleproof ", env!("CARGO_PKG_VERSION"));
    let date = media.date.map_or(String::new(), |date| format!(" · {date}"));
    format!("{} · {program}{date}", media.printer.caption())
}

/// Draws an arrow of [`ARROW_MM`] around `centre`.
fn arrow([x, y]: Point2, [dx, dy]: Point2) -> Vec<Mark> {
    let along = |mm: f64, aside: f64| [x + mm * dx - aside * dy, y + mm * dy + aside * dx];
    let (tail, tip) = (along(-0.5 * ARROW_MM, 0.0), along(0.5 * ARROW_MM, 0.0));
    let barb = |aside: f64| Mark::line(along(0.5 * ARROW_MM - 1.2, aside), tip, ARROW_LINE_MM);
    vec![Mark::line(tail, tip, ARROW_LINE_MM), barb(0.9), barb(-0.9)]
}

/// Draws the sheet's id above a tiny map of all sheets with this one filled.
fn key(layout: &SheetLayout, plan: &SheetPlan, captions: &Captions) -> Vec<Mark> {
    let map = map_area(layout);
    let mut marks = vec![Mark::fill(map_cell(layout, map, plan), GREY)];
    marks.extend(map_grid(layout, map));
    let piece = captions
        .piece
        .as_ref()
        .map_or(String::new(), |piece| format!("{piece} "));
    let at = [map.right_mm, map.top_mm + ID_GAP_MM];
    let id = piece + &plan.id();
    marks.push(Mark::fitted(at, (ID_MM, KEY_WIDTH_MM), TextAnchor::Right, id));
    marks
}

pub fn map_cell(layout: &SheetLayout, map: RectMm, plan: &SheetPlan) -> RectMm {
    let size = layout.size_mm();
    let x = |mm: f64| map.left_mm + map.width_mm() * mm / size.0;
    let y = |mm: f64| map.top_mm - map.height_mm() * mm / size.1;
    let own = plan.own;
    RectMm::new(x(own.left_mm), y(own.bottom_mm), x(own.right_mm), y(own.top_mm))
}

/// Draws the lines of a map: the outline of every sheet, shared ones once.
pub fn map_grid(layout: &SheetLayout, map: RectMm) -> Vec<Mark> {
    let [left, bottom, right, top] = map.edges();
    let upright = |x: f64| Mark::line([x, bottom], [x, top], CROP_LINE_MM);
    let level = |y: f64| Mark::line([left, y], [right, y], CROP_LINE_MM);
    let first_row = layout.sheets.iter().filter(|plan| plan.row == 0);
    let first_column = layout.sheets.iter().filter(|plan| plan.column == 0);
    let mut marks = vec![upright(left), level(top)];
    marks.extend(first_row.map(|plan| upright(map_cell(layout, map, plan).right_mm)));
    marks.extend(first_column.map(|plan| level(map_cell(layout, map, plan).bottom_mm)));
    marks
}

/// Returns the mini-map's area: bottom right, in the template's proportions.
fn map_area(layout: &SheetLayout) -> RectMm {
    let (width, height) = layout.size_mm();
    let inset = 0.5 * CROP_LINE_MM;
    let printable = layout.frame.printable;
    let (right, bottom) = (printable.right_mm - inset, printable.bottom_mm + inset);
    let factor = ((KEY_WIDTH_MM - 2.0 * inset) / width).min(MAP_HEIGHT_MM / height);
    let (wide, high) = ((width * factor).max(MAP_LEAST_MM), (height * factor).max(MAP_LEAST_MM));
    RectMm::new(right - wide, bottom, right, bottom + high)
}
