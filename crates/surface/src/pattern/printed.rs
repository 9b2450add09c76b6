//! Colours that a printer makes of the requested ones: measured on a chart, kept in the `[colour]` part of `printer.toml`.
//!
//! Colours are relative to the paper: bare paper is white (L* 100).

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::{Deserialize, Serialize};

use super::colour::Lab;
use super::gamut::{Gamut, combinations};

/// Source of measured colours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChartSource {
    /// Name of the chart.
    pub chart: String,
    /// The program that read it.
    pub program: String,
    pub photos_sha256: Vec<String>,
    /// The chart's levels per channel, ascending from 0 to 255; every combination was measured.
    pub levels: Vec<u8>,
}

/// Reason why a file's colours are not those that this program writes: the end of a sentence about the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ColoursError {
    #[error("the levels of its colour part do not ascend from 0 to 255")]
    Levels,
    #[error("its colour part has a colour that is none")]
    NoColour,
    #[error("its colour part has no patch for {}, {}, {}", asked_rgb[0], asked_rgb[1], asked_rgb[2])]
    NoPatch { asked_rgb: [u8; 3] },
    #[error("the figures of its colour part are not those of its patches")]
    OtherFigures,
}

/// One requested colour, and what came out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrintedColour {
    /// The requested colour, 8-bit sRGB.
    pub asked_rgb: [u8; 3],
    /// Colour that came out, as the nearest 8-bit sRGB.
    pub measured_rgb: [u8; 3],
    /// Colour that came out, as L*, a*, b* (D65, relative to the paper), to 0.01.
    pub measured_lab: [f64; 3],
    /// ΔE2000 between the requested colour and what came out.
    pub delta_e: f64,
}

/// A printer's measured colours; as `[colour]`, the content of a printer file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrintedColours {
    /// The chart that was read: `rgb6`, `rgb5` or `rgb4`.
    pub chart: String,
    /// The program and version that read it.
    pub program: String,
    /// SHA-256 of each photo that it was read from.
    pub photos_sha256: Vec<String>,
    /// 8-bit levels of each channel, ascending from 0 to 255; every combination is among the patches.
    pub levels: Vec<u8>,
    /// Mean over the patches of the ΔE2000 between asked and measured.
    pub delta_e_mean: f64,
    /// Mean ΔE2000 of the greys between the levels from what the levels around them say: how far interpolating is off.
    pub interpolation_delta_e_mean: f64,
    /// Volume in CIELAB of the colours that come out, in cubic units of L*, a*, b*.
    pub gamut_volume_lab: f64,
    /// Volume of the colours that come out, as a share of the volume that sRGB has.
    pub gamut_share_of_srgb: f64,
    /// The darkest colour that came out, 8-bit sRGB.
    pub darkest_rgb: [u8; 3],
    /// The colour with the highest chroma that came out, 8-bit sRGB.
    pub most_saturated_rgb: [u8; 3],
    /// Each requested colour once, ascending.
    pub patches: Vec<PrintedColour>,
}

impl PrintedColour {
    fn new(asked_rgb: [u8; 3], measured: Lab) -> Self {
        // Rounded once, so that a file and what it was written from are the same numbers.
        let lab = Lab {
            l: rounded(measured.l),
            a: rounded(measured.a),
            b: rounded(measured.b),
        };
        Self {
            asked_rgb,
            measured_rgb: lab.rgb(),
            measured_lab: [lab.l, lab.a, lab.b],
            delta_e: rounded(lab.delta_e(Lab::from_rgb(asked_rgb))),
        }
    }

    /// Returns the colour that came out.
    pub fn lab(&self) -> Lab {
        let [l, a, b] = self.measured_lab;
        Lab { l, a, b }
    }
}

impl PrintedColours {
    /// Makes the colours from light relative to the paper's. A colour that was requested several times is averaged. `source.levels` must be those of
    /// a chart, all of whose colours are there.
    pub fn from_light(source: ChartSource, patches: impl Iterator<Item = ([u8; 3], [f64; 3])>) -> Self {
        let mut sums: BTreeMap<[u8; 3], ([f64; 3], f64)> = BTreeMap::new();
        for (asked, light) in patches {
            let (sum, count) = sums.entry(asked).or_default();
            sum.iter_mut().zip(light).for_each(|(sum, v)| *sum += v);
            *count += 1.0;
        }
        let mean =
            |(asked, (sum, count)): ([u8; 3], ([f64; 3], f64))| (asked, Lab::from_linear(sum.map(|v| v / count)));
        Self::from_measured(source, sums.into_iter().map(mean).collect())
    }

    fn from_measured(source: ChartSource, measured: Vec<([u8; 3], Lab)>) -> Self {
        let measured = measured.into_iter();
        let patches: Vec<_> = measured.map(|(asked, lab)| PrintedColour::new(asked, lab)).collect();
        let mean = |values: &[f64]| rounded(values.iter().sum::<f64>() / values.len().max(1) as f64);
        let chroma = |p: &PrintedColour| p.measured_lab[1].hypot(p.measured_lab[2]);
        let lightness = |p: &PrintedColour| p.measured_lab[0];
        let darkest = patches.iter().min_by(|a, b| lightness(a).total_cmp(&lightness(b)));
        let saturated = patches.iter().max_by(|a, b| chroma(a).total_cmp(&chroma(b)));
        let mut colours = Self {
            chart: source.chart,
            program: source.program,
            photos_sha256: source.photos_sha256,
            levels: source.levels,
            delta_e_mean: mean(&patches.iter().map(|p| p.delta_e).collect::<Vec<_>>()),
            interpolation_delta_e_mean: 0.0,
            gamut_volume_lab: 0.0,
            gamut_share_of_srgb: 0.0,
            darkest_rgb: darkest.map(|p| p.measured_rgb).unwrap_or_default(),
            most_saturated_rgb: saturated.map(|p| p.measured_rgb).unwrap_or_default(),
            patches,
        };
        let gamut = colours.gamut();
        let is_between = |p: &&PrintedColour| p.asked_rgb.iter().any(|v| !colours.levels.contains(v));
        let between = colours.patches.iter().filter(is_between);
        let off: Vec<f64> = between.map(|p| gamut.printed(p.asked_rgb).delta_e(p.lab())).collect();
        colours.interpolation_delta_e_mean = mean(&off);
        colours.gamut_volume_lab = gamut.volume().round();
        colours.gamut_share_of_srgb = rounded(gamut.volume() / Gamut::srgb(&colours.levels).volume());
        colours
    }

    fn measured(&self) -> BTreeMap<[u8; 3], Lab> {
        self.patches.iter().map(|p| (p.asked_rgb, p.lab())).collect()
    }

    pub fn gamut(&self) -> Gamut {
        let measured = self.measured();
        // `check` refuses a file with a colour missing, and a chart has all.
        Gamut::new(&self.levels, |asked| {
            measured.get(&asked).copied().unwrap_or(Lab::from_rgb(asked))
        })
    }

    /// Checks that this, from a file, is as the program writes it: every combination of the levels is there, and all figures are those of the
    /// patches.
    ///
    /// # Errors
    /// Says what is wrong, as half a sentence.
    pub fn check(&self) -> Result<(), ColoursError> {
        let ascends = self.levels.windows(2).all(|pair| pair[0] < pair[1]);
        if !ascends || self.levels.first() != Some(&0) || self.levels.last() != Some(&255) {
            return Err(ColoursError::Levels);
        }
        let mut values = self.patches.iter().flat_map(|p| p.measured_lab);
        if !values.all(|v| v.abs() <= 1000.0) {
            return Err(ColoursError::NoColour);
        }
        let measured = self.measured();
        if let Some(asked_rgb) = combinations(&self.levels).find(|rgb| !measured.contains_key(rgb)) {
            return Err(ColoursError::NoPatch { asked_rgb });
        }
        let source = ChartSource {
            chart: self.chart.clone(),
            program: self.program.clone(),
            photos_sha256: self.photos_sha256.clone(),
            levels: self.levels.clone(),
        };
        if Self::from_measured(source, measured.into_iter().collect()) != *self {
            return Err(ColoursError::OtherFigures);
        }
        Ok(())
    }

    /// Returns the `[colour]` part of a printer file, one patch a line.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        #[derive(Serialize)]
        struct Part<'a> {
            colour: &'a PrintedColours,
        }
        let head = Self {
            patches: Vec::new(),
            ..self.clone()
        };
        let head = toml::to_string(&Part { colour: &head })?;
        let mut text = head.replace("patches = []\n", "patches = [\n");
        for p in &self.patches {
            let ([r, g, b], [mr, mg, mb], [l, la, lb]) = (p.asked_rgb, p.measured_rgb, p.measured_lab);
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "  {{ asked_rgb = [{r}, {g}, {b}], measured_rgb = [{mr}, {mg}, {mb}], measured_lab = [{l:?}, {la:?}, {lb:?}], \
                 delta_e = {:?} }},",
                p.delta_e
            );
        }
        text.push_str("]\n");
        Ok(text)
    }
}

/// Rounds to 0.01; no negative zero.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}
