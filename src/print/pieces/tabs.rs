//! Glue tabs: on one side of each seam a strip of paper that goes under the other piece.

use super::flat::Piece;
use super::seams::{Seam, border};
use crate::print::wrap::{Contour, Point, Region};

/// A tab that is cut back to less than this share of its length times its width does not hold.
const LEAST_SHARE: f64 = 0.4;
/// Shorter seams hold without a tab.
const SHORTEST_MM: f64 = 6.0;
/// Between a tab and what else is there, for the knife.
const GAP_MM: f64 = 0.6;

/// The tabs of one piece.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tabs {
    pub region: Region,
    /// Where they are folded: along the border.
    pub folds: Vec<[Point; 2]>,
}

/// The tabs of all pieces, and of each seam the side that has one and how far from the border its letter stands.
pub(crate) struct AllTabs {
    pub tabs: Vec<Tabs>,
    pub sides: Vec<Option<(usize, f64)>>,
}

/// Tabs of a width on one side of each seam, the one that has more room.
pub(crate) fn tabs(pieces: &[Piece], seams: &[Seam], width_mm: Option<f64>) -> AllTabs {
    let mut all = AllTabs {
        tabs: vec![Tabs::default(); pieces.len()],
        sides: vec![None; seams.len()],
    };
    let Some(width_mm) = width_mm else { return all };
    let near: Vec<Region> = pieces.iter().map(|piece| piece.region.grown(GAP_MM)).collect();
    for (seam, chosen) in seams.iter().zip(&mut all.sides) {
        if seam.length_mm < SHORTEST_MM {
            continue;
        }
        let room = |side: usize| {
            let piece = seam.pieces()[side];
            let strip = strip(seam, pieces, side, width_mm);
            // What runs along the border stays; what comes near another part of the piece goes.
            let own = Region::union(along(seam, pieces, side, 2.0 * GAP_MM));
            let off = strip.without(&near[piece].without(&own)).without(&pieces[piece].region);
            off.without(&all.tabs[piece].region.grown(GAP_MM))
        };
        let both = [room(0), room(1)];
        let side = usize::from(both[1].area_mm2() > both[0].area_mm2());
        if both[side].area_mm2() < LEAST_SHARE * seam.length_mm * width_mm {
            continue;
        }
        *chosen = Some((side, 0.55 * width_mm));
        let tabs = &mut all.tabs[seam.pieces()[side]];
        tabs.region = tabs.region.or(&both[side]);
        tabs.folds
            .extend(seam.edges.iter().map(|edge| border(pieces, edge.sides[side]).flat));
    }
    all
}

/// The strip beside a seam, its ends slanted.
fn strip(seam: &Seam, pieces: &[Piece], side: usize, width_mm: f64) -> Region {
    let slant = width_mm.min(0.3 * seam.length_mm);
    let whole = Region::union(along(seam, pieces, side, width_mm));
    let ends: Vec<Contour> = [0.0, 1.0]
        .iter()
        .filter_map(|end| wedge(seam, pieces, side, *end, width_mm, slant))
        .collect();
    whole.without(&Region::union(ends))
}

/// A strip of quadrilaterals, and the wedges between them at corners.
fn along(seam: &Seam, pieces: &[Piece], side: usize, width_mm: f64) -> Vec<Contour> {
    let out = |p: Point, n: Point| [p[0] + width_mm * n[0], p[1] + width_mm * n[1]];
    let mut outlines = Vec::new();
    let mut last: Option<(Point, Point)> = None;
    for edge in &seam.edges {
        let border = border(pieces, edge.sides[side]);
        let [mut a, mut b] = border.flat;
        if edge.backwards {
            std::mem::swap(&mut a, &mut b);
        }
        if let Some((corner, normal)) = last {
            outlines.push(vec![corner, out(corner, normal), out(corner, border.outward)]);
        }
        outlines.push(vec![a, b, out(b, border.outward), out(a, border.outward)]);
        last = Some((b, border.outward));
    }
    outlines
}

/// What the slanted end of a strip loses.
fn wedge(seam: &Seam, pieces: &[Piece], side: usize, end: f64, width_mm: f64, slant: f64) -> Option<Contour> {
    let place = seam.place(pieces, side, end)?;
    let inner = seam.place(pieces, side, (end - slant / seam.length_mm).abs())?;
    let [nx, ny] = place.outward;
    let (dx, dy) = (inner.at[0] - place.at[0], inner.at[1] - place.at[1]);
    let along = [ny, -nx];
    let sign = (along[0] * dx + along[1] * dy).signum();
    let at = |a: f64, out: f64| [0, 1].map(|k| place.at[k] + a * sign * along[k] + out * place.outward[k]);
    // A little more outwards and backwards, so that nothing of the corner stays.
    Some(vec![
        at(0.0, 0.0),
        at(1.2 * slant, 1.2 * width_mm),
        at(-width_mm, 1.2 * width_mm),
        at(-width_mm, 0.0),
    ])
}
