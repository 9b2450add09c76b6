//! Paints: the palette file, and the reduction of a pattern to a few of them.

use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use serde::Deserialize;

use super::Pattern;
use super::colour::Lab;
use super::light;
use scaleproof_core::files;

/// Largest number of paints that a pattern is reduced to: each is a set of stencils.
pub const MAX_PAINTS: usize = 24;
/// Largest number of paints in a palette file.
pub const MAX_PALETTE: usize = 256;

/// Least and largest number of starts of k-means, of which the tightest result is kept: many on few colours, where that takes no time.
const RESTARTS: (usize, usize) = (4, 200);
/// Number of distances of one step, over all starts, that take no time.
const CHEAP: usize = 2_000_000;
/// Largest number of Lloyd's steps of one start; on a few hundred colours it settles long before.
const MOST_STEPS: usize = 100;

/// Reason why a pattern was not reduced to paints. Each variant says what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PaletteError {
    #[error("{path} cannot be used ({reason}); a palette is a TOML file of [[paint]] tables with name = \"…\" and rgb = [r, g, b]", path = path.display())]
    BadFile { path: PathBuf, reason: String },
    #[error("{asked} paint{} cannot be made; ask for 2 to {MAX_PAINTS}", if *asked == 1 { "" } else { "s" })]
    BadCount { asked: i64 },
    #[error("the pattern has {distinct} colour{}, fewer than the {asked} requested paints; ask for {}", if *distinct == 1 { "" } else { "s" },
        if *distinct < 2 { "no paints: one colour needs no stencil".to_owned() } else if *distinct == 2 { "2".to_owned() } else { format!("2 to {distinct}") })]
    FewerColours { asked: usize, distinct: usize },
    #[error("the pattern's colours are too alike for {asked} paints: two of them would be {hex}; ask for fewer")]
    Alike { asked: usize, hex: String },
    #[error(
        "every colour of the pattern is nearest to the paint '{name}', so nothing of the pattern would be left; offer other paints"
    )]
    OnePaint { name: String },
    #[error(
        "the pattern takes {used} of the palette's paints, more than the {MAX_PAINTS} that can be stencilled; offer fewer"
    )]
    TooManyUsed { used: usize },
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Paint {
    pub name: String,
    /// 8-bit sRGB.
    pub rgb: [u8; 3],
}

impl Paint {
    /// Returns the colour as `#rrggbb`.
    pub fn hex(&self) -> String {
        hex(self.rgb)
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Palette {
    paints: Vec<Paint>,
}

/// The file: `[[paint]]` tables. Signed and wide, so that a value out of range is a sentence about it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PaletteFile {
    #[serde(default)]
    paint: Vec<PaintEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PaintEntry {
    name: String,
    rgb: [i64; 3],
}

impl Palette {
    /// Reads a palette file.
    pub fn load(path: &Path) -> Result<Self, PaletteError> {
        let bad = |reason: String| PaletteError::BadFile {
            path: path.to_owned(),
            reason,
        };
        let text = files::read_text(path).map_err(|e| bad(e.to_string()))?;
        // The message of the parser may have several lines; the sentence has one.
        let file: PaletteFile = toml::from_str(&text).map_err(|e| bad(e.message().replace('\n', " ")))?;
        Self::checked(file.paint).map_err(bad)
    }

    fn checked(entries: Vec<PaintEntry>) -> Result<Self, String> {
        if !(2..=MAX_PALETTE).contains(&entries.len()) {
            return Err(format!(
                "a palette has 2 to {MAX_PALETTE} paints, this one {}",
                entries.len()
            ));
        }
        let mut paints: Vec<Paint> = Vec::new();
        for PaintEntry { name, rgb } in entries {
            if name.trim().is_empty() {
                return Err(format!("paint {} has no name", paints.len() + 1));
            }
            let [Ok(r), Ok(g), Ok(b)] = rgb.map(u8::try_from) else {
                return Err(format!(
                    "paint '{name}' has rgb {rgb:?}, whose channels must be 0 to 255"
                ));
            };
            let paint = Paint { name, rgb: [r, g, b] };
            let name = &paint.name;
            if paints.iter().any(|other| other.name == *name) {
                return Err(format!("two paints are called '{name}'"));
            }
            if let Some(other) = paints.iter().find(|other| other.rgb == paint.rgb) {
                return Err(format!("the paints '{}' and '{name}' have one colour", other.name));
            }
            paints.push(paint);
        }
        Ok(Self { paints })
    }

    pub fn paints(&self) -> &[Paint] {
        &self.paints
    }
}

/// A paint in use: its cells, and its distance from the colours it stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct UsedPaint {
    pub paint: Paint,
    pub cells: u32,
    /// CIEDE2000 of the paint against the pattern's colours: mean over its cells, and the largest.
    pub mean_delta_e: f64,
    pub max_delta_e: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Painted {
    /// Paints, most cells first, unless they were put in another order.
    pub paints: Vec<UsedPaint>,
    columns: u32,
    /// Index into `paints` of each cell, row by row from the top left.
    cells: Vec<usize>,
}

impl Painted {
    /// Reduces a pattern to `count` paints: k-means over its cells in CIELAB (Lloyd 1982), the best of some starts by k-means++
    /// (Arthur & Vassilvitskii 2007) from fixed seeds. The paints are the clusters' means, rounded to 8-bit sRGB.
    pub fn by_count(pattern: &Pattern, count: usize) -> Result<Self, PaletteError> {
        let bad_count = || PaletteError::BadCount {
            asked: i64::try_from(count).unwrap_or(i64::MAX),
        };
        if !(2..=MAX_PAINTS).contains(&count) {
            return Err(bad_count());
        }
        let colours = Colours::new(pattern);
        let distinct = colours.rgb.len();
        if count > distinct {
            return Err(PaletteError::FewerColours { asked: count, distinct });
        }
        let restarts = (CHEAP / (distinct * count)).clamp(RESTARTS.0, RESTARTS.1);
        let best = (0..restarts as u64)
            .map(|seed| k_means(&colours, count, seed))
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let (means, of, _) = best.ok_or_else(bad_count)?;
        let paints: Vec<[u8; 3]> = means.iter().map(|mean| mean.rgb()).collect();
        for (i, rgb) in paints.iter().enumerate() {
            if paints[..i].contains(rgb) {
                return Err(PaletteError::Alike {
                    asked: count,
                    hex: hex(*rgb),
                });
            }
        }
        let named = paints.into_iter().map(|rgb| Paint { name: hex(rgb), rgb });
        Ok(Self::assembled(pattern, &colours, &named.collect::<Vec<_>>(), &of))
    }

    /// Gives every cell the paint of the palette that is nearest by CIEDE2000, the earlier of two that are equally near. Paints that
    /// no cell takes are left out.
    pub fn by_palette(pattern: &Pattern, palette: &Palette) -> Result<Self, PaletteError> {
        let colours = Colours::new(pattern);
        let labs: Vec<Lab> = palette.paints.iter().map(|paint| Lab::from_rgb(paint.rgb)).collect();
        let all = colours.lab.iter();
        let of: Vec<usize> = all.map(|lab| nearest(&labs, |paint| lab.delta_e(*paint))).collect();
        let made = Self::assembled(pattern, &colours, &palette.paints, &of);
        match &made.paints[..] {
            [only] => Err(PaletteError::OnePaint {
                name: only.paint.name.clone(),
            }),
            used if used.len() > MAX_PAINTS => Err(PaletteError::TooManyUsed { used: used.len() }),
            _ => Ok(made),
        }
    }

    /// Puts a painted pattern together; `of`: the paint of each distinct colour.
    fn assembled(pattern: &Pattern, colours: &Colours, paints: &[Paint], of: &[usize]) -> Self {
        let mut used: Vec<(usize, UsedPaint)> = Vec::new();
        for (index, paint) in paints.iter().enumerate() {
            let lab = Lab::from_rgb(paint.rgb);
            let mine = (0..of.len()).filter(|c| of[*c] == index);
            let off: Vec<(u32, f64)> = mine.map(|c| (colours.cells[c], lab.delta_e(colours.lab[c]))).collect();
            let cells: u32 = off.iter().map(|(cells, _)| cells).sum();
            if cells > 0 {
                let total: f64 = off.iter().map(|(cells, off)| f64::from(*cells) * off).sum();
                let used_paint = UsedPaint {
                    paint: paint.clone(),
                    cells,
                    mean_delta_e: total / f64::from(cells),
                    max_delta_e: off.iter().map(|(_, off)| *off).fold(0.0, f64::max),
                };
                used.push((index, used_paint));
            }
        }
        used.sort_by_key(|(index, paint)| (std::cmp::Reverse(paint.cells), *index));
        let place = |index: usize| used.iter().position(|(i, _)| *i == index).unwrap_or_default();
        let cells = pattern
            .cells()
            .pixels()
            .map(|pixel| place(of[colours.index(pixel.0)]))
            .collect();
        Self {
            cells,
            columns: pattern.columns(),
            paints: used.into_iter().map(|(_, paint)| paint).collect(),
        }
    }

    /// Returns the paint of each cell, 8-bit sRGB, row by row from the top left.
    pub fn rgb(&self) -> Vec<[u8; 3]> {
        self.cells.iter().map(|cell| self.paints[*cell].paint.rgb).collect()
    }

    /// Returns the index into [`Self::paints`] of a cell of the repeated pattern; columns and rows go on for ever.
    pub fn paint_at(&self, column: usize, row: usize) -> usize {
        let columns = self.columns as usize;
        let rows = self.cells.len() / columns;
        self.cells[(row % rows) * columns + column % columns]
    }

    /// Returns the painted pattern with its paints in another order, given as their indices, each once.
    pub fn in_order(&self, order: &[usize]) -> Self {
        let place = |paint: &usize| order.iter().position(|i| i == paint).unwrap_or_default();
        Self {
            paints: order.iter().filter_map(|i| self.paints.get(*i).cloned()).collect(),
            columns: self.columns,
            cells: self.cells.iter().map(place).collect(),
        }
    }

    /// Returns CIEDE2000 of the cells against their paints: mean and largest.
    pub fn delta_e(&self) -> (f64, f64) {
        let total: f64 = self.paints.iter().map(|p| f64::from(p.cells) * p.mean_delta_e).sum();
        let largest = self.paints.iter().map(|p| p.max_delta_e).fold(0.0, f64::max);
        (total / self.cells.len() as f64, largest)
    }
}

/// The distinct colours of a pattern, in order of their channels.
struct Colours {
    rgb: Vec<[u8; 3]>,
    lab: Vec<Lab>,
    cells: Vec<u32>,
}

impl Colours {
    fn new(pattern: &Pattern) -> Self {
        let counts = pattern.colour_counts();
        Self {
            lab: counts.keys().map(|rgb| Lab::from_rgb(*rgb)).collect(),
            cells: counts.values().map(|cells| *cells as u32).collect(),
            rgb: counts.into_keys().collect(),
        }
    }

    fn index(&self, rgb: [u8; 3]) -> usize {
        self.rgb.binary_search(&rgb).unwrap_or_default()
    }
}

/// Returns the means of the clusters, the cluster of each distinct colour, and the sum over the cells of their squared distance from the mean.
fn k_means(colours: &Colours, count: usize, seed: u64) -> (Vec<Lab>, Vec<usize>, f64) {
    let mut means = spread_out(colours, count, seed);
    let mut of = Vec::new();
    for _ in 0..MOST_STEPS {
        let labs = colours.lab.iter();
        let now: Vec<usize> = labs.map(|lab| nearest(&means, |mean| squared(lab, mean))).collect();
        if now == of {
            break;
        }
        of = now;
        for (cluster, mean) in means.iter_mut().enumerate() {
            // A cluster that lost its last colour stays where it is.
            *mean = mean_of(colours, &of, cluster).unwrap_or(*mean);
        }
    }
    let spread = |c: usize| f64::from(colours.cells[c]) * squared(&colours.lab[c], &means[of[c]]);
    let spread = (0..of.len()).map(spread).sum();
    (means, of, spread)
}

/// Draws starts by k-means++: every next one among the colours, by cells times squared distance from the starts so far.
fn spread_out(colours: &Colours, count: usize, seed: u64) -> Vec<Lab> {
    let mut random = Pcg32::seed_from_u64(seed);
    let mut starts: Vec<Lab> = Vec::new();
    while starts.len() < count {
        let far = |lab: &Lab| starts.iter().map(|start| squared(lab, start)).fold(1e9, f64::min);
        let weighted = colours.lab.iter().zip(&colours.cells);
        let weights: Vec<f64> = weighted.map(|(lab, cells)| f64::from(*cells) * far(lab)).collect();
        let mut left = random.random::<f64>() * weights.iter().sum::<f64>();
        let drawn = weights.iter().position(|weight| {
            left -= weight;
            *weight > 0.0 && left < 0.0
        });
        // Rounding may leave a rest behind the last colour; the farthest one is as good.
        let farthest = || {
            (0..weights.len())
                .max_by(|a, b| weights[*a].total_cmp(&weights[*b]))
                .unwrap_or_default()
        };
        starts.push(colours.lab[drawn.unwrap_or_else(farthest)]);
    }
    starts
}

fn mean_of(colours: &Colours, of: &[usize], cluster: usize) -> Option<Lab> {
    let (mut sum, mut weight) = ([0.0; 3], 0.0);
    for (c, lab) in colours.lab.iter().enumerate().filter(|(c, _)| of[*c] == cluster) {
        let cells = f64::from(colours.cells[c]);
        weight += cells;
        for (sum, channel) in sum.iter_mut().zip([lab.l, lab.a, lab.b]) {
            *sum += cells * channel;
        }
    }
    let [l, a, b] = sum.map(|channel| channel / weight);
    (weight > 0.0).then_some(Lab { l, a, b })
}

fn squared(a: &Lab, b: &Lab) -> f64 {
    (a.l - b.l).powi(2) + (a.a - b.a).powi(2) + (a.b - b.b).powi(2)
}

/// Returns the index of the candidate with the smallest distance, the first of equals.
fn nearest(candidates: &[Lab], distance: impl Fn(&Lab) -> f64) -> usize {
    let distances = candidates.iter().map(distance).enumerate();
    let nearest = distances.min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map_or(0, |(i, _)| i)
}

fn hex(rgb: [u8; 3]) -> String {
    format!("#{}", light::to_hex(rgb))
}
