//! Greedy gluing of pieces: those with the least cost in stretch per saved border first, as long as all bounds are kept.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::assembly::{Assembly, Edge, Piece, Sums};
use super::borders::{Pair, borders, halves, runs};

/// Levels of effort for few pieces. The first level is always run, the others in turn while there are too many pieces.
const LEVELS: [Level; 3] = [
    Level {
        worst_excess: 1.0,
        paper_mm: 20.0,
        halves: false,
    },
    Level {
        worst_excess: 2.0,
        paper_mm: 40.0,
        halves: true,
    },
    Level {
        worst_excess: 4.0,
        paper_mm: f64::INFINITY,
        halves: true,
    },
];
/// Cost of a seam, as stretch of the smaller piece: pieces without any stretch are glued along their longest borders.
const SEAM: f64 = 0.002;
/// Share of the outline that counts as zero.
const LEAST_SHARE: f64 = 0.05;
/// Share of the paint that may be left out if the number of pieces is bounded, and the share that is good enough to stop.
const LEFT_OUT: f64 = 0.03;
const LEFT_OUT_WELL: f64 = 0.02;
/// Share of the area that may be above the 99th percentile, with some margin.
const ABOVE: f64 = 0.0095;

struct Level {
    /// Maximum excess of a piece's mean stretch, as a multiple of the requested one.
    worst_excess: f64,
    /// Maximum additional paper, as rectangles, of glued pieces: mm² per mm of the border they save.
    paper_mm: f64,
    /// True to glue borders that cannot be glued whole by halves.
    halves: bool,
}

/// Returns the number of the largest pieces that contain all the paint but what may be left out.
pub(super) fn needed(pieces: &[Piece]) -> usize {
    without_small(pieces.iter(), LEFT_OUT)
}

fn without_small<'a>(pieces: impl Iterator<Item = &'a Piece>, share: f64) -> usize {
    let mut areas: Vec<f64> = pieces.map(|p| p.sums.area).collect();
    areas.sort_by(f64::total_cmp);
    let mut left = share * areas.iter().sum::<f64>();
    let small = areas.iter().take_while(|area| {
        left -= *area;
        left >= 0.0
    });
    areas.len() - small.count()
}

/// Glues these into few pieces. Compact ones are tried first; if they are too many, later levels begin at once, since pieces glued by the first may
/// block others.
pub(super) fn pieces(assembly: &Assembly, progress: &mut dyn FnMut(f64)) -> Vec<Piece> {
    let mut best: Option<(usize, Assembly)> = None;
    for first in 0..LEVELS.len() {
        let part = |share: f64| (first as f64 + share) / LEVELS.len() as f64;
        let mut merge = Merge::new(assembly.clone());
        merge.run(&LEVELS[first..], &mut |share| progress(part(share)));
        let needed = merge.needed(LEFT_OUT);
        let is_good = merge.is_few(LEFT_OUT_WELL);
        if best.as_ref().is_none_or(|(least, _)| is_good || needed < *least) {
            best = Some((needed, merge.assembly));
        }
        if is_good {
            break;
        }
    }
    best.map_or(Vec::new(), |(_, assembly)| assembly.finish())
}

/// Two pieces that may be glued, and the resulting piece.
struct Trial {
    pair: Pair,
    edges: Vec<Edge>,
    made: Piece,
}

struct Merge<'a> {
    assembly: Assembly<'a>,
    level: &'static Level,
    /// Trials; `None` once done, or if one of its pieces no longer exists.
    trials: Vec<Option<Trial>>,
    trials_of: Vec<Vec<usize>>,
    /// Bits of a trial's cost, which sort like the costs, and the trial's index.
    queue: BinaryHeap<Reverse<(u64, usize)>>,
}

impl<'a> Merge<'a> {
    fn new(assembly: Assembly<'a>) -> Self {
        Self {
            assembly,
            level: &LEVELS[0],
            trials: Vec::new(),
            trials_of: Vec::new(),
            queue: BinaryHeap::new(),
        }
    }

    fn alive(&self) -> impl Iterator<Item = &Piece> {
        self.assembly.pieces.iter().flatten()
    }

    fn needed(&self, left_out: f64) -> usize {
        without_small(self.alive(), left_out)
    }

    /// Returns true if there are few enough pieces; always, if their number is not bounded.
    fn is_few(&self, left_out: f64) -> bool {
        let most = self.assembly.request.most_pieces;
        most.is_none_or(|most| self.needed(left_out) <= most)
    }

    /// Glues level by level, beyond the first only until there are few enough pieces.
    fn run(&mut self, levels: &'static [Level], progress: &mut dyn FnMut(f64)) {
        let first = self.alive().count().max(1) as f64;
        for (done, level) in levels.iter().enumerate() {
            self.level = level;
            self.assembly.worst_excess = level.worst_excess * (self.assembly.request.mean_stretch - 1.0);
            self.try_borders(None);
            while !(done > 0 && self.is_few(LEFT_OUT_WELL)) && self.step() {
                progress(1.0 - self.alive().count() as f64 / first);
            }
            (self.trials, self.trials_of) = (Vec::new(), Vec::new());
            self.queue.clear();
        }
    }

    /// Glues the cheapest pair; returns false if there is none.
    fn step(&mut self) -> bool {
        let Some(Reverse((_, index))) = self.queue.pop() else {
            return false;
        };
        let Some(Trial { pair, edges, made }) = self.trials[index].take() else {
            return true;
        };
        if !self.is_affordable(self.apart(pair), made.sums) {
            return true;
        }
        for piece in [pair.0, pair.1] {
            self.assembly.pieces[piece] = None;
            for trial in std::mem::take(&mut self.trials_of[piece]) {
                self.trials[trial] = None;
            }
        }
        self.assembly.add(made, &edges);
        self.try_borders(Some(self.assembly.pieces.len() - 1));
        true
    }

    /// Returns the sums of two pieces, or of one at a slit.
    fn apart(&self, (a, b): Pair) -> Sums {
        let sums = |piece: usize| self.assembly.pieces[piece].as_ref().map_or(Sums::default(), |p| p.sums);
        if a == b { sums(a) } else { sums(a) + sums(b) }
    }

    /// Returns true if all pieces together keep the bounds, also when some are left out.
    fn is_affordable(&self, apart: Sums, made: Sums) -> bool {
        let all = self.alive().fold(Sums::default(), |sum, piece| sum + piece.sums);
        let area = (1.0 - LEFT_OUT) * all.area;
        all.excess + made.excess - apart.excess <= (self.assembly.request.mean_stretch - 1.0) * area
            && (made.above <= apart.above || all.above + made.above - apart.above <= ABOVE * area)
    }

    fn try_borders(&mut self, of: Option<usize>) {
        for (pair, edges) in borders(&self.assembly, of) {
            if self.try_to_glue(pair, &edges) {
                continue;
            }
            let runs = runs(&self.assembly, &edges);
            let is_one = runs.len() == 1;
            for run in runs {
                if (is_one || !self.try_to_glue(pair, &run)) && self.level.halves {
                    for half in halves(&self.assembly, &run) {
                        self.try_to_glue(pair, &half);
                    }
                }
            }
        }
    }

    /// Tests if two pieces can be glued at these edges; if so, queues them.
    fn try_to_glue(&mut self, pair: Pair, edges: &[Edge]) -> bool {
        let Some(made) = self.assembly.glue(pair.0, pair.1, edges) else {
            return false;
        };
        let (Some(a), Some(b)) = (&self.assembly.pieces[pair.0], &self.assembly.pieces[pair.1]) else {
            return false;
        };
        let border: f64 = edges.iter().map(|edge| self.assembly.length(*edge)).sum();
        let apart = self.apart(pair);
        if made.sums.paper > apart.paper + self.level.paper_mm * border {
            return false;
        }
        let share = border / a.outline_mm.min(b.outline_mm);
        let more = (made.sums.excess - apart.excess).max(0.0);
        let cost = (more + SEAM * a.sums.area.min(b.sums.area)) / (share + LEAST_SHARE).powi(2);
        let index = self.trials.len();
        self.queue.push(Reverse((cost.to_bits(), index)));
        self.trials_of.resize(self.assembly.pieces.len(), Vec::new());
        self.trials_of[pair.0].push(index);
        self.trials_of[pair.1].push(index);
        self.trials.push(Some(Trial {
            pair,
            edges: edges.to_vec(),
            made,
        }));
        true
    }
}
