//! The colours a printer can make, and how a pattern fares with them.
//!
//! The chart's colours are the nodes of a grid over the cube of 8-bit sRGB. Between them, what comes out is interpolated in CIELAB
//! over six tetrahedra a grid cell (Kasson, Nin, Plouffe & Hafner 1995). The gamut is the image of the whole cube under that
//! map; a convex hull would add colours between the corners that no ink makes.

use super::colour::Lab;

/// A colour is printable when some colour that can be printed is this close (ΔE2000): what reading a chart is good for.
pub const PRINTABLE_DELTA_E: f64 = 2.0;

/// So many grid nodes start the search for the best colour.
const STARTS: usize = 4;

/// The corners of a grid cell that each tetrahedron visits from (0, 0, 0) to (1, 1, 1): the order in which the channels step.
const STEPS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// A printer's map from requested to printed colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Gamut {
    levels: Vec<u8>,
    /// Red slowest, blue fastest.
    nodes: Vec<Lab>,
}

/// The printable colour nearest to a requested one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Best {
    /// 8-bit sRGB to ask the printer for.
    pub ask_rgb: [u8; 3],
    /// What then comes out.
    pub lab: Lab,
    /// ΔE2000 from the requested colour.
    pub delta_e: f64,
}

impl Gamut {
    /// From the colour that each combination of the levels gives. The levels ascend from 0 to 255.
    pub fn new(levels: &[u8], printed: impl Fn([u8; 3]) -> Lab) -> Self {
        let mut nodes = Vec::with_capacity(levels.len().pow(3));
        for r in levels {
            for g in levels {
                nodes.extend(levels.iter().map(|b| printed([*r, *g, *b])));
            }
        }
        Self {
            levels: levels.to_vec(),
            nodes,
        }
    }

    /// A printer that makes every colour of sRGB exactly, interpolated over the same levels.
    pub fn of_srgb(levels: &[u8]) -> Self {
        Self::new(levels, Lab::of)
    }

    /// What comes out when a colour is requested.
    pub fn printed(&self, asked: [u8; 3]) -> Lab {
        self.printed_between(asked.map(f64::from))
    }

    /// What comes out when a colour between those of 8 bits is requested, interpolated; each channel 0 to 255.
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

    /// Volume in CIELAB.
    pub fn volume(&self) -> f64 {
        let n = self.levels.len() - 1;
        let cells = (0..n).flat_map(|r| (0..n).flat_map(move |g| (0..n).map(move |b| [r, g, b])));
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

    /// The input colour whose print comes nearest to a requested one: from the nearest grid nodes downhill, in steps that halve.
    pub fn best(&self, wanted: Lab) -> Best {
        let n = self.levels.len();
        let mut starts: Vec<Best> = (0..self.nodes.len())
            .map(|i| {
                let ask_rgb = [i / (n * n), i / n % n, i % n].map(|level| self.levels[level]);
                self.asking(ask_rgb, wanted)
            })
            .collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    const LEVELS: [u8; 4] = [0, 85, 170, 255];

    /// A printer that keeps `share` of the distance from a middle grey, in CIELAB.
    fn dull(share: f64) -> Gamut {
        Gamut::new(&LEVELS, |asked| {
            let Lab { l, a, b } = Lab::of(asked);
            Lab {
                l: 50.0 + share * (l - 50.0),
                a: share * a,
                b: share * b,
            }
        })
    }

    #[test]
    fn nodes_are_met_and_edges_are_straight() {
        let gamut = Gamut::of_srgb(&LEVELS);
        for asked in [[0, 0, 0], [255, 255, 255], [85, 170, 0], [255, 0, 85]] {
            assert!(gamut.printed(asked).delta_e(Lab::of(asked)) < 1e-9);
        }
        // A third of the way along an edge of the grid.
        let (low, high) = (Lab::of([0, 85, 170]), Lab::of([255, 85, 170]));
        let on_edge = Gamut::new(&[0, 255], |[r, ..]| if r == 0 { low } else { high }).printed([85, 7, 99]);
        assert!((on_edge.l - (2.0 * low.l + high.l) / 3.0).abs() < 1e-9);
    }

    #[test]
    fn a_gamut_shrunk_by_half_has_an_eighth_of_the_volume() {
        let (whole, half) = (Gamut::of_srgb(&LEVELS).volume(), dull(0.5).volume());
        assert!((half / whole - 0.125).abs() < 1e-9, "{half} {whole}");
        // The volume of sRGB in CIELAB is 8.2e5 to 8.3e5 cubic units; four levels a channel miss little of it.
        assert!((whole / 8.25e5 - 1.0).abs() < 0.1, "{whole}");
    }

    /// Against every third colour of the cube.
    #[test]
    fn the_best_colour_is_the_best_of_all() {
        let gamut = dull(0.7);
        for wanted in [
            [255, 0, 0],
            [0, 0, 255],
            [10, 240, 30],
            [120, 90, 200],
            [255, 255, 0],
            [3, 3, 3],
        ] {
            let (wanted, mut least) = (Lab::of(wanted), f64::INFINITY);
            for i in 0..86_u32.pow(3) {
                let asked = [i / 7396, i / 86 % 86, i % 86].map(|v| (3 * v) as u8);
                least = least.min(gamut.printed(asked).delta_e(wanted));
            }
            let best = gamut.best(wanted);
            assert!(best.delta_e <= least + 0.02, "{wanted:?}: {best:?}, {least}");
        }
    }
}
