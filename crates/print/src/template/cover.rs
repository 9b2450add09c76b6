//! First page of a template: assembly of the sheets, their map, and the scale check that is filled in by hand.

use super::furniture::{self, Captions};
use super::layout::SheetLayout;
use crate::frame::PageFrame;
use crate::sheet::{Mark, RectMm, Sheet, TextAnchor};
use scaleproof_plot::lettering::{CAP_HEIGHT, wrapped};

const TITLE_MM: f64 = 5.0;
const TEXT_MM: f64 = 2.8;
const LEADING_MM: f64 = 4.0;
const FACT_MM: f64 = 2.5;
const FACT_LEADING_MM: f64 = 3.5;
const GAP_MM: f64 = 4.0;
/// Gap between facts and the scale check.
const FACTS_AIR_MM: f64 = 2.0;
/// Height of the scale check above the horizontal ruler.
const CHECK_MM: f64 = 20.0;
/// Maximum size of letters on the map.
const MAP_ID_MM: f64 = 6.0;
const MAP_SEAM_MM: f64 = 3.2;
/// Maximum size of the map, enough to read it.
const MAP_MOST_MM: f64 = 150.0;

/// Maximum width of text; wider text is hard to read, even on a wide roll.
const BODY_MOST_MM: f64 = 320.0;

/// Draws the first page of a template: a heading, numbered steps, the map and the scale check.
pub fn cover(layout: &SheetLayout, captions: &Captions, heading: &str, steps: &[impl AsRef<str>]) -> Sheet {
    first_page(&layout.cover, captions, heading, (steps, &[]), |room| map(layout, room))
}

/// Draws a first page of numbered steps, facts, and a picture beside or below them.
pub fn first_page(
    frame: &PageFrame,
    captions: &Captions,
    heading: &str,
    texts: (&[impl AsRef<str>], &[String]),
    picture: impl FnOnce(RectMm) -> Vec<Mark>,
) -> Sheet {
    let title = format!("{heading}: {}", captions.title(TITLE_MM, 0.5 * frame.usable.width_mm()));
    captions.sheet(frame, instructions(frame, title, texts, picture))
}

/// Draws a title at the top of an area; returns it and the free area below.
pub fn titled(area: RectMm, title: String) -> (Mark, RectMm) {
    let title_y = area.top_mm - CAP_HEIGHT * TITLE_MM;
    let room = (TITLE_MM, area.width_mm());
    let mark = Mark::fitted([area.left_mm, title_y], room, TextAnchor::Left, title);
    let top_mm = title_y - GAP_MM;
    (mark, RectMm { top_mm, ..area })
}

/// Draws a title, numbered steps, facts, a picture beside or below them, and the scale check.
pub fn instructions(
    frame: &PageFrame,
    title: String,
    (steps, facts): (&[impl AsRef<str>], &[String]),
    picture: impl FnOnce(RectMm) -> Vec<Mark>,
) -> Vec<Mark> {
    let (title, free) = titled(frame.usable, title);
    let mut marks = vec![title];
    let air_mm = if facts.is_empty() { 0.0 } else { FACTS_AIR_MM };
    let body = RectMm {
        bottom_mm: free.bottom_mm + CHECK_MM + air_mm,
        right_mm: free.right_mm.min(free.left_mm + BODY_MOST_MM),
        ..free
    };
    let is_wide = body.width_mm() > 1.2 * (body.height_mm() + 2.0 * air_mm);
    let text_mm = if is_wide {
        0.5 * body.width_mm() - GAP_MM
    } else {
        body.width_mm()
    };
    let mut line = |x: f64, y: f64, size_mm: f64, text: String| {
        marks.push(Mark::text([x, y], size_mm, TextAnchor::Left, text));
    };
    let mut y = body.top_mm - CAP_HEIGHT * TEXT_MM;
    for (i, step) in steps.iter().enumerate() {
        line(body.left_mm, y, TEXT_MM, format!("{}.", i + 1));
        for text in wrapped(step.as_ref(), TEXT_MM, text_mm - 2.0 * TEXT_MM) {
            line(body.left_mm + 2.0 * TEXT_MM, y, TEXT_MM, text);
            y -= LEADING_MM;
        }
        y -= 0.2 * LEADING_MM;
    }
    y = y + LEADING_MM - GAP_MM;
    if !facts.is_empty() {
        for text in facts.iter().flat_map(|fact| wrapped(fact, FACT_MM, text_mm)) {
            line(body.left_mm, y, FACT_MM, text);
            y -= FACT_LEADING_MM;
        }
        y -= GAP_MM;
    }
    marks.extend(picture(if is_wide {
        let left_mm = body.left_mm + text_mm + 2.0 * GAP_MM;
        RectMm { left_mm, ..body }
    } else {
        RectMm { top_mm: y, ..body }
    }));
    marks.extend(scale_check(frame));
    marks
}

/// Returns the steps from printed sheets to a piece on the model.
pub fn assembly(layout: &SheetLayout) -> Vec<&'static str> {
    let mut steps = vec!["Print at 100 %, without fit to page. Measure both rulers below before you cut anything."];
    if layout.sheets.len() == 1 {
        steps.push("Cut at the crop marks. The pattern runs on beyond them, so that no white edge is left.");
    } else {
        steps.push("Lay the sheets out as on the map. Seams that meet have the same letter.");
        steps.push(
            "Cut each sheet at the crop marks of its left and upper edge, and of every outer edge of the template.",
        );
        steps.push(
            "Leave the strip beyond a dashed line: it goes under the next sheet. Glue that sheet with its cut edge on the \
             dashed line and the crosses of both sheets in line.",
        );
        steps.push(
            "Go row by row from the top left, and cut a sheet when it is its turn: its seam letters go with the scrap.",
        );
    }
    steps.push("Glue the piece onto the model with its arrows pointing up and to the front.");
    steps
}

/// Draws all sheets with their ids and the letters of their seams.
fn map(layout: &SheetLayout, room: RectMm) -> Vec<Mark> {
    let (width, height) = layout.size_mm();
    let factor = (room.width_mm().min(MAP_MOST_MM) / width).min(room.height_mm().min(MAP_MOST_MM) / height);
    let (wide, high) = (width * factor, height * factor);
    let area = RectMm::new(room.left_mm, room.top_mm - high, room.left_mm + wide, room.top_mm);
    let mut marks = furniture::map_grid(layout, area);
    for plan in &layout.sheets {
        let cell = furniture::map_cell(layout, area, plan);
        let [x, y] = cell.middle();
        let (wide, high) = (cell.width_mm(), cell.height_mm());
        let mut centred = |at: [f64; 2], most_mm: f64, largest: f64, text: String| {
            marks.push(Mark::centred(at, (largest.min(0.25 * high), most_mm), text));
        };
        centred([x, y], 0.5 * wide, MAP_ID_MM, plan.id());
        let seams = layout.seams(plan.row, plan.column);
        // Beside the seam, on both of its sides.
        let (aside, above) = ((0.1 * wide).min(MAP_SEAM_MM), (0.15 * high).min(MAP_SEAM_MM));
        for (at, letter) in [
            ([cell.left_mm + aside, y], seams.left),
            ([cell.right_mm - aside, y], seams.right),
            ([x, cell.top_mm - above], seams.above),
            ([x, cell.bottom_mm + above], seams.below),
        ] {
            if let Some(letter) = letter {
                centred(at, 0.15 * wide, MAP_SEAM_MM, letter);
            }
        }
    }
    marks
}

/// Draws two blanks, named as the options of `print verify`: its x is the paper's short side, in either orientation.
fn scale_check(frame: &PageFrame) -> Vec<Mark> {
    let area = frame.usable;
    let (horizontal, vertical) = if frame.setup.turned { ("y", "x") } else { ("x", "y") };
    let blanks = format!(
        "{horizontal} measured (lower ruler) ____________ mm     {vertical} measured (left ruler) ____________ mm"
    );
    let command = frame.setup.printer.verify_command();
    let then = format!("then: {command}, and export again with --printer printer.toml");
    let heading = "Scale check. Measure both rulers to 0.1 mm and write down:";
    let top = area.bottom_mm + CHECK_MM - LEADING_MM;
    Mark::lines(
        [heading, &blanks, &then],
        area.left_mm,
        (TEXT_MM, area.width_mm()),
        |i| top - i as f64 * 1.5 * LEADING_MM,
    )
}
