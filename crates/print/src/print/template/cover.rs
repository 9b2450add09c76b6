//! A template's first page: how to put the sheets together, their map, and the scale check that is filled in by hand.

use super::furniture::{self, Captions};
use super::layout::SheetLayout;
use crate::print::frame::PageFrame;
use crate::print::sheet::{Mark, RectMm, Sheet, TextAnchor};
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm, wrapped};

const TITLE_MM: f64 = 5.0;
const TEXT_MM: f64 = 2.8;
const LEADING_MM: f64 = 4.0;
const FACT_MM: f64 = 2.5;
const FACT_LEADING_MM: f64 = 3.5;
const GAP_MM: f64 = 4.0;
/// Height of the scale check above the horizontal ruler.
pub const CHECK_MM: f64 = 20.0;
/// Largest lettering on the map.
const MAP_ID_MM: f64 = 6.0;
const MAP_SEAM_MM: f64 = 3.2;
/// The map is no larger than it takes to be read.
const MAP_MOST_MM: f64 = 150.0;

/// Wider text than this is hard to read, whatever the roll.
const BODY_MOST_MM: f64 = 320.0;

/// Draws the first page: a heading, numbered steps, the map and the scale check.
pub fn cover(layout: &SheetLayout, captions: &Captions, heading: &str, instructions: &[&str]) -> Sheet {
    let frame = &layout.cover;
    let area = frame.usable;
    let title_size = TITLE_MM;
    let title = format!("{heading}: {}", captions.title(title_size, 0.5 * area.width_mm()));
    let title_y = area.top_mm - CAP_HEIGHT * title_size;
    let size_mm = fitting_size_mm(&title, title_size, area.width_mm());
    let mut marks = vec![Mark::text((area.left_mm, title_y), size_mm, TextAnchor::Left, title)];
    let right = area.right_mm.min(area.left_mm + BODY_MOST_MM);
    let body = RectMm::new(area.left_mm, area.bottom_mm + CHECK_MM, right, title_y - GAP_MM);
    let (steps_width, beside) = if body.width_mm() > 1.2 * body.height_mm() {
        (0.5 * body.width_mm() - GAP_MM, true)
    } else {
        (body.width_mm(), false)
    };
    let (text, steps_end) = steps(instructions, body, steps_width);
    marks.extend(text);
    let map_room = if beside {
        RectMm::new(
            body.left_mm + steps_width + 2.0 * GAP_MM,
            body.bottom_mm,
            body.right_mm,
            body.top_mm,
        )
    } else {
        RectMm::new(body.left_mm, body.bottom_mm, body.right_mm, steps_end - GAP_MM)
    };
    marks.extend(map(layout, map_room));
    marks.extend(scale_check(frame));
    marks.extend(furniture::rulers(frame));
    marks.extend(captions.marks(frame.printable));
    frame.sheet(frame.whole(), frame.whole(), marks)
}

/// A first page of numbered steps, facts, and a picture beside or below them.
pub fn first_page(
    frame: &PageFrame,
    captions: &Captions,
    heading: &str,
    (instructions, facts): (&[&str], &[String]),
    picture: impl FnOnce(RectMm) -> Vec<Mark>,
) -> Sheet {
    let area = frame.usable;
    let title = format!("{heading}: {}", captions.title(TITLE_MM, 0.5 * area.width_mm()));
    let size_mm = fitting_size_mm(&title, TITLE_MM, area.width_mm());
    let title_y = area.top_mm - CAP_HEIGHT * TITLE_MM;
    let mut marks = vec![Mark::text((area.left_mm, title_y), size_mm, TextAnchor::Left, title)];
    let right = area.right_mm.min(area.left_mm + BODY_MOST_MM);
    let (bottom, top) = (area.bottom_mm + CHECK_MM + 2.0, title_y - GAP_MM);
    let beside = right - area.left_mm > 1.2 * (title_y - bottom);
    let text_right = if beside {
        0.5 * (area.left_mm + right) - GAP_MM
    } else {
        right
    };
    let body = RectMm::new(area.left_mm, bottom, text_right, top);
    let (text, end) = steps(instructions, body, body.width_mm());
    marks.extend(text);
    let (text, end) = lines(facts, body, end - GAP_MM);
    marks.extend(text);
    marks.extend(picture(if beside {
        RectMm::new(text_right + 2.0 * GAP_MM, bottom, right, top)
    } else {
        RectMm::new(area.left_mm, bottom, right, end - GAP_MM)
    }));
    marks.extend(scale_check(frame));
    marks.extend(furniture::rulers(frame));
    marks.extend(captions.marks(frame.printable));
    frame.sheet(frame.whole(), frame.whole(), marks)
}

/// Wrapped lines from `top_mm` down, and where they end.
fn lines(texts: &[String], body: RectMm, top_mm: f64) -> (Vec<Mark>, f64) {
    let mut marks = Vec::new();
    let mut y = top_mm;
    for line in texts.iter().flat_map(|text| wrapped(text, FACT_MM, body.width_mm())) {
        marks.push(Mark::text((body.left_mm, y), FACT_MM, TextAnchor::Left, line));
        y -= FACT_LEADING_MM;
    }
    (marks, y)
}

/// Numbered instructions, and where they end.
pub fn steps(texts: &[impl AsRef<str>], body: RectMm, width_mm: f64) -> (Vec<Mark>, f64) {
    let mut marks = Vec::new();
    let mut y = body.top_mm - CAP_HEIGHT * TEXT_MM;
    for (i, step) in texts.iter().enumerate() {
        marks.push(Mark::text(
            (body.left_mm, y),
            TEXT_MM,
            TextAnchor::Left,
            format!("{}.", i + 1),
        ));
        for line in wrapped(step.as_ref(), TEXT_MM, width_mm - 2.0 * TEXT_MM) {
            marks.push(Mark::text(
                (body.left_mm + 2.0 * TEXT_MM, y),
                TEXT_MM,
                TextAnchor::Left,
                line,
            ));
            y -= LEADING_MM;
        }
        y -= 0.2 * LEADING_MM;
    }
    (marks, y + LEADING_MM)
}

/// The steps from printed sheets to a piece on the model.
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

/// All sheets with their ids and the letters of their seams.
fn map(layout: &SheetLayout, room: RectMm) -> Vec<Mark> {
    let (width, height) = layout.size_mm();
    let factor = (room.width_mm().min(MAP_MOST_MM) / width).min(room.height_mm().min(MAP_MOST_MM) / height);
    let (wide, high) = (width * factor, height * factor);
    let area = RectMm::new(room.left_mm, room.top_mm - high, room.left_mm + wide, room.top_mm);
    let mut marks = furniture::map_grid(layout, area);
    for plan in &layout.sheets {
        let cell = furniture::map_cell(layout, area, plan);
        let (x, y) = (
            0.5 * (cell.left_mm + cell.right_mm),
            0.5 * (cell.bottom_mm + cell.top_mm),
        );
        let (wide, high) = (cell.width_mm(), cell.height_mm());
        let mut centred = |at: (f64, f64), most_mm: f64, largest: f64, text: String| {
            let size_mm = fitting_size_mm(&text, largest.min(0.25 * high), most_mm);
            marks.push(Mark::text(
                (at.0, at.1 - 0.5 * CAP_HEIGHT * size_mm),
                size_mm,
                TextAnchor::Centre,
                text,
            ));
        };
        centred((x, y), 0.5 * wide, MAP_ID_MM, plan.id());
        let seams = layout.seams(plan.row, plan.column);
        // Beside the seam, on both of its sides.
        let (aside, above) = ((0.1 * wide).min(MAP_SEAM_MM), (0.15 * high).min(MAP_SEAM_MM));
        for (at, letter) in [
            ((cell.left_mm + aside, y), seams.left),
            ((cell.right_mm - aside, y), seams.right),
            ((x, cell.top_mm - above), seams.above),
            ((x, cell.bottom_mm + above), seams.below),
        ] {
            if let Some(letter) = letter {
                centred(at, 0.15 * wide, MAP_SEAM_MM, letter);
            }
        }
    }
    marks
}

/// Two blanks, named as `print verify` names them: its x is the paper's short side, whichever way round the page is.
pub fn scale_check(frame: &PageFrame) -> Vec<Mark> {
    let area = frame.usable;
    let (horizontal, vertical) = if frame.setup.turned { ("y", "x") } else { ("x", "y") };
    let lines = [
        "Scale check. Measure both rulers to 0.1 mm and write down:".to_owned(),
        format!(
            "{horizontal} measured (lower ruler) ____________ mm     {vertical} measured (left ruler) ____________ mm"
        ),
        format!(
            "then: {}, and export again with --printer printer.toml",
            frame.setup.printer.verify_command()
        ),
    ];
    let top = area.bottom_mm + CHECK_MM - LEADING_MM;
    let place = |(i, line): (usize, String)| {
        let size_mm = fitting_size_mm(&line, TEXT_MM, area.width_mm());
        Mark::text(
            (area.left_mm, top - i as f64 * 1.5 * LEADING_MM),
            size_mm,
            TextAnchor::Left,
            line,
        )
    };
    lines.into_iter().enumerate().map(place).collect()
}
