//! Unrolled strips on paper: several to a page, each with its number, what it borders, and its area.

use std::ops::RangeInclusive;

use super::lines::{CUT_ROOM_MM, EDGE_DASH_MM, EDGE_LINE_MM, cut_line, line, moved, place};
use super::region::{Point, Region};
use super::seams::{CLEAR_MM, SeamMark};
use super::unroll::{Kept, LEAST_MM2, Strip, Unrolled, Unrolling, unroll};
use super::{BLEED_MM, PaintedSurface, Wrap, WrapError, WrapRequest};
use crate::pattern::Pattern;
use crate::pattern::world_aligned::{Side, WorldAligned};
use crate::print::frame::{PageFrame, PageSetup};
use crate::print::lettering::wrapped;
use crate::print::paper::{Paper, Stock};
use crate::print::sheet::{BLACK, Mark, PointMm, Sheet, TextAnchor};
use crate::print::template::furniture;
use crate::print::{SheetError, pack, printer};
use crate::spelling::count;

/// Around a strip on its page.
const ROOM_MM: f64 = BLEED_MM + CUT_ROOM_MM;
/// The label under a strip.
const LABEL_MM: f64 = 2.2;
const LEADING_MM: f64 = 2.9;
/// As wide as the label of the smallest strip.
const LEAST_WIDTH_MM: f64 = 30.0;
/// The longest label takes no more, and so many are kept free under every strip.
const LABEL_LINES: usize = 10;
/// Of more neighbours than this only the count is named.
const MOST_NAMED: usize = 6;
/// How far a cell runs on under its neighbours.
const RUN_ON_MM: f64 = 0.1;
const PAGE_LABEL_MM: f64 = 4.0;
/// Cells of all strips; more would take gigabytes.
const MOST_CELLS: usize = 2_000_000;
/// No surface is stretched by more than 1.8: it belongs to the side that it looks to most.
const MOST_STRETCH: f64 = 1000.0;

/// Where a strip is printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StripPlace {
    /// Index of the page.
    pub page: usize,
    /// The page place of (0, 0) of the strip's plane.
    pub moved_by_mm: Point,
}

/// What the request wants unrolled.
///
/// # Errors
/// A limit that is no stretch, paper too small for the rulers, too many steep triangles.
pub(crate) fn unrolling(paint: &PaintedSurface, request: &WrapRequest) -> Result<Unrolling, WrapError> {
    let Some(limit) = request.max_stretch else {
        return Ok(Unrolling {
            strips: Vec::new(),
            rest: paint.clone(),
            kept: Kept::default(),
        });
    };
    // False for NaN too.
    if !(1.0..=MOST_STRETCH).contains(&limit) {
        return Err(WrapError::MaxStretch { limit });
    }
    let area = frame(request)?.usable;
    let most = [
        area.width_mm() - 2.0 * ROOM_MM,
        area.height_mm() - 2.0 * ROOM_MM - LABEL_LINES as f64 * LEADING_MM,
    ];
    unroll(paint, limit, most)
}

/// The pages of strips lie across: strips of a car are long rather than high. A piece of a roll is square.
fn frame(request: &WrapRequest) -> Result<PageFrame, SheetError> {
    let frame = |page: Paper, turned: bool| {
        let setup = PageSetup {
            margin_mm: request.margin_mm,
            printer: request.printer,
            turned,
        };
        PageFrame::new(page, setup)
    };
    match request.paper {
        Stock::Cut(paper) => frame(paper.landscape(), true).or_else(|_| frame(paper.portrait(), false)),
        Stock::Roll { width_mm } => frame(
            Paper {
                width_mm,
                height_mm: width_mm,
            },
            false,
        ),
    }
}

/// Numbers where strips left a panel, as far as the paper there is free.
pub(crate) fn numbers(strips: &[Strip], side: Side, grown: &Region, marks: &mut Vec<SeamMark>) {
    for (i, strip) in strips.iter().enumerate().filter(|(_, strip)| strip.side == side) {
        let at = Region::union(strip.projected()).innermost();
        let apart = |mark: &SeamMark| (mark.at[0] - at[0]).hypot(mark.at[1] - at[1]) > 2.0 * CLEAR_MM;
        if grown.distance_mm(at) >= CLEAR_MM && marks.iter().all(apart) {
            marks.push(SeamMark {
                letter: (i + 1).to_string(),
                seam: at,
                at,
            });
        }
    }
}

/// One sentence on all strips.
pub(crate) fn fact(wrap: &Wrap) -> Option<String> {
    let areas: Vec<f64> = wrap.strips.iter().map(Strip::surface_mm2).collect();
    let Kept {
        too_large,
        small,
        small_mm2,
    } = wrap.kept;
    let large = (too_large > 0).then(|| format!("{} larger than a sheet", count(too_large, "triangle")));
    let small = (small > 0).then(|| {
        format!(
            "{} smaller than {:.2} cm² ({:.1} cm² in all)",
            count(small, "part"),
            LEAST_MM2 / 100.0,
            small_mm2 / 100.0
        )
    });
    let stay: Vec<String> = large.into_iter().chain(small).collect();
    let stay = match stay.is_empty() {
        true => String::new(),
        false => format!("; as steep but left on the panels: {}", stay.join(", ")),
    };
    if areas.is_empty() {
        return (!stay.is_empty()).then(|| format!("unrolled: nothing{stay}"));
    }
    let (least, most) = areas.iter().fold((f64::INFINITY, 0.0f64), |(least, most), area| {
        (least.min(*area), most.max(*area))
    });
    Some(format!(
        "unrolled: {}, {:.1} cm² of surface, from {:.2} to {:.1} cm² each, {}{stay}",
        count(areas.len(), "strip"),
        wrap.strips_mm2() / 100.0,
        least / 100.0,
        most / 100.0,
        count(wrap.strip_pages(), "page"),
    ))
}

/// The pages of all strips; the first has the index `before`.
///
/// # Errors
/// Paper too small for the rulers, more than [`MOST_CELLS`].
pub(crate) fn sheets(
    wrap: &Wrap,
    before: usize,
    pattern: &Pattern,
    request: &WrapRequest,
) -> Result<(Vec<StripPlace>, Vec<Sheet>), WrapError> {
    if wrap.strips.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let frame = frame(request)?;
    let texture = WorldAligned {
        pattern,
        cell_mm: wrap.cell_mm,
    };
    check_cells(&wrap.strips, wrap.cell_mm)?;
    let boxes: Vec<Boxed> = wrap.strips.iter().enumerate().map(|(i, s)| Boxed::new(i, s)).collect();
    let sizes: Vec<_> = boxes.iter().map(|b| b.size_mm).collect();
    let spots = pack::pack(&sizes, frame.usable).map_err(|i| WrapError::StripTooLarge { strip: i + 1 })?;
    let mut places = Vec::new();
    let mut pages: Vec<Vec<Mark>> = Vec::new();
    for ((strip, boxed), spot) in wrap.strips.iter().zip(&boxes).zip(spots) {
        let by = boxed.moved_by_mm(spot.at);
        places.push(StripPlace {
            page: before + spot.page,
            moved_by_mm: by,
        });
        pages.resize_with(pages.len().max(spot.page + 1), Vec::new);
        pages[spot.page].extend(drawn(strip, &texture, by));
        pages[spot.page].extend(boxed.label(spot.at));
    }
    let template = request.template(Side::Front, (frame.usable.width_mm(), frame.usable.height_mm()));
    let captions = furniture::Captions::new(pattern, &template, wrap.cell_mm);
    let count = pages.len();
    let sheet = |(i, mut marks): (usize, Vec<Mark>)| {
        marks.extend(furniture::rulers(&frame));
        marks.extend(captions.marks(frame.printable));
        let at = (frame.printable.right_mm, frame.printable.bottom_mm + 0.8);
        marks.push(Mark::text(
            at,
            PAGE_LABEL_MM,
            TextAnchor::Right,
            format!("strips {}/{count}", i + 1),
        ));
        frame.sheet(frame.printable, frame.printable, marks)
    };
    let sheets = pages.into_iter().enumerate().map(sheet).collect();
    Ok((places, printer::corrected(sheets, frame.setup.stretch())))
}

/// A strip with its label below it.
struct Boxed {
    low: Point,
    size_mm: (f64, f64),
    lines: Vec<String>,
}

impl Boxed {
    fn new(index: usize, strip: &Strip) -> Self {
        let corners = || strip.faces.iter().flat_map(|f| f.corners);
        let low = [0, 1].map(|i| corners().fold(f64::INFINITY, |low, p| low.min(p[i])) - ROOM_MM);
        let high = [0, 1].map(|i| corners().fold(f64::NEG_INFINITY, |high, p| high.max(p[i])) + ROOM_MM);
        let width = (high[0] - low[0]).max(LEAST_WIDTH_MM);
        let text = format!(
            "{}: {:.2} cm² of the {} side{}, beside {}",
            index + 1,
            strip.surface_mm2() / 100.0,
            strip.side.name(),
            if strip.turned {
                ", its upper end at the right"
            } else {
                ""
            },
            neighbours(strip)
        );
        let mut lines = wrapped(&text, LABEL_MM, width);
        lines.truncate(LABEL_LINES);
        Self {
            low,
            size_mm: (width, high[1] - low[1] + lines.len() as f64 * LEADING_MM),
            lines,
        }
    }

    /// For a box with its lower left corner at `at`.
    fn moved_by_mm(&self, at: PointMm) -> Point {
        let label_mm = self.lines.len() as f64 * LEADING_MM;
        [at.x_mm - self.low[0], at.y_mm + label_mm - self.low[1]]
    }

    fn label(&self, at: PointMm) -> impl Iterator<Item = Mark> {
        let from_below = self.lines.iter().rev().enumerate();
        from_below.map(move |(i, line)| {
            let baseline = at.y_mm + 0.7 + i as f64 * LEADING_MM;
            Mark::text((at.x_mm, baseline), LABEL_MM, TextAnchor::Left, line.clone())
        })
    }
}

fn neighbours(strip: &Strip) -> String {
    let panels = strip.panels.iter().map(|side| match side {
        Side::Bottom => "the bottom".to_owned(),
        side => format!("the {} panel", side.name()),
    });
    let strips = strip.strips.iter().map(|i| format!("strip {}", i + 1));
    let mut all: Vec<String> = panels.chain(strips).collect();
    if all.len() > MOST_NAMED {
        let more = all.split_off(MOST_NAMED).len();
        all.push(format!("{more} more"));
    }
    if all.is_empty() {
        return "no other paint".to_owned();
    }
    all.join(", ")
}

fn drawn(strip: &Strip, texture: &WorldAligned, by: Point) -> Vec<Mark> {
    let region = strip.region();
    // First every triangle with what runs on beyond it, then each where it belongs.
    let with_bleed = strip.faces.iter().map(|f| {
        let grown = Region::union(vec![f.corners.to_vec()]).grown(BLEED_MM);
        Mark::Clipped {
            to: moved(grown.contours(), by),
            marks: cells(f, texture, BLEED_MM, by),
        }
    });
    let exact = strip.faces.iter().map(|f| Mark::Clipped {
        to: moved([f.corners.to_vec()].iter(), by),
        marks: cells(f, texture, 0.0, by),
    });
    let mut marks: Vec<Mark> = with_bleed.chain(exact).collect();
    for [a, b] in &strip.folds {
        marks.push(line(
            place(*a, by),
            place(*b, by),
            EDGE_LINE_MM,
            Some(EDGE_DASH_MM),
            BLACK,
        ));
    }
    marks.extend(cut_line(&region, by));
    marks.push(Mark::Cut {
        outlines: moved(region.contours(), by),
        is_piece: true,
    });
    marks
}

/// Every triangle is drawn twice, with its bleed and without.
fn check_cells(strips: &[Strip], cell_mm: f64) -> Result<(), WrapError> {
    let faces = strips.iter().flat_map(|strip| &strip.faces);
    let of = |face: &Unrolled| -> usize {
        let spans = [BLEED_MM, 0.0].map(|around_mm| spans(face, cell_mm, around_mm));
        spans
            .into_iter()
            .map(|[columns, rows]| columns.count() * rows.count())
            .sum()
    };
    let count: usize = faces.map(of).sum();
    if count > MOST_CELLS {
        let most = MOST_CELLS;
        return Err(WrapError::TooManyStripCells { count, most });
    }
    Ok(())
}

/// The columns, and the rows, of the cells of a triangle and of what lies within `around_mm` of it.
fn spans(unrolled: &Unrolled, cell_mm: f64, around_mm: f64) -> [RangeInclusive<i64>; 2] {
    let flat = unrolled.face.corners.map(|p| unrolled.face.side.project(&p));
    // The projection shortens lengths, so that `around_mm` on the strip is no more than that in the side's plane.
    [0, 1].map(|axis| {
        let low = flat.iter().fold(f64::INFINITY, |low, p| low.min(p[axis])) - around_mm;
        let high = flat.iter().fold(f64::NEG_INFINITY, |high, p| high.max(p[axis])) + around_mm;
        (low / cell_mm).floor() as i64..=(high / cell_mm).floor() as i64
    })
}

/// The cells of a triangle and of what lies within `around_mm` of it, each as it lies on the strip.
fn cells(unrolled: &Unrolled, texture: &WorldAligned, around_mm: f64, by: Point) -> Vec<Mark> {
    let cell = texture.cell_mm;
    let [columns, rows] = spans(unrolled, cell, around_mm);
    // Each runs on under its right and its lower neighbour, which cover it. Not far: where a triangle's clip cuts through
    // covered colours, a viewer mixes them into the pixel of the cut.
    let more = RUN_ON_MM.min(cell);
    let mut marks = Vec::new();
    for row in rows.rev() {
        for column in columns.clone() {
            let (left, bottom) = (column as f64 * cell, row as f64 * cell);
            let (right, top, below) = (left + cell + more, bottom + cell, bottom - more);
            let corners = [[left, below], [right, below], [right, top], [left, top]];
            marks.push(Mark::Area {
                outlines: vec![corners.iter().map(|p| place(unrolled.place(*p), by)).collect()],
                colour: texture.colour_at([left + 0.5 * cell, bottom + 0.5 * cell]),
            });
        }
    }
    marks
}
