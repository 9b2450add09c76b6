//! Glue tabs: strips of paper on one side of each seam that go under the other piece.

use super::flat::Piece;
use super::seams::{Seam, SeamEdge, border};
use scaleproof_core::geometry::{Point2, distance, offset};
use scaleproof_print::wrap::{Contour, Region};

/// Minimum area of a tab relative to its length times its width; with less it does not hold.
const LEAST_SHARE: f64 = 0.4;
/// Length below which seams hold without a tab.
const SHORTEST_MM: f64 = 6.0;
/// Angle above which a turn of the border interrupts the fold line.
const BEND_DEG: f64 = 20.0;
/// Gap for the knife between a tab and its surroundings.
const GAP_MM: f64 = 0.6;

#[derive(Debug, Clone, Default)]
pub struct Tabs {
    pub region: Region,
    /// Fold lines, along the border.
    pub folds: Vec<[Point2; 2]>,
}

/// For each seam the side with a tab, and the distance of its letter from the border there.
pub type TabSides = Vec<Option<(usize, f64)>>;

/// Returns the tabs of all pieces: of this width on one side of each seam, the one with more room.
pub fn tabs(pieces: &[Piece], seams: &[Seam], width_mm: Option<f64>) -> (Vec<Tabs>, TabSides) {
    let mut tabs = vec![Tabs::default(); pieces.len()];
    let mut sides = vec![None; seams.len()];
    let Some(width_mm) = width_mm else { return (tabs, sides) };
    let near: Vec<Region> = pieces.iter().map(|piece| piece.region.grown(GAP_MM)).collect();
    for (seam, chosen) in seams.iter().zip(&mut sides) {
        if seam.length_mm < SHORTEST_MM {
            continue;
        }
        let room = |side: usize| {
            let piece = seam.pieces()[side];
            let strip = strip(seam, pieces, side, width_mm);
            // Parts along the border itself stay; parts near another part of the piece are removed.
            let own = Region::union(beside(&lines(seam, pieces, side), 2.0 * GAP_MM));
            let off = strip.without(&near[piece].without(&own)).without(&pieces[piece].region);
            off.without(&tabs[piece].region.grown(GAP_MM))
        };
        let both = [room(0), room(1)];
        let side = usize::from(both[1].area_mm2() > both[0].area_mm2());
        if both[side].area_mm2() < LEAST_SHARE * seam.length_mm * width_mm {
            continue;
        }
        *chosen = Some((side, 0.55 * width_mm));
        let tabs = &mut tabs[seam.pieces()[side]];
        tabs.region = tabs.region.or(&both[side]);
        let folds = seam.edges.iter().map(|edge| border(pieces, edge.sides[side]).flat);
        tabs.folds.extend(folds);
    }
    (tabs, sides)
}

/// Returns the strip beside a seam: straight parts with slanted ends, so that each folds separately.
fn strip(seam: &Seam, pieces: &[Piece], side: usize, width_mm: f64) -> Region {
    let lines = lines(seam, pieces, side);
    let parts = straight_parts(&lines);
    let strips = parts.map(|part| {
        let slant = width_mm.min(0.3 * part.iter().map(Line::length_mm).sum::<f64>());
        let ends = [(part.first(), 1.0), (part.last(), -1.0)];
        let ends = ends
            .into_iter()
            .filter_map(|(line, sign)| Some(line?.wedge(sign, slant, width_mm)));
        Region::union(beside(part, width_mm)).without(&Region::union(ends.collect()))
    });
    strips.fold(Region::default(), |all, strip| all.or(&strip))
}

/// Edge of a border, in the order of its seam.
#[derive(Debug, Clone, Copy)]
struct Line {
    from: Point2,
    to: Point2,
    outward: Point2,
}

impl Line {
    fn length_mm(&self) -> f64 {
        distance(self.from, self.to)
    }

    fn along(&self) -> Point2 {
        let length = self.length_mm().max(f64::MIN_POSITIVE);
        [0, 1].map(|axis| (self.to[axis] - self.from[axis]) / length)
    }

    /// Returns the wedge to cut off a strip's end for its slant: at the start (1) or at the end (-1).
    fn wedge(&self, sign: f64, slant: f64, width_mm: f64) -> Contour {
        let end = if sign > 0.0 { self.from } else { self.to };
        let along = self.along().map(|c| sign * c);
        let at = |a: f64, mm: f64| offset(offset(end, along, a), self.outward, mm);
        // Slightly larger outwards and backwards, so that nothing of the corner stays.
        vec![
            at(0.0, 0.0),
            at(1.2 * slant, 1.2 * width_mm),
            at(-width_mm, 1.2 * width_mm),
            at(-width_mm, 0.0),
        ]
    }
}

fn lines(seam: &Seam, pieces: &[Piece], side: usize) -> Vec<Line> {
    let line = |edge: &SeamEdge| {
        let [from, to] = edge.ends(pieces, side);
        let outward = border(pieces, edge.sides[side]).outward;
        Line { from, to, outward }
    };
    seam.edges.iter().map(line).collect()
}

/// Splits a border where it turns by more than paper folds along.
fn straight_parts(lines: &[Line]) -> impl Iterator<Item = &[Line]> {
    let goes_on = |a: &Line, b: &Line| {
        let ([ax, ay], [bx, by]) = (a.along(), b.along());
        ax * bx + ay * by > BEND_DEG.to_radians().cos()
    };
    lines.chunk_by(goes_on)
}

/// Returns a strip of quadrilaterals, and the wedges between them at corners.
fn beside(lines: &[Line], width_mm: f64) -> Vec<Contour> {
    let mut outlines = Vec::new();
    for line in lines {
        let Line { from, to, outward } = *line;
        let [outer, other] = [to, from].map(|p| offset(p, outward, width_mm));
        outlines.push(vec![from, to, outer, other]);
    }
    for pair in lines.windows(2) {
        let corner = pair[0].to;
        let out = |line: &Line| offset(corner, line.outward, width_mm);
        outlines.push(vec![corner, out(&pair[0]), out(&pair[1])]);
    }
    outlines
}
