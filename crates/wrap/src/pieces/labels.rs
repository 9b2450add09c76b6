//! Signs beside a piece: the letters of its seams, ticks where seams end, and its number; all outside the ink, and without overlaps.

use super::BLEED_MM;
use super::flat::Piece;
use super::seams::Seam;
use scaleproof_core::geometry::{Point2, between, distance, nearest_share, offset};
use scaleproof_print::buckets::{Buckets, bounds};
use scaleproof_print::wrap::Region;

/// Radius of a letter's room, and of two letters'.
const LETTER_MM: f64 = 1.6;
const LETTERS_MM: f64 = 2.2;
/// Size factors that are tried.
const SIZES: [f64; 2] = [1.0, 0.75];
/// Radius of the ring around a piece's number.
pub const NUMBER_RING_MM: f64 = 3.0;
/// Radius of the ring with its arrow.
const NUMBER_MM: f64 = 4.4;
/// Gap between labels, and between labels and ink.
const CLEAR_MM: f64 = 0.3;
/// Maximum distance of a label from the border.
const FARTHEST_MM: f64 = 24.0;
/// Distance between two ticks along a seam.
const TICKS_MM: f64 = 40.0;
/// Length of ticks beyond the ink, at the ends of a seam and along it.
const END_TICK_MM: f64 = 1.6;
const TICK_MM: f64 = 0.8;
/// Directions of a leader, relative to the outward normal of the border.
const TURNS_DEG: [f64; 13] = [
    0.0, 20.0, -20.0, 40.0, -40.0, 60.0, -60.0, 80.0, -80.0, 100.0, -100.0, 120.0, -120.0,
];

/// Sign beside a piece, in the piece's plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    pub text: String,
    pub at: Point2,
    pub radius_mm: f64,
    /// Point2 of the border that it names.
    pub names: Point2,
    pub is_number: bool,
}

/// All signs beside one piece.
#[derive(Debug, Clone, Default)]
pub struct Signs {
    pub labels: Vec<Label>,
    /// Ticks from the border outwards.
    pub ticks: Vec<[Point2; 2]>,
}

impl Signs {
    pub fn leaders(&self) -> impl Iterator<Item = [Point2; 2]> {
        self.labels.iter().map(|label| [label.names, label.at])
    }

    /// Returns true if a disc has at least this clearance from all labels, leaders and ticks.
    pub fn are_off(&self, at: Point2, radius_mm: f64, clear_mm: f64) -> bool {
        let mut lines = self.leaders().chain(self.ticks.iter().copied());
        let off_label = |label: &Label| distance(label.at, at) >= label.radius_mm + radius_mm + clear_mm;
        self.labels.iter().all(off_label) && lines.all(|line| to_line(at, line) >= radius_mm + clear_mm)
    }
}

/// Returns the signs of all pieces, and the length of the seams without a letter on one of their sides. `inks` are the printed areas of the pieces,
/// with bleed and tabs; `tabs` has for each seam the side with a tab, and the letter's distance from the border there; `around_mm` is the distance
/// from a piece's bounding box to the farthest sign.
pub fn signs(
    pieces: &[Piece],
    seams: &[Seam],
    inks: &[Region],
    tabs: &[Option<(usize, f64)>],
    around_mm: f64,
) -> (Vec<Signs>, f64) {
    let with_ink = pieces.iter().zip(inks);
    let mut places: Vec<_> = with_ink
        .map(|(piece, ink)| Places::new(piece, ink, around_mm))
        .collect();
    for seam in seams {
        ticks(seam, pieces, &mut places);
    }
    let mut unlettered_mm = 0.0;
    // The shortest first: the longest find room elsewhere.
    for (seam, tab) in seams.iter().zip(tabs).rev() {
        if !letter(seam, pieces, &mut places, *tab) {
            unlettered_mm += seam.length_mm;
        }
    }
    for (i, places) in places.iter_mut().enumerate() {
        places.number(i + 1);
    }
    (places.into_iter().map(|p| p.signs).collect(), unlettered_mm)
}

/// Places the letter of a seam on both of its sides, smaller if there is little room; returns `false` if there is none.
fn letter(seam: &Seam, pieces: &[Piece], places: &mut [Places], tab: Option<(usize, f64)>) -> bool {
    let is_one = seam.letter.chars().count() == 1;
    let radius_mm = if is_one { LETTER_MM } else { LETTERS_MM };
    SIZES.iter().any(|size| {
        let search = LetterSearch {
            seam,
            pieces,
            tab,
            radius_mm: size * radius_mm,
        };
        search.together(places) || search.apart(places)
    })
}

/// Search for the places of a seam's letter.
struct LetterSearch<'a> {
    seam: &'a Seam,
    pieces: &'a [Piece],
    tab: Option<(usize, f64)>,
    radius_mm: f64,
}

impl LetterSearch<'_> {
    /// Returns the candidate positions, as shares of the seam's length; the ends, too, since a slit is open only at its mouth.
    fn shares(&self) -> Vec<f64> {
        let steps = (self.seam.length_mm / 4.0).ceil().clamp(1.0, 24.0) as usize;
        let inner = (0..steps).map(|i| (i as f64 + 0.5) / steps as f64);
        [0.01].into_iter().chain(inner).chain([0.99]).collect()
    }

    fn find(&self, places: &[Places], side: usize, share: f64) -> Option<(f64, Label)> {
        let place = self.seam.place(self.pieces, side, share)?;
        let (away, at) = match self.tab {
            Some((with_tab, mm)) if with_tab == side => (0.0, offset(place.at, place.outward, mm)),
            _ => places[self.seam.pieces()[side]].free(place.at, place.outward, self.radius_mm)?,
        };
        let label = Label {
            text: self.seam.letter.clone(),
            at,
            radius_mm: self.radius_mm,
            names: place.at,
            is_number: false,
        };
        Some((away, label))
    }

    /// Places the letters at the same place of the seam on both sides.
    fn together(&self, places: &mut [Places]) -> bool {
        let [one, other] = self.seam.pieces();
        // On one piece, both labels may need the same room.
        let reach = 2.0 * self.radius_mm + CLEAR_MM;
        let off_middle = |share: f64| 0.3 * (share - 0.5).abs() * self.seam.length_mm;
        let both = self.shares().into_iter().filter_map(|share| {
            let ((away, first), (too, second)) = (self.find(places, 0, share)?, self.find(places, 1, share)?);
            let clear = one != other || distance(first.at, second.at) >= reach;
            clear.then_some((away + too + off_middle(share), [first, second]))
        });
        let Some((_, [first, second])) = both.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return false;
        };
        places[one].signs.labels.push(first);
        places[other].signs.labels.push(second);
        true
    }

    /// Places the letters wherever there is room on each side.
    fn apart(&self, places: &mut [Places]) -> bool {
        let best = |places: &[Places], side: usize| {
            let shares = self.shares().into_iter();
            let found = shares.filter_map(|share| self.find(places, side, share));
            found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, label)| label)
        };
        let [one, other] = self.seam.pieces();
        let Some(first) = best(places, 0) else { return false };
        places[one].signs.labels.push(first);
        let Some(second) = best(places, 1) else {
            places[one].signs.labels.pop();
            return false;
        };
        places[other].signs.labels.push(second);
        true
    }
}

/// Draws ticks at both ends of a seam and along it, at the same places on both sides.
fn ticks(seam: &Seam, pieces: &[Piece], places: &mut [Places]) {
    let between = (seam.length_mm / TICKS_MM).round().max(1.0) as usize;
    for i in 0..=between {
        let is_end = i == 0 || i == between;
        let length_mm = BLEED_MM + if is_end { END_TICK_MM } else { TICK_MM };
        for (side, piece) in seam.pieces().into_iter().enumerate() {
            if let Some(place) = seam.place(pieces, side, i as f64 / between as f64) {
                places[piece].tick(place.at, place.outward, length_mm);
            }
        }
    }
}

/// Free room beside one piece.
struct Places<'a> {
    signs: Signs,
    piece: &'a Piece,
    ink: &'a Region,
    edges: Vec<[Point2; 2]>,
    buckets: Buckets,
    low: Point2,
    high: Point2,
}

impl<'a> Places<'a> {
    fn new(piece: &'a Piece, ink: &'a Region, around_mm: f64) -> Self {
        let (low, high) = piece.region.bounds().unwrap_or_default();
        let (low, high) = (low.map(|mm| mm - around_mm), high.map(|mm| mm + around_mm));
        let edges: Vec<[Point2; 2]> = ink.edges().map(|(a, b)| [*a, *b]).collect();
        let reach = NUMBER_MM + CLEAR_MM;
        Self {
            signs: Signs::default(),
            buckets: Buckets::new(low, high, edges.iter().map(|e| bounds(e, reach))),
            piece,
            ink,
            edges,
            low,
            high,
        }
    }

    /// Returns a free position for a label near a point of the border, and its distance. In a notch, its leader may cross the bleed.
    fn free(&self, border: Point2, outward: Point2, radius_mm: f64) -> Option<(f64, Point2)> {
        let nearest = BLEED_MM + radius_mm + CLEAR_MM;
        let count = (FARTHEST_MM / 0.8) as usize;
        let find = |blocking: &Region| {
            (0..count).map(|i| nearest + 0.8 * i as f64).find_map(|mm| {
                TURNS_DEG.iter().find_map(|turn| {
                    let (s, c) = turn.to_radians().sin_cos();
                    let direction = [c * outward[0] - s * outward[1], s * outward[0] + c * outward[1]];
                    let at = offset(border, direction, mm);
                    let clear = self.is_free(at, radius_mm) && self.is_open(border, at, radius_mm, blocking);
                    clear.then_some((mm, at))
                })
            })
        };
        // A label across its neighbours' bleed is less legible than a distant one.
        let crossing = || find(&self.piece.region).map(|(mm, at)| (mm + FARTHEST_MM, at));
        find(self.ink).or_else(crossing)
    }

    /// Returns true if a disc is inside the room and clear of all ink and signs.
    fn is_free(&self, at: Point2, radius_mm: f64) -> bool {
        let inside =
            (0..2).all(|axis| at[axis] - radius_mm >= self.low[axis] && at[axis] + radius_mm <= self.high[axis]);
        let off_ink = || {
            let mut near = self.buckets.at(at).unwrap_or_default().iter();
            let is_off = |line| to_line(at, line) >= radius_mm + CLEAR_MM;
            near.all(|i| is_off(self.edges[*i as usize])) && !self.ink.contains(at)
        };
        inside && self.signs.are_off(at, radius_mm, CLEAR_MM) && off_ink()
    }

    /// Returns true if a leader from the border reaches a label without crossing `blocking`.
    fn is_open(&self, border: Point2, at: Point2, radius_mm: f64, blocking: &Region) -> bool {
        let length = distance(border, at);
        let along = |mm: f64| between(border, at, mm / length);
        let from = BLEED_MM + 2.0 * CLEAR_MM;
        let samples = ((length - radius_mm - from) / 0.4).ceil().max(0.0) as usize;
        (0..samples).all(|i| {
            let p = along(from + 0.4 * i as f64);
            let mut labels = self.signs.labels.iter();
            labels.all(|l| distance(l.at, p) >= l.radius_mm + CLEAR_MM) && !blocking.contains(p)
        })
    }

    fn tick(&mut self, at: Point2, outward: Point2, length_mm: f64) {
        let end = offset(at, outward, length_mm);
        let known = self.signs.ticks.iter().any(|[start, _]| distance(*start, at) < 0.5);
        let steps = (length_mm / 0.25) as usize;
        let into = (1..=steps).any(|i| self.piece.region.contains(offset(at, outward, 0.25 * i as f64)));
        if !known && !into {
            self.signs.ticks.push([at, end]);
        }
    }

    /// Places the piece's number where there is room nearest to its border.
    fn number(&mut self, number: usize) {
        let spots = self.piece.borders.iter().filter_map(|border| {
            let [a, b] = border.flat;
            let middle = [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]));
            let (away, at) = self.free(middle, border.outward, NUMBER_MM)?;
            Some((away, middle, at))
        });
        if let Some((_, names, at)) = spots.min_by(|a, b| a.0.total_cmp(&b.0)) {
            self.signs.labels.push(Label {
                text: number.to_string(),
                at,
                radius_mm: NUMBER_MM,
                names,
                is_number: true,
            });
        }
    }
}

/// Returns the distance of a point from a segment.
fn to_line(p: Point2, [a, b]: [Point2; 2]) -> f64 {
    distance(p, between(a, b, nearest_share(p, [a, b])))
}
