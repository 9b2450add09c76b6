//! The panels on their sheets: pattern, outline, edges, seam letters.

use super::region::{Contour, Region};
use super::seams::{CLEAR_MM, SeamMark, seams};
use super::{
    BLEED_MM, PaintedSurface, Panel, Point, SpreadPanel, Unrolling, Wrap, WrapError, WrapRequest, cover, strips,
};
use crate::pattern::Pattern;
use crate::pattern::world_aligned::Side;
use crate::print::SheetError;
use crate::print::lettering::CAP_HEIGHT;
use crate::print::printer;
use crate::print::sheet::{BLACK, Mark, PointMm, Sheet, Srgb8, TextAnchor};
use crate::print::template::{PatternStamp, SheetPlan, cell_mm, furniture, layout};

/// Between a panel's edge and the line it is cut along, so that none of the line stays on the piece.
const CUT_GAP_MM: f64 = 0.1;
const CUT_LINE_MM: f64 = 0.15;
/// Free paper that the line takes around a region, and a little more.
pub(crate) const CUT_ROOM_MM: f64 = 1.0;
/// Edges within a panel are marked lightly: they lie on the pattern.
pub(crate) const EDGE_LINE_MM: f64 = 0.06;
pub(crate) const EDGE_DASH_MM: (f64, f64) = (1.0, 6.0);
const LETTER_MM: f64 = 4.0;
const LEADER_MM: f64 = 0.15;
/// Around a panel on its sheets, for bleed and letters.
const ROOM_MM: f64 = BLEED_MM + 2.0 * CLEAR_MM;

/// `unrolling` is what became of `paint`, and `panels` those of its rest.
pub(crate) fn wrap(
    paint: &PaintedSurface,
    unrolling: Unrolling,
    panels: Vec<Panel>,
    pattern: &Pattern,
    request: &WrapRequest,
) -> Result<Wrap, WrapError> {
    let grown: Vec<Region> = panels.iter().map(|panel| panel.region.grown(BLEED_MM)).collect();
    let mut seams = seams(&unrolling.rest, &panels, &grown);
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
        strips: unrolling.strips,
        strip_places: Vec::new(),
        kept: unrolling.kept,
        pages: Vec::new(),
    };
    let before = 1 + made.pieces.iter().map(|piece| piece.layout.sheets.len()).sum::<usize>();
    let (places, strip_sheets) = strips::sheets(&made, before, pattern, request)?;
    made.strip_places = places;
    let mut pages = vec![cover::cover(&made, &seams, pattern, request)?];
    for (piece, grown) in made.pieces.iter().zip(&grown) {
        let side = piece.panel.side;
        strips::numbers(&made.strips, side, grown, seams.marks.entry(side).or_default());
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
    pages.extend(strip_sheets);
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

/// What a cutter follows on a sheet: the part of the region's border that the sheet shows.
pub(crate) fn cutter_path(region: &Region, by: Point, plan: &SheetPlan) -> Mark {
    let sheet = plan.printed.outline();
    let sheet = Region::union(vec![sheet.iter().map(|p| [p.x_mm - by[0], p.y_mm - by[1]]).collect()]);
    Mark::Cut {
        outlines: moved(region.and(&sheet).contours(), by),
        is_piece: true,
    }
}

/// The line around a region, outside of it.
pub(crate) fn cut_line(region: &Region, by: Point) -> Vec<Mark> {
    let around = region.grown(CUT_GAP_MM + 0.5 * CUT_LINE_MM);
    let mut marks = Vec::new();
    for outline in moved(around.contours(), by) {
        let next = outline.iter().cycle().skip(1);
        let lines = outline.iter().zip(next);
        marks.extend(lines.map(|(a, b)| line(*a, *b, CUT_LINE_MM, None, BLACK)));
    }
    marks
}

pub(super) fn line(from: PointMm, to: PointMm, width_mm: f64, dash_mm: Option<(f64, f64)>, colour: Srgb8) -> Mark {
    Mark::Line {
        from,
        to,
        width_mm,
        dash_mm,
        colour,
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

pub(super) fn place(p: Point, by: Point) -> PointMm {
    PointMm::new(p[0] + by[0], p[1] + by[1])
}

/// Outlines of a plane, moved onto a page.
pub(crate) fn moved<'a>(outlines: impl Iterator<Item = &'a Contour>, by: Point) -> Vec<Vec<PointMm>> {
    outlines
        .map(|outline| outline.iter().map(|p| place(*p, by)).collect())
        .collect()
}
