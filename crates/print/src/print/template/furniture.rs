//! Everything on a template's page that is not pattern: crop and registration marks, seam letters, ghost lines, rulers,
//! captions, arrows, sheet id and mini-map.

use super::layout::{SheetLayout, SheetPlan};
use super::{Front, TemplateRequest};
use crate::print::frame::{CROP_STRIP_MM, KEY_WIDTH_MM, PageFrame};
use crate::print::ruler;
use crate::print::sheet::{BLACK, Fill, Mark, PointMm, RectMm, Srgb8, TextAnchor, WHITE};
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm, number, printable, shortened, width_mm};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::picture::Picture;

const CROP_LINE_MM: f64 = 0.15;
/// Between the pattern and the near end of a crop mark, and between its far end and whatever comes next.
const CROP_GAP_MM: f64 = 1.0;
/// Half the length of a registration cross's arms.
const CROSS_MM: f64 = 2.0;
/// From the middle of a side, and of its cross, to the seam's letter.
const SEAM_OFFSET_MM: f64 = 5.0;
const SEAM_LETTER_MM: f64 = 4.2;
const GHOST_LINE_MM: f64 = 0.4;
const GREY: Srgb8 = [120, 120, 120];

const CAPTION_MM: f64 = 2.5;
const CAPTION_LEADING_MM: f64 = 3.3;
/// The largest file name, as a share of the caption line.
const NAME_SHARE: f64 = 0.4;

const ARROW_MM: f64 = 4.0;
const ARROW_LINE_MM: f64 = 0.35;
const ARROW_LABEL_MM: f64 = 1.9;

const ID_MM: f64 = 5.0;
/// Between the map and the foot of the id above it.
const ID_GAP_MM: f64 = 1.5;
const MAP_HEIGHT_MM: f64 = 11.0;
/// A map of one row of many sheets would otherwise be a hairline.
const MAP_LEAST_MM: f64 = 1.5;

/// All marks of one sheet besides the pattern.
pub fn all(layout: &SheetLayout, plan: &SheetPlan, captions: &Captions) -> Vec<Mark> {
    let mut marks = guides(layout, plan);
    marks.extend(around(layout, plan, captions));
    marks
}

/// What stands around the content, whatever it is: rulers, captions, arrows, sheet id and mini-map.
pub fn around(layout: &SheetLayout, plan: &SheetPlan, captions: &Captions) -> Vec<Mark> {
    let mut marks = rulers(&layout.frame);
    marks.extend(captions.marks(layout.frame.printable));
    marks.extend(captions.arrows(&layout.frame));
    marks.extend(key(layout, plan, captions));
    marks
}

/// What leads the knife and the glue: ghost lines, crop marks, registration crosses, seam letters.
pub fn guides(layout: &SheetLayout, plan: &SheetPlan) -> Vec<Mark> {
    let mut marks = ghost_lines(layout, plan);
    marks.extend(crop_marks(plan));
    marks.extend(sides(layout, plan));
    marks
}

/// Both rulers of a page.
pub fn rulers(frame: &PageFrame) -> Vec<Mark> {
    let mut marks = ruler::horizontal(frame.horizontal_ruler);
    marks.extend(ruler::vertical(frame.vertical_ruler));
    marks
}

/// Dashes where the neighbouring sheets begin. They lie wholly in the overlap, so that the cut sheet stays clean, and are
/// black on white so that they show on any pattern.
fn ghost_lines(layout: &SheetLayout, plan: &SheetPlan) -> Vec<Mark> {
    let (trim, printed) = (plan.trim, plan.printed);
    let seams = layout.seams(plan.row, plan.column);
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
    if seams.right.is_some() && printed.right_mm - trim.right_mm > 2.0 * GHOST_LINE_MM {
        let x = trim.right_mm + 0.5 * GHOST_LINE_MM;
        ghost((x, printed.top_mm), (x, printed.bottom_mm));
    }
    if seams.below.is_some() && trim.bottom_mm - printed.bottom_mm > 2.0 * GHOST_LINE_MM {
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
        let both = spans(printed.bottom_mm, printed.top_mm);
        marks.extend(both.map(|(from, to)| Mark::line((x, from), (x, to), CROP_LINE_MM)));
    }
    for y in [trim.bottom_mm, trim.top_mm] {
        let both = spans(printed.left_mm, printed.right_mm);
        marks.extend(both.map(|(from, to)| Mark::line((from, y), (to, y), CROP_LINE_MM)));
    }
    marks
}

/// Outside the middle of each side: a registration cross, and the letter of the seam if a neighbour follows. The crosses of
/// both sheets of a seam are at the same place of the template.
fn sides(layout: &SheetLayout, plan: &SheetPlan) -> Vec<Mark> {
    let (trim, printed) = (plan.trim, plan.printed);
    let seams = layout.seams(plan.row, plan.column);
    let (x, y) = (
        0.5 * (trim.left_mm + trim.right_mm),
        0.5 * (trim.bottom_mm + trim.top_mm),
    );
    let out = 0.5 * CROP_STRIP_MM;
    let mut marks = Vec::new();
    let mut side = |at: (f64, f64), length_mm: f64, letter_at: (f64, f64), letter: Option<String>| {
        // On a sliver the crosses would run into the crop marks.
        if length_mm > 2.0 * CROP_STRIP_MM {
            marks.push(Mark::line(
                (at.0 - CROSS_MM, at.1),
                (at.0 + CROSS_MM, at.1),
                CROP_LINE_MM,
            ));
            marks.push(Mark::line(
                (at.0, at.1 - CROSS_MM),
                (at.0, at.1 + CROSS_MM),
                CROP_LINE_MM,
            ));
        }
        if let Some(letter) = letter {
            let size_mm = fitting_size_mm(&letter, SEAM_LETTER_MM, CROP_STRIP_MM - 1.0);
            let baseline = letter_at.1 - 0.5 * CAP_HEIGHT * size_mm;
            marks.push(Mark::text((letter_at.0, baseline), size_mm, TextAnchor::Centre, letter));
        }
    };
    for (at_x, letter) in [
        (printed.left_mm - out, seams.left),
        (printed.right_mm + out, seams.right),
    ] {
        side((at_x, y), trim.height_mm(), (at_x, y + SEAM_OFFSET_MM), letter);
    }
    for (at_y, letter) in [
        (printed.top_mm + out, seams.above),
        (printed.bottom_mm - out, seams.below),
    ] {
        side((x, at_y), trim.width_mm(), (x + SEAM_OFFSET_MM, at_y), letter);
    }
    marks
}

/// The captions at the foot, the same on every sheet.
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
        let short_hash = pattern.sha256().get(..12).unwrap_or_default();
        let facts = [
            format!("sha256 {short_hash}"),
            format!("tile {} mm", number(request.tile_mm)),
            format!("cell {} mm", number(cell_mm)),
            format!("scale 1:{}", number(request.scale)),
        ];
        Self::of_image(request, &facts.join(" · "))
    }

    /// The captions of a repeated image without cells.
    pub(super) fn of_texture(texture: &Picture, request: &TemplateRequest, pixel_mm: f64) -> Self {
        let facts = [
            format!("sha256 {}", texture.sha256.get(..12).unwrap_or_default()),
            format!("tile {} mm", number(request.tile_mm)),
            format!("{:.0} dpi", 25.4 / pixel_mm),
            format!("scale 1:{}", number(request.scale)),
        ];
        Self::of_image(request, &facts.join(" · "))
    }

    /// The captions of an image that is printed as it is, with these facts about it.
    pub fn of_image(request: &TemplateRequest, facts: &str) -> Self {
        Self {
            piece: None,
            name: printable(&request.pattern_name),
            facts: printable(facts),
            making: making(request),
            true_size: true_size(request.scale),
            front: request.front,
        }
    }

    /// The captions of one panel of several, whose name stands in them and before the ids of its sheets.
    pub fn of_panel(mut self, panel: &str) -> Self {
        self.facts = format!("{panel} panel · {}", self.facts);
        self.of_piece(panel)
    }

    /// The captions of one piece of several, whose name stands before the ids of its sheets.
    pub fn of_piece(mut self, piece: &str) -> Self {
        self.piece = Some(piece.to_owned());
        self
    }

    /// What the template is of, shortened to a width.
    pub fn title(&self, size_mm: f64, most_mm: f64) -> String {
        shortened(&self.name, size_mm, most_mm)
    }

    pub fn marks(&self, printable: RectMm) -> Vec<Mark> {
        let most_mm = printable.width_mm() - KEY_WIDTH_MM - 2.0;
        let name = shortened(&self.name, CAPTION_MM, NAME_SHARE * most_mm);
        let lines = [
            "Print at 100 % (no fit to page): both rulers must measure 100 mm.".to_owned(),
            self.true_size.clone(),
            format!("{name} · {}", self.facts),
            self.making.clone(),
        ];
        let last = lines.len() - 1;
        let place = |(i, line): (usize, String)| {
            let baseline = printable.bottom_mm + 0.8 + (last - i) as f64 * CAPTION_LEADING_MM;
            let size_mm = fitting_size_mm(&line, CAPTION_MM, most_mm);
            Mark::text((printable.left_mm, baseline), size_mm, TextAnchor::Left, line)
        };
        lines.into_iter().enumerate().map(place).collect()
    }

    /// Which way up the piece goes on the model, and where the model's front is: at the top of the key block.
    fn arrows(&self, frame: &PageFrame) -> Vec<Mark> {
        let middle = frame.horizontal_ruler.y_mm - 0.5 * ARROW_MM - 0.3;
        let baseline = middle - 0.5 * CAP_HEIGHT * ARROW_LABEL_MM;
        let label = |x: f64, text: &str| Mark::text((x, baseline), ARROW_LABEL_MM, TextAnchor::Left, text);
        let left = frame.printable.right_mm - KEY_WIDTH_MM;
        let mut marks = arrow((left + 1.0, middle), (0.0, 1.0));
        marks.push(label(left + 2.5, "UP"));
        if let Some(direction) = self.front.direction() {
            let text_left = frame.printable.right_mm - width_mm("FRONT", ARROW_LABEL_MM);
            marks.extend(arrow((text_left - 0.5 * ARROW_MM - 0.5, middle), direction));
            marks.push(label(text_left, "FRONT"));
        }
        marks
    }
}

/// By which printer, program and when.
fn making(request: &TemplateRequest) -> String {
    let program = concat!("scaleproof ", env!("CARGO_PKG_VERSION")).to_owned();
    let date = request.date.as_ref().map(ToString::to_string);
    let making = [Some(request.layout.printer.caption()), Some(program), date];
    making.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}

fn true_size(scale: f64) -> String {
    format!(
        "True size: 45 mm here = {} mm on the car (1:{}).",
        number(45.0 * scale),
        number(scale)
    )
}

/// An arrow of [`ARROW_MM`] around `centre`.
fn arrow(centre: (f64, f64), (dx, dy): (f64, f64)) -> Vec<Mark> {
    let along = |mm: f64, aside: f64| (centre.0 + mm * dx - aside * dy, centre.1 + mm * dy + aside * dx);
    let (tail, tip) = (along(-0.5 * ARROW_MM, 0.0), along(0.5 * ARROW_MM, 0.0));
    let barb = |aside: f64| Mark::line(along(0.5 * ARROW_MM - 1.2, aside), tip, ARROW_LINE_MM);
    vec![Mark::line(tail, tip, ARROW_LINE_MM), barb(0.9), barb(-0.9)]
}

/// The sheet's id above a tiny map of all sheets with this one filled.
fn key(layout: &SheetLayout, plan: &SheetPlan, captions: &Captions) -> Vec<Mark> {
    let map = map_area(layout);
    let mut marks = vec![Mark::Fill(Fill {
        area: map_cell(layout, map, plan),
        colour: GREY,
    })];
    marks.extend(map_grid(layout, map));
    let id = captions
        .piece
        .as_ref()
        .map_or(plan.id(), |piece| format!("{piece} {}", plan.id()));
    let size_mm = fitting_size_mm(&id, ID_MM, KEY_WIDTH_MM);
    let place = (map.right_mm, map.top_mm + ID_GAP_MM);
    marks.push(Mark::text(place, size_mm, TextAnchor::Right, id));
    marks
}

/// Where a sheet lies on a map of the template.
pub fn map_cell(layout: &SheetLayout, map: RectMm, plan: &SheetPlan) -> RectMm {
    let size = layout.size_mm();
    let x = |mm: f64| map.left_mm + map.width_mm() * mm / size.0;
    let y = |mm: f64| map.top_mm - map.height_mm() * mm / size.1;
    let own = plan.own;
    RectMm::new(x(own.left_mm), y(own.bottom_mm), x(own.right_mm), y(own.top_mm))
}

/// The lines of a map: the outline of every sheet, shared ones once.
pub fn map_grid(layout: &SheetLayout, map: RectMm) -> Vec<Mark> {
    let mut marks = vec![
        Mark::line((map.left_mm, map.bottom_mm), (map.left_mm, map.top_mm), CROP_LINE_MM),
        Mark::line((map.left_mm, map.top_mm), (map.right_mm, map.top_mm), CROP_LINE_MM),
    ];
    for plan in layout.sheets.iter().filter(|plan| plan.row == 0) {
        let x = map_cell(layout, map, plan).right_mm;
        marks.push(Mark::line((x, map.bottom_mm), (x, map.top_mm), CROP_LINE_MM));
    }
    for plan in layout.sheets.iter().filter(|plan| plan.column == 0) {
        let y = map_cell(layout, map, plan).bottom_mm;
        marks.push(Mark::line((map.left_mm, y), (map.right_mm, y), CROP_LINE_MM));
    }
    marks
}

/// The mini-map's place: bottom right, in the template's proportions.
fn map_area(layout: &SheetLayout) -> RectMm {
    let (width, height) = layout.size_mm();
    let inset = 0.5 * CROP_LINE_MM;
    let printable = layout.frame.printable;
    let (right, bottom) = (printable.right_mm - inset, printable.bottom_mm + inset);
    let factor = ((KEY_WIDTH_MM - 2.0 * inset) / width).min(MAP_HEIGHT_MM / height);
    let (wide, high) = ((width * factor).max(MAP_LEAST_MM), (height * factor).max(MAP_LEAST_MM));
    RectMm::new(right - wide, bottom, right, bottom + high)
}
