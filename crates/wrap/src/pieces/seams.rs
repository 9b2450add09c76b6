//! Seams: runs of border edges shared by two pieces, or by two borders of one piece.

use std::collections::BTreeMap;

use super::flat::{Border, Piece, near};
use scaleproof_core::geometry::{Point2, between, distance};

/// Border edge of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct BorderId {
    pub piece: usize,
    pub border: usize,
}

/// Run of consecutive edges, each shared by both pieces.
#[derive(Debug, Clone)]
pub struct Seam {
    pub letter: String,
    pub edges: Vec<SeamEdge>,
    pub length_mm: f64,
}

#[derive(Debug, Clone, Copy)]
pub struct SeamEdge {
    pub sides: [BorderId; 2],
    /// True if the run goes from the edge's second end to its first.
    pub backwards: bool,
    pub length_mm: f64,
}

impl SeamEdge {
    /// Returns its ends on paper on one side, in the order of the seam.
    pub fn ends(&self, pieces: &[Piece], side: usize) -> [Point2; 2] {
        let [a, b] = border(pieces, self.sides[side]).flat;
        if self.backwards { [b, a] } else { [a, b] }
    }
}

#[derive(Debug, Clone, Copy)]
pub struct SeamPlace {
    pub at: Point2,
    pub outward: Point2,
}

impl Seam {
    /// Returns the pieces on its two sides.
    pub fn pieces(&self) -> [usize; 2] {
        self.edges.first().map_or([0; 2], |edge| edge.sides.map(|id| id.piece))
    }

    pub fn place(&self, pieces: &[Piece], side: usize, share: f64) -> Option<SeamPlace> {
        let mut rest = share.clamp(0.0, 1.0) * self.length_mm;
        let last = self.edges.len().checked_sub(1)?;
        for (i, edge) in self.edges.iter().enumerate() {
            if rest <= edge.length_mm || i == last {
                let border = border(pieces, edge.sides[side]);
                let along = (rest / edge.length_mm.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                let along = if edge.backwards { 1.0 - along } else { along };
                let [a, b] = border.flat;
                return Some(SeamPlace {
                    at: between(a, b, along),
                    outward: border.outward,
                });
            }
            rest -= edge.length_mm;
        }
        None
    }
}

pub fn border(pieces: &[Piece], id: BorderId) -> &Border {
    &pieces[id.piece].borders[id.border]
}

/// Returns all seams, the longest first, with their letters.
pub fn seams(pieces: &[Piece]) -> Vec<Seam> {
    let mut all: Vec<Seam> = runs(pieces, shared(pieces));
    all.sort_by(|a, b| b.length_mm.total_cmp(&a.length_mm));
    for (i, seam) in all.iter_mut().enumerate() {
        // Lower case, because the numbers of pieces are the large signs.
        seam.letter = scaleproof_print::template::letters(i).to_lowercase();
    }
    all
}

/// Returns the edges that two borders share, the lower border first.
fn shared(pieces: &[Piece]) -> Vec<[BorderId; 2]> {
    let mut at = BTreeMap::<[usize; 2], Vec<BorderId>>::new();
    for (i, piece) in pieces.iter().enumerate() {
        for (b, border) in piece.borders.iter().enumerate() {
            at.entry(border.ends)
                .or_default()
                .push(BorderId { piece: i, border: b });
        }
    }
    // Where more than two layers of the surface meet, they are joined in pairs.
    let pairs = at.values().flat_map(|ids| ids.chunks_exact(2));
    pairs.map(|pair| [pair[0], pair[1]]).collect()
}

/// Returns the chains of shared edges that continue on both pieces.
fn runs(pieces: &[Piece], edges: Vec<[BorderId; 2]>) -> Vec<Seam> {
    let mut chains = Chains::new(pieces, edges);
    let mut seams = Vec::new();
    for start in 0..chains.edges.len() {
        if std::mem::replace(&mut chains.taken[start], true) {
            continue;
        }
        let sides = chains.edges[start];
        let [a, b] = border(pieces, sides[0]).ends;
        let mut run = chains.walk(a, start, sides);
        // The part up to the start was followed from the start backwards.
        run.reverse();
        run.iter_mut().for_each(|edge| edge.backwards = !edge.backwards);
        run.push(chains.seam_edge(sides, false));
        run.extend(chains.walk(b, start, sides));
        seams.push(Seam {
            letter: String::new(),
            length_mm: run.iter().map(|edge| edge.length_mm).sum(),
            edges: run,
        });
    }
    seams
}

struct Chains<'a> {
    pieces: &'a [Piece],
    edges: Vec<[BorderId; 2]>,
    /// Edges that begin or end at a corner.
    at: BTreeMap<usize, Vec<usize>>,
    taken: Vec<bool>,
}

impl<'a> Chains<'a> {
    fn new(pieces: &'a [Piece], edges: Vec<[BorderId; 2]>) -> Self {
        let mut at = BTreeMap::<usize, Vec<usize>>::new();
        for (i, sides) in edges.iter().enumerate() {
            for end in border(pieces, sides[0]).ends {
                at.entry(end).or_default().push(i);
            }
        }
        Self {
            pieces,
            taken: vec![false; edges.len()],
            edges,
            at,
        }
    }

    /// Returns the edges that follow one at one of its corners.
    fn walk(&mut self, mut corner: usize, mut edge: usize, mut sides: [BorderId; 2]) -> Vec<SeamEdge> {
        let mut run = Vec::new();
        while let Some((following, its_sides)) = self.next(corner, edge, sides).filter(|(i, _)| !self.taken[*i]) {
            self.taken[following] = true;
            let [a, b] = border(self.pieces, its_sides[0]).ends;
            run.push(self.seam_edge(its_sides, corner == b));
            corner = if corner == a { b } else { a };
            (edge, sides) = (following, its_sides);
        }
        run
    }

    /// Returns the only edge that continues at a corner on both sides. At a slit, either border may be the first.
    fn next(&self, corner: usize, edge: usize, sides: [BorderId; 2]) -> Option<(usize, [BorderId; 2])> {
        let ends = sides.map(|id| end_at(self.pieces, id, corner));
        let goes_on = |i: &usize| {
            let [first, second] = self.edges[*i];
            let mut both_ways = [[first, second], [second, first]].into_iter();
            let joined = |ids: &[BorderId; 2]| {
                (0..2).all(|side| {
                    ids[side].piece == sides[side].piece && near(ends[side], end_at(self.pieces, ids[side], corner))
                })
            };
            Some((*i, both_ways.find(joined)?))
        };
        let others = self.at.get(&corner)?.iter().filter(|i| **i != edge);
        let mut found = others.filter_map(goes_on);
        let following = found.next()?;
        found.next().is_none().then_some(following)
    }

    fn seam_edge(&self, sides: [BorderId; 2], backwards: bool) -> SeamEdge {
        let [a, b] = sides.map(|id| {
            let [from, to] = border(self.pieces, id).flat;
            distance(from, to)
        });
        SeamEdge {
            sides,
            backwards,
            length_mm: a.max(b),
        }
    }
}

/// Returns the position on paper of an end of a border.
fn end_at(pieces: &[Piece], id: BorderId, corner: usize) -> Point2 {
    let border = border(pieces, id);
    border.flat[usize::from(border.ends[0] != corner)]
}
