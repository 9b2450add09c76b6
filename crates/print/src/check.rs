//! Check page for measuring a printer: rulers along both axes, boxes, diagonals, and room for the measured values.

use super::SheetError;
use super::frame::PageFrame;
use super::media::Media;
use super::paper::{Paper, Stock};
use super::printer;
use super::sheet::{Mark, RectMm, Sheet, TextAnchor};
use super::template::{making, rulers};
use scaleproof_plot::lettering::{CAP_HEIGHT, number, size, wrapped};

/// Side of the square with its diagonals.
pub const SQUARE_MM: f64 = 100.0;
/// Size of the box that fits a hand: 10 × 5 cm.
pub const BOX_MM: (f64, f64) = (100.0, 50.0);

const LINE_MM: f64 = 0.15;
const GAP_MM: f64 = 8.0;
const TITLE_MM: f64 = 5.0;
const TEXT_MM: f64 = 2.8;
const LEADING_MM: f64 = 4.2;
/// Height of the title and the instructions.
const HEAD_MM: f64 = 42.0;
/// Width of the blanks beside the boxes.
const BLANKS_MM: f64 = 48.0;
/// Length of the check page of a roll.
const ROLL_LENGTH_MM: f64 = 260.0;

/// Positions of the measured shapes on the page, in true millimetres (page frame).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckPlan {
    pub frame: PageFrame,
    pub square: RectMm,
    pub long_box: RectMm,
}

/// Plans the check page, upright, so that its x is the printer's. The media's correction is applied to it as to any sheet.
pub fn plan(media: &Media) -> Result<CheckPlan, SheetError> {
    let page = match media.paper {
        Stock::Cut(paper) => paper.portrait(),
        Stock::Roll { width_mm } => Paper::new(width_mm, ROLL_LENGTH_MM),
    };
    let frame = PageFrame::new(page, media.setup(false))?;
    let area = frame.usable;
    let needed = (
        SQUARE_MM + GAP_MM + BLANKS_MM,
        SQUARE_MM + BOX_MM.1 + 2.0 * GAP_MM + HEAD_MM,
    );
    if area.width_mm() < needed.0 || area.height_mm() < needed.1 {
        let more = (
            page.width_mm + (needed.0 - area.width_mm()).max(0.0),
            page.height_mm + (needed.1 - area.height_mm()).max(0.0),
        );
        return Err(SheetError::PaperTooSmall {
            paper_mm: size((page.width_mm, page.height_mm)),
            margin_mm: media.margin_mm,
            needed_mm: size((more.0.ceil(), more.1.ceil())),
        });
    }
    let square = RectMm::sized([area.left_mm, area.bottom_mm], (SQUARE_MM, SQUARE_MM));
    let long_box = RectMm::sized([area.left_mm, square.top_mm + GAP_MM], BOX_MM);
    Ok(CheckPlan {
        frame,
        square,
        long_box,
    })
}

pub fn check(media: &Media) -> Result<Vec<Sheet>, SheetError> {
    let plan = plan(media)?;
    let mut marks = rulers(&plan.frame);
    marks.extend(outline(plan.square));
    marks.extend(diagonals(plan.square));
    marks.extend(outline(plan.long_box));
    let label = [plan.long_box.left_mm + 3.0, plan.long_box.top_mm - LEADING_MM];
    marks.push(Mark::text(label, TEXT_MM, TextAnchor::Left, "10 × 5 cm"));
    marks.extend(head(&plan));
    marks.extend(blanks(&plan));
    marks.extend(caption(&plan, media));
    let sheet = plan.frame.sheet(plan.frame.whole(), plan.frame.whole(), marks);
    Ok(vec![printer::corrected_one(sheet, plan.frame.setup.stretch())])
}

/// Draws a rectangle whose lines are centred on its edges, with closed corners.
fn outline(r: RectMm) -> Vec<Mark> {
    let more = 0.5 * LINE_MM;
    let across = |y: f64| Mark::line([r.left_mm - more, y], [r.right_mm + more, y], LINE_MM);
    let down = |x: f64| Mark::line([x, r.bottom_mm - more], [x, r.top_mm + more], LINE_MM);
    vec![across(r.bottom_mm), across(r.top_mm), down(r.left_mm), down(r.right_mm)]
}

fn diagonals(r: RectMm) -> Vec<Mark> {
    vec![
        Mark::line([r.left_mm, r.bottom_mm], [r.right_mm, r.top_mm], LINE_MM),
        Mark::line([r.left_mm, r.top_mm], [r.right_mm, r.bottom_mm], LINE_MM),
    ]
}

fn head(plan: &CheckPlan) -> Vec<Mark> {
    let area = plan.frame.usable;
    let title_y = area.top_mm - CAP_HEIGHT * TITLE_MM;
    let line = |y: f64, size_mm: f64, text: String| Mark::text([area.left_mm, y], size_mm, TextAnchor::Left, text);
    let mut marks = vec![line(title_y, TITLE_MM, "Printer check".to_owned())];
    let steps = [
        "1. Print at 100 %, without fit to page, on the paper of the later sheets. Let the ink dry.",
        "2. Measure with a steel ruler to 0.1 mm, from the middle of a line to the middle of a line.",
        "3. x is the lower ruler, y the left one. The square and the box must agree with them.",
        "4. The diagonals must be equally long; if not, the paper runs askew, which no correction takes back.",
        &format!(
            "5. {}; then print with --printer printer.toml.",
            plan.frame.setup.printer.verify_command()
        ),
    ];
    let mut y = title_y - 1.6 * LEADING_MM;
    for text in steps.iter().flat_map(|step| wrapped(step, TEXT_MM, area.width_mm())) {
        marks.push(line(y, TEXT_MM, text));
        y -= LEADING_MM;
    }
    marks
}

/// Draws the blanks for the measured values.
fn blanks(plan: &CheckPlan) -> Vec<Mark> {
    let left = plan.square.right_mm + GAP_MM;
    let diagonal = SQUARE_MM * std::f64::consts::SQRT_2;
    let rows = [
        (plan.long_box, vec![("box x", BOX_MM.0), ("box y", BOX_MM.1)]),
        (
            plan.square,
            vec![
                ("x", SQUARE_MM),
                ("y", SQUARE_MM),
                ("diagonal /", diagonal),
                ("diagonal \\", diagonal),
            ],
        ),
    ];
    let mut marks = Vec::new();
    for (beside, blanks) in rows {
        let mut y = beside.top_mm - LEADING_MM;
        for (what, nominal_mm) in blanks {
            let nominal = number((nominal_mm * 10.0).round() / 10.0);
            let line = format!("{what} (of {nominal} mm)");
            marks.push(Mark::text([left, y], TEXT_MM, TextAnchor::Left, line));
            let blank_y = y - 2.2 * LEADING_MM;
            marks.push(Mark::line([left, blank_y], [left + 30.0, blank_y], LINE_MM));
            marks.push(Mark::text([left + 31.0, blank_y], TEXT_MM, TextAnchor::Left, "mm"));
            y = blank_y - 2.0 * LEADING_MM;
        }
    }
    marks
}

fn caption(plan: &CheckPlan, media: &Media) -> Vec<Mark> {
    let area = plan.frame.printable;
    let blanks = "Printer and paper: ______________________________   measured by, on: ______________________________";
    let lines = [blanks, &making(media)];
    Mark::lines(lines, area.left_mm, (TEXT_MM, area.width_mm()), |i| {
        area.bottom_mm + 1.0 + (1 - i) as f64 * 1.5 * LEADING_MM
    })
}
