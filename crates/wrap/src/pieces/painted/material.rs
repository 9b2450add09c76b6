//! Sheet of material for a piece's stencils: the piece and a rim around it, with registration holes. The rim leaves slits of the piece free, so that
//! they close on the model.

use super::regions::Upright;
use crate::pieces::flat::Piece;
use crate::pieces::labels::Signs;
use crate::pieces::seams::Seam;
use scaleproof_core::geometry::{Point2, between, circle, distance};
use scaleproof_print::paint::plane::{Area, units};
use scaleproof_print::paint::{hole_mm, rim_mm};
use scaleproof_print::sheet::sides;
use scaleproof_print::wrap::{Contour, Region};

/// Number of holes of a piece, and their minimum distance.
const HOLES: usize = 4;
const APART_MM: f64 = 12.0;
/// Distance between candidate positions for a hole.
const STEP_MM: f64 = 1.5;
/// Radius of the sign that names the paint.
pub const TAG_MM: f64 = 2.3;
/// Gap between holes and signs.
const CLEAR_MM: f64 = 0.4;
/// Distance of a slit's sides at which it is closed.
const CLOSED_MM: f64 = 0.05;

/// Parts common to all stencils of a piece.
#[derive(Debug, Clone)]
pub struct Material {
    /// Uncut sheet, turned upright.
    pub sheet: Area,
    /// Centres of the registration holes, in the piece's plane.
    pub holes: Vec<Point2>,
    pub tag: Option<Point2>,
}

/// Returns the sheet of one piece for features of a minimum width. `slit`: the rim leaves the piece's slits free, if the sheet then stays in one part
/// that is nowhere narrower than the features.
pub fn sheet(
    (piece, pieces): (usize, &[Piece]),
    seams: &[Seam],
    upright: &Upright,
    feature_mm: f64,
    slit: bool,
) -> Area {
    let region = upright.area(&pieces[piece].region);
    // Gaps between two parts of the rim are at least this wide, or filled.
    let (closed, rim_mm) = (units(2.0 * feature_mm), rim_mm(feature_mm));
    let whole = region.grown(units(rim_mm) + closed).shrunk(closed);
    let own = seams.iter().filter(|seam| seam.pieces() == [piece; 2]);
    let slits: Vec<Contour> = own.flat_map(|seam| gap(seam, pieces, 3.0 * rim_mm)).collect();
    if !slit || slits.is_empty() {
        return whole;
    }
    let slits = upright.area(&Region::union(slits).without(&pieces[piece].region));
    let mut open = whole.without(&slits);
    // A part of the rim without connection to the piece is removed with the slit.
    open.pieces
        .retain(|part| !Area::from_piece(part).and(&region).is_empty());
    let is_one = open.shrunk(units(0.5 * feature_mm)).pieces.len() == 1;
    if is_one { open } else { whole }
}

/// Returns the area between the two sides of a seam of a piece with itself, extended beyond its open end.
fn gap(seam: &Seam, pieces: &[Piece], beyond_mm: f64) -> Vec<Contour> {
    let sides = |i: usize| {
        let edge = seam.edges.get(i)?;
        Some([0, 1].map(|side| edge.ends(pieces, side)))
    };
    let count = seam.edges.len();
    let between = (0..count).filter_map(sides).map(|[[a, b], [c, d]]| vec![a, b, d, c]);
    let out = |[from, to]: [Point2; 2]| {
        let share = beyond_mm / distance(from, to).max(1e-9);
        [0, 1].map(|axis| to[axis] + share * (to[axis] - from[axis]))
    };
    let first = sides(0).map(|sides| sides.map(|[a, b]| [b, a]));
    let last = count.checked_sub(1).and_then(sides);
    let mouth = |[one, other]: [[Point2; 2]; 2]| {
        let is_open = distance(one[1], other[1]) > CLOSED_MM;
        is_open.then(|| vec![one[1], out(one), out(other), other[1]])
    };
    let mouths = [first, last].into_iter().flatten().filter_map(mouth);
    between.chain(mouths).collect()
}

impl Material {
    /// Places holes and the paint's sign in the rim, clear of the other signs.
    pub fn new(sheet: Area, piece: &Piece, signs: &Signs, upright: &Upright, feature_mm: f64) -> Self {
        let middle = piece.region.grown(0.5 * rim_mm(feature_mm));
        let around: Vec<Point2> = middle.contours().flat_map(along).collect();
        let holds = |p: Point2, radius: f64| circle(p, radius, 12).all(|p| sheet.contains(upright.units(p)));
        let radius = 0.5 * hole_mm(feature_mm);
        let firm = around.into_iter().filter(|p| holds(*p, radius + feature_mm));
        let firm: Vec<Point2> = firm.collect();
        let is_clear = |p: &Point2, radius_mm: f64| signs.are_off(*p, radius_mm, CLEAR_MM);
        let clear: Vec<Point2> = firm.iter().copied().filter(|p| is_clear(p, radius)).collect();
        let holes = spread(if clear.is_empty() { &firm } else { &clear });
        let off_holes = |p: &Point2| holes.iter().all(|h| distance(*p, *h) > radius + TAG_MM + CLEAR_MM);
        let number = signs.labels.iter().find(|label| label.is_number).map(|label| label.at);
        let to_number = |p: &Point2| number.map_or(0.0, |at| distance(*p, at));
        let nearest = |is_free: &dyn Fn(&Point2) -> bool| {
            let places = firm.iter().copied().filter(|p| off_holes(p) && is_free(p));
            places.min_by(|a, b| to_number(a).total_cmp(&to_number(b)))
        };
        let free = nearest(&|p| is_clear(p, TAG_MM));
        Self {
            tag: free.or_else(|| nearest(&|_| true)),
            sheet,
            holes,
        }
    }
}

fn along(outline: &Contour) -> Vec<Point2> {
    let places = |(a, b): (&Point2, &Point2)| {
        let (a, b) = (*a, *b);
        let steps = (distance(a, b) / STEP_MM).ceil().max(1.0) as usize;
        (0..steps).map(move |i| between(a, b, i as f64 / steps as f64))
    };
    sides(outline).flat_map(places).collect()
}

/// Returns a few positions far from each other.
fn spread(places: &[Point2]) -> Vec<Point2> {
    let corner = |a: &&Point2, b: &&Point2| (a[0] + a[1]).total_cmp(&(b[0] + b[1]));
    let mut chosen: Vec<Point2> = places.iter().min_by(corner).copied().into_iter().collect();
    while chosen.len() < HOLES {
        let apart = |p: &Point2| chosen.iter().map(|c| distance(*c, *p)).fold(f64::INFINITY, f64::min);
        let farthest = places.iter().max_by(|a, b| apart(a).total_cmp(&apart(b)));
        match farthest.filter(|p| apart(p) >= APART_MM) {
            Some(p) => chosen.push(*p),
            None => break,
        }
    }
    chosen
}
