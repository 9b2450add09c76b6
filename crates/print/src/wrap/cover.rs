//! First page: assembly of the panels on the model, the statistics of each, and all of them small with their seam letters.

use super::seams::PanelSeams;
use super::{Contour, Panel, Wrap};
use crate::frame::PageFrame;
use crate::printer;
use crate::sheet::{BLACK, Mark, RectMm, Sheet, Srgb8};
use crate::template::{Captions, cover};
use scaleproof_core::geometry::Point2;
use scaleproof_surface::pattern::world_aligned::Side;

const LINE_MM: f64 = 0.15;
const LETTER_MM: f64 = 2.6;
const GREY: Srgb8 = [215, 215, 215];
/// Maximum scale of the panels.
const MOST_SCALE: f64 = 0.5;

const STEPS: [&str; 4] = [
    "Print at 100 %, without fit to page. Measure both rulers below before you cut anything.",
    "Glue the sheets of a panel that takes several: lay them out by their ids, cut at the crop marks of the left and upper edge, \
     and glue each with its cut edge on the dashed line of its neighbour. Capital letters show which edges meet.",
    "Cut out each panel along the inner side of its line; the pattern runs on beyond it. Dashes within a panel are edges of the \
     model.",
    "Put the panels on the model by their outlines and dashes, with the arrows up and to the front. Small letters are the seams \
     between panels: edges with the same letter meet.",
];

pub fn cover(wrap: &Wrap, seams: &PanelSeams, frame: PageFrame, captions: &Captions) -> Sheet {
    let texts = (&STEPS[..], &*wrap.facts());
    let sheet = cover::first_page(&frame, captions, "Panels of a model", texts, |room| {
        overview(wrap, seams, room)
    });
    printer::corrected_one(sheet, frame.setup.stretch())
}

/// Draws all panels in one scale: the sides above each other, front and rear below, the roof to the right.
fn overview(wrap: &Wrap, seams: &PanelSeams, room: RectMm) -> Vec<Mark> {
    let size = |side: Side| {
        let bounds = panel(wrap, side).and_then(|panel| panel.region.bounds());
        bounds.map_or([0.0; 2], |(low, high)| [high[0] - low[0], high[1] - low[1]])
    };
    let [left, right, roof, front, rear] = super::PRINTED.map(size);
    let wide = left[0].max(right[0]).max(front[0] + rear[0]);
    let high = (left[1] + right[1] + front[1].max(rear[1])).max(roof[1]);
    // Gaps for letters and names, in mm of the page.
    let gap = 3.0 * LETTER_MM;
    let scale = ((room.width_mm() - 3.0 * gap) / (wide + roof[0])).min((room.height_mm() - 4.0 * gap) / high);
    let scale = scale.min(MOST_SCALE);
    if scale <= 0.0 {
        return Vec::new();
    }
    let (x0, y0) = (room.left_mm + 0.5 * gap, room.top_mm - gap);
    let below = |above: f64, count: f64| y0 - scale * above - count * gap;
    let third = below(left[1] + right[1], 2.0);
    let corners = [
        [x0, y0],
        [x0, below(left[1], 1.0)],
        [x0 + scale * wide + gap, y0],
        [x0, third],
        [x0 + scale * front[0] + gap, third],
    ];
    let mut marks = Vec::new();
    for (side, corner) in super::PRINTED.into_iter().zip(corners) {
        if let Some(piece) = panel(wrap, side) {
            let (low, high) = piece.region.bounds().unwrap_or_default();
            let by = [corner[0] - scale * low[0], corner[1] - scale * high[1]];
            let letters = seams.marks.get(&side).into_iter().flatten();
            let places = letters.map(|mark| (mark.letter.as_str(), mark.seam, mark.at));
            marks.extend(small(piece, by, scale, places));
        }
    }
    marks
}

fn panel(wrap: &Wrap, side: Side) -> Option<&Panel> {
    let mut panels = wrap.pieces.iter().map(|piece| &piece.panel);
    panels.find(|panel| panel.side == side)
}

fn small<'a>(
    panel: &Panel,
    by: Point2,
    scale: f64,
    letters: impl Iterator<Item = (&'a str, Point2, Point2)>,
) -> Vec<Mark> {
    let (low, high) = panel.region.bounds().unwrap_or_default();
    let to_page = |p: Point2| [0, 1].map(|axis| scale * p[axis] + by[axis]);
    let outline = |outline: &Contour| outline.iter().map(|p| to_page(*p)).collect();
    let outlines: Vec<Vec<Point2>> = panel.region.contours().map(outline).collect();
    let area = Mark::Area {
        outlines: outlines.clone(),
        colour: GREY,
    };
    let mut marks = vec![area];
    marks.extend(outlines.iter().flat_map(|o| Mark::outline(o, LINE_MM, BLACK)));
    let edges = panel.edges.iter();
    marks.extend(edges.map(|[a, b]| Mark::line(to_page(*a), to_page(*b), 0.5 * LINE_MM)));
    for (letter, seam, at) in letters {
        let [x, y] = to_page(seam);
        let (dx, dy) = (at[0] - seam[0], at[1] - seam[1]);
        let away = 0.8 * LETTER_MM / dx.hypot(dy).max(f64::MIN_POSITIVE);
        let middle = [x + away * dx, y + away * dy];
        marks.push(Mark::centred(middle, (LETTER_MM, f64::INFINITY), letter));
    }
    let size = (4.0, 0.8 * scale * (high[0] - low[0]));
    marks.push(Mark::centred(
        to_page(panel.region.innermost()),
        size,
        panel.side.name(),
    ));
    marks
}
