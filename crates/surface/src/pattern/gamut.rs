//! Colours that a printer can make.
//!
//! The chart's colours are the nodes of a grid over the cube of 8-bit sRGB. Between them, what comes out is interpolated in CIELAB
//! over six tetrahedra a grid cell (Kasson, Nin, Plouffe & Hafner 1995). The gamut is the image of the whole cube under that
//! map; a convex hull would add colours between the corners that no ink makes.

use super::colour::Lab;

/// Largest ΔE2000 between a printable colour and some colour that can be printed: as accurate as reading a chart is.
pub const PRINTABLE_DELTA_E: f64 = 2.0;

/// Number of grid nodes that start the search for the best colour.
const STARTS: usize = 4;

/// The corners of a grid cell that each tetrahedron visits from (0, 0, 0) to (1, 1, 1): the order in which the channels step.
const STEPS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

#[derive(Debug, Clone, PartialEq)]
pub struct Gamut {
    levels: Vec<u8>,
    /// Colours of the grid's nodes: red slowest, blue fastest.
    nodes: Vec<Lab>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Best {
    /// 8-bit sRGB to ask the printer for.
    pub ask_rgb: [u8; 3],
    /// Colour that then comes out.
    pub lab: Lab,
    /// ΔE2000 from the requested colour.
    pub delta_e: f64,
}

/// Returns the places of a cube of `n` along each side; the first coordinate runs slowest, the last fastest.
fn cube(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..n.pow(3)).map(move |i| [i / (n * n), i / n % n, i % n])
}

/// Returns every colour whose channels have some of these levels: red runs slowest, blue fastest.
pub(super) fn combinations(levels: &[u8]) -> impl Iterator<Item = [u8; 3]> {
    cube(levels.len()).map(|at| at.map(|level| levels[level]))
}

impl Gamut {
    /// Makes a gamut of the colour that each combination of the levels gives. The levels ascend from 0 to 255.
    pub fn new(levels: &[u8], printed: impl Fn([u8; 3]) -> Lab) -> Self {
        Self {
            levels: levels.to_vec(),
            nodes: combinations(levels).map(printed).collect(),
        }
    }

    /// Makes the gamut of a printer that makes every colour of sRGB exactly, interpolated over the same levels.
    pub fn srgb(levels: &[u8]) -> Self {
        Self::new(levels, Lab::from_rgb)
    }

    /// Returns the colour that comes out when a colour is requested.
    pub fn printed(&self, asked: [u8; 3]) -> Lab {
        self.printed_between(asked.map(f64::from))
    }

    /// Returns the colour that comes out when a colour between those of 8 bits is requested, interpolated; each channel 0 to 255.
    pub fn printed_between(&self, asked: [f64; 3]) -> Lab {
        let mut corner = [0; 3];
        let mut share = [0.0; 3];
        for channel in 0..3 {
            let above = self.levels.partition_point(|level| f64::from(*level) <= asked[channel]);
            corner[channel] = above.clamp(1, self.levels.len() - 1) - 1;
            let [low, high] = [0, 1].map(|next| f64::from(self.levels[corner[channel] + next]));
            share[channel] = (asked[channel] - low) / (high - low);
        }
        let mut steps = [0, 1, 2];
        steps.sort_by(|a, b| share[*b].total_cmp(&share[*a]));
        let [first, second, third] = steps.map(|channel| share[channel]);
        let weights = [1.0 - first, first - second, second - third, third];
        let terms = weights.into_iter().zip(self.tetrahedron(corner, steps));
        terms.fold(Lab { l: 0.0, a: 0.0, b: 0.0 }, |sum, (w, at)| Lab {
            l: sum.l + w * at.l,
            a: sum.a + w * at.a,
            b: sum.b + w * at.b,
        })
    }

    pub fn volume(&self) -> f64 {
        let cells = cube(self.levels.len() - 1);
        let tetrahedra = cells.flat_map(|corner| STEPS.map(|steps| (corner, steps)));
        // Signed, so that a fold that noise makes does not count twice.
        let signed = tetrahedra.map(|(corner, steps)| {
            let [o, p, q, s] = self.tetrahedron(corner, steps);
            let [p, q, s] = [p, q, s].map(|v| nalgebra::Vector3::new(v.l - o.l, v.a - o.a, v.b - o.b));
            let is_even = matches!(steps, [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
            p.cross(&q).dot(&s) / if is_even { 6.0 } else { -6.0 }
        });
        signed.sum::<f64>().abs()
    }

    /// Finds the input colour whose print comes nearest to a requested one: from the nearest grid nodes downhill, in steps that halve.
    pub fn best(&self, wanted: Lab) -> Best {
        let all = combinations(&self.levels);
        let mut starts: Vec<Best> = all.map(|ask_rgb| self.asking(ask_rgb, wanted)).collect();
        starts.sort_by(|a, b| a.delta_e.total_cmp(&b.delta_e));
        starts.truncate(STARTS);
        let downhill = starts.into_iter().map(|start| self.downhill(start, wanted));
        // There is always a start; the fallback spares an unwrap.
        let best = downhill.min_by(|a, b| a.delta_e.total_cmp(&b.delta_e));
        best.unwrap_or_else(|| self.asking([0; 3], wanted))
    }

    fn downhill(&self, mut best: Best, wanted: Lab) -> Best {
        let mut step = 32_i16;
        while step > 0 {
            let around = (0..27).map(|i| [i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1]);
            let asks = around.map(|turn: [i16; 3]| {
                [0, 1, 2].map(|c| (i16::from(best.ask_rgb[c]) + step * turn[c]).clamp(0, 255) as u8)
            });
            let tried = asks.map(|ask| self.asking(ask, wanted));
            match tried.min_by(|a, b| a.delta_e.total_cmp(&b.delta_e)) {
                Some(better) if better.delta_e < best.delta_e => best = better,
                _ => step /= 2,
            }
        }
        best
    }

    fn asking(&self, ask_rgb: [u8; 3], wanted: Lab) -> Best {
        let lab = self.printed(ask_rgb);
        Best {
            ask_rgb,
            lab,
            delta_e: lab.delta_e(wanted),
        }
    }

    fn tetrahedron(&self, corner: [usize; 3], steps: [usize; 3]) -> [Lab; 4] {
        let n = self.levels.len();
        let mut at = corner;
        let node = |[r, g, b]: [usize; 3]| self.nodes[(r * n + g) * n + b];
        let mut corners = [node(at); 4];
        for (i, channel) in steps.into_iter().enumerate() {
            at[channel] += 1;
            corners[i + 1] = node(at);
        }
        corners
    }
}
