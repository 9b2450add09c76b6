//! The panels on their sheets: pattern, outline, edges, seam letters.

use super::lines::{EDGE_DASH_MM, EDGE_LINE_MM, cut_line, cutter_path, line, moved, place};
use super::region::Region;
use super::seams::{CLEAR_MM, SeamMark, seams};
use super::{BLEED_MM, PaintedSurface, Panel, Point, SpreadPanel, Wrap, WrapError, WrapRequest, cover};
use crate::pattern::Pattern;
use crate::pattern::world_aligned::Side;
use crate::print::lettering::CAP_HEIGHT;
use crate::print::sheet::{BLACK, Mark, PointMm, Sheet, TextAnchor};
use crate::print::template::{PatternStamp, SheetPlan, cell_mm, furniture, layout};
use crate::print::{SheetError, printer};

const LETTER_MM: f64 = 4.0;
const LEADER_MM: f64 = 0.15;
/// Around a panel on its sheets, for bleed and letters.
const ROOM_MM: f64 = BLEED_MM + 2.0 * CLEAR_MM;

/// `panels` are those of `paint`.
pub(crate) fn wrap(
    paint: &PaintedSurface,
    panels: Vec<Panel>,
    pattern: &Pattern,
    request: &WrapRequest,
) -> Result<Wrap, WrapError> {
    let grown: Vec<Region> = panels.iter().map(|panel| panel.region.grown(BLEED_MM)).collect();
    let seams = seams(paint, &panels, &grown);
    let pieces: Result<Vec<_>, _> = panels.into_iter().map(|panel| piece(panel, request)).collect();
    let pieces = pieces?;
    let largest = pieces.iter().fold((0.0f64, 0.0f64), |most, piece| {
        let size = piece.layout.size_mm();
        (most.0.max(size.0), most.1.max(size.1))
    });
    let cell_mm = cell_mm(pattern, &request.template(Side::Front, largest))?;
    let stamp = PatternStamp::new(pattern, cell_mm, largest);
    stamp.check_placements(pieces.iter().flat_map(|piece| &piece.layout.sheets))?;
    let mut made = Wrap {
        pieces,
        surface_mm2: paint.surface_mm2(),
        unlettered_mm: seams.unlettered_mm,
        cell_mm,
        pages: Vec::new(),
    };
    let mut pages = vec![cover::cover(&made, &seams, pattern, request)?];
    for (piece, grown) in made.pieces.iter().zip(&grown) {
        let side = piece.panel.side;
        let drawing = Drawing {
            piece,
            grown,
            letters: seams.marks.get(&side).map_or(&[], Vec::as_slice),
            stamp: &stamp,
            captions: furniture::Captions::new(pattern, &request.template(side, piece.layout.size_mm()), cell_mm)
                .of_panel(side.name()),
        };
        let sheets = piece.layout.sheets.iter().map(|plan| drawing.sheet(plan)).collect();
        pages.extend(printer::corrected(sheets, piece.layout.frame.setup.stretch()));
    }
    made.pages = pages;
    Ok(made)
}

/// Spreads a panel over sheets.
pub(crate) fn piece(panel: Panel, request: &WrapRequest) -> Result<SpreadPanel, SheetError> {
    let (low, high) = panel.region.bounds().unwrap_or_default();
    let size = [0, 1].map(|axis| high[axis] - low[axis] + 2.0 * ROOM_MM);
    Ok(SpreadPanel {
        layout: layout(&request.template(panel.side, (size[0], size[1])).layout)?,
        corner: [low[0] - ROOM_MM, high[1] + ROOM_MM],
        panel,
    })
}

struct Drawing<'a> {
    piece: &'a SpreadPanel,
    grown: &'a Region,
    letters: &'a [SeamMark],
    stamp: &'a PatternStamp,
    captions: furniture::Captions,
}

impl Drawing<'_> {
    fn sheet(&self, plan: &SheetPlan) -> Sheet {
        let layout = &self.piece.layout;
        let by = self.piece.moved_by_mm(plan);
        let [left, top] = self.piece.corner;
        let mut marks = vec![Mark::Clipped {
            to: moved(self.grown.contours(), by),
            marks: vec![self.stamp.on(plan, (-left, top))],
        }];
        marks.push(Mark::Clipped {
            to: vec![plan.printed.outline()],
            marks: self.lines(by),
        });
        marks.push(cutter_path(&self.piece.panel.region, by, plan));
        marks.extend(self.letters.iter().flat_map(|mark| letter(mark, by, plan)));
        marks.extend(furniture::all(layout, plan, &self.captions));
        layout.frame.sheet(plan.trim, plan.printed, marks)
    }

    fn lines(&self, by: Point) -> Vec<Mark> {
        let mut marks = cut_line(&self.piece.panel.region, by);
        for [a, b] in &self.piece.panel.edges {
            marks.push(line(
                place(*a, by),
                place(*b, by),
                EDGE_LINE_MM,
                Some(EDGE_DASH_MM),
                BLACK,
            ));
        }
        marks
    }
}

/// A seam's letter and the line from it to the seam, on the sheet that shows the letter once all are glued.
fn letter(mark: &SeamMark, by: Point, plan: &SheetPlan) -> Vec<Mark> {
    let at = place(mark.at, by);
    let trim = plan.trim;
    let within = |low: f64, high: f64, at: f64| at >= low && at < high;
    if !within(trim.left_mm, trim.right_mm, at.x_mm) || !within(trim.bottom_mm, trim.top_mm, at.y_mm) {
        return Vec::new();
    }
    let seam = place(mark.seam, by);
    let (dx, dy) = (at.x_mm - seam.x_mm, at.y_mm - seam.y_mm);
    let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
    let along = |mm: f64| PointMm::new(seam.x_mm + mm / length * dx, seam.y_mm + mm / length * dy);
    let leader = line(along(BLEED_MM + 0.2), along(length - 2.0), LEADER_MM, None, BLACK);
    let text = Mark::text(
        (at.x_mm, at.y_mm - 0.5 * CAP_HEIGHT * LETTER_MM),
        LETTER_MM,
        TextAnchor::Centre,
        mark.letter.clone(),
    );
    if length - 2.0 > BLEED_MM + 0.5 {
        vec![leader, text]
    } else {
        vec![text]
    }
}
