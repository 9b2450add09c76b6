//! Measurement of the colours that a printer made, from a photo of a chart; or the reason for refusing the photo.

use image::RgbImage;
use palette::{LinSrgb, Srgb};

use super::find::{FoundChart, find};
use super::layout::{ChartCell, ChartKind, FAMILY};
use super::light::{ChartLight, Surface};
use super::sample::{PatchSample, sample};
use super::{ColourChartError, place};
use scaleproof_core::geometry::extent;
use scaleproof_photo::{Photo, PhotoError};
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::TagDetector;
use scaleproof_surface::pattern::colour::Lab;
use scaleproof_surface::pattern::light::luminance;
use scaleproof_surface::pattern::printed::{ChartSource, PrintedColours};

/// Families that a detector for [`read`] must look for.
pub const FAMILIES: [TagFamily; 1] = [FAMILY];

/// Maximum share of clipped pixels; with more a cell's light is unknown, less is noise.
const MOST_CLIPPED: f64 = 0.02;
/// Minimum of the paper's white in its weakest channel, as 8-bit level. Below, blacks are two or three levels of noise.
const LEAST_WHITE: f64 = 90.0;
/// Maximum deviation of a white from the light's surface; more means a shadow or a reflection.
const MOST_OFF_LIGHT: f64 = 0.08;
/// Maximum light of a patch relative to the paper: no ink is brighter, with some room for noise and fluorescent inks.
const MOST_BRIGHT: f64 = 1.06;
/// Maximum difference in L* between the patches requested black.
const MOST_BLACK_SPREAD: f64 = 6.0;
/// Maximum ΔE2000 between a part of a patch and the whole of it.
const MOST_PATCHY: f64 = 5.0;
/// Maximum mean ΔE2000 between a photo's patches and the mean of all photos.
const MOST_DISAGREEMENT: f64 = 3.0;
/// Minimum share of the colours of sRGB that coloured inks cover; noise on grey covers less.
const LEAST_GAMUT: f64 = 0.01;

#[derive(Debug, Clone, PartialEq)]
pub struct ChartReading {
    pub kind: ChartKind,
    /// SHA-256 of the photo's file.
    pub sha256: String,
    /// Requested 8-bit sRGB, and light relative to the paper's, in the order of the layout.
    pub patches: Vec<([u8; 3], [f64; 3])>,
    pub quality: Quality,
}

type Sampled = (ChartCell, PatchSample);

/// Quality of a photo for reading.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Quality {
    /// Pixels a side of the smallest patch.
    pub patch_px: f64,
    /// Root mean square of the tag corners from a flat sheet, mm.
    pub off_mm: f64,
    /// The surface that is fitted to uneven light and divided out.
    pub light: Surface,
    /// Root mean square of the bare paper from that surface, as a share of the light.
    pub light_error: f64,
    /// Patches with a channel at 0 in a tenth of their pixels or more: the camera could not show how saturated or dark they are.
    pub at_zero: usize,
    /// Unevenness of a patch (ΔE2000 between a part and the whole of it), median over the patches.
    pub patchiness_median: f64,
    /// Unevenness of the least even patch (ΔE2000 between a part and the whole of it).
    pub patchiness_worst: f64,
}

/// Reads the chart in a photo.
pub fn read(photo: &Photo, tags: &mut impl TagDetector) -> Result<Result<ChartReading, ColourChartError>, PhotoError> {
    let (luma, rgb) = (photo.luma()?, photo.rgb(1)?);
    Ok(find(&tags.find(&luma)).and_then(|chart| read_colours(&rgb, &chart, &photo.sha256)))
}

fn read_colours(rgb: &RgbImage, chart: &FoundChart, sha256: &str) -> Result<ChartReading, ColourChartError> {
    let take = |cell: &ChartCell| {
        let sampled = sample(rgb, chart, *cell).ok_or(ColourChartError::NoChart)?;
        Ok((*cell, sampled))
    };
    let layout = &chart.layout;
    let whites: Vec<Sampled> = layout.whites.iter().map(take).collect::<Result<_, _>>()?;
    let inked = layout.patches.iter().map(|patch| take(&patch.cell));
    let inked: Vec<Sampled> = inked.collect::<Result<_, _>>()?;
    refuse_clipped(&whites)?;
    refuse_dark(&whites)?;
    let light = light_on(&whites, chart)?;
    // Checked first: a reflection is clipped as well, and a lower exposure would not help.
    refuse_reflections(&inked, &light)?;
    refuse_clipped(&inked)?;
    let (patchiness_median, patchiness_worst) = evenness(&inked, &light)?;
    let relative = |(cell, sample): &Sampled| over(sample.light, light.at(cell.centre_mm()));
    let asked = layout.patches.iter().map(|patch| patch.asked_rgb);
    let patches: Vec<_> = asked.zip(inked.iter().map(relative)).collect();
    refuse_uneven_black(&patches)?;
    Ok(ChartReading {
        kind: layout.kind,
        sha256: sha256.to_owned(),
        patches,
        quality: Quality {
            patch_px: chart.patch_px,
            off_mm: chart.off_mm,
            light: light.surface,
            light_error: light.error,
            at_zero: inked.iter().filter(|(_, sample)| sample.at_zero >= 0.1).count(),
            patchiness_median,
            patchiness_worst,
        },
    })
}

/// Returns the mean over photos of one print, and each photo's mean ΔE2000 from it.
///
/// # Errors
/// Photos of different charts, that disagree, or without colours.
pub fn average(readings: &[ChartReading], program: &str) -> Result<(PrintedColours, Vec<f64>), ColourChartError> {
    let Some(first) = readings.first() else {
        return Err(ColourChartError::NoChart);
    };
    if let Some(other) = readings.iter().find(|r| r.kind != first.kind) {
        return Err(ColourChartError::MixedCharts {
            first: first.kind.name(),
            other: other.kind.name(),
        });
    }
    let mean = |i: usize| {
        [0, 1, 2].map(|channel| {
            let light = readings.iter().map(|r| r.patches[i].1[channel]);
            light.fold(0.0, |sum, light| sum + light) / readings.len() as f64
        })
    };
    let means: Vec<[f64; 3]> = (0..first.patches.len()).map(mean).collect();
    let disagreement = |reading: &ChartReading| {
        let pairs = reading.patches.iter().zip(&means);
        let off = pairs.map(|((_, own), mean)| Lab::from_linear(*own).delta_e(Lab::from_linear(*mean)));
        off.sum::<f64>() / means.len() as f64
    };
    let disagreements: Vec<f64> = readings.iter().map(disagreement).collect();
    let worst = disagreements.iter().copied().fold(0.0, f64::max);
    if worst > MOST_DISAGREEMENT {
        return Err(ColourChartError::PhotosDisagree { delta_e: worst });
    }
    let asked = first.patches.iter().map(|(asked, _)| *asked);
    let source = ChartSource {
        chart: first.kind.name().to_owned(),
        program: program.to_owned(),
        photos_sha256: readings.iter().map(|r| r.sha256.clone()).collect(),
        levels: first.kind.levels().to_vec(),
    };
    let colours = PrintedColours::from_light(source, asked.zip(means));
    if colours.gamut_share_of_srgb < LEAST_GAMUT {
        return Err(ColourChartError::Colourless);
    }
    Ok((colours, disagreements))
}

fn refuse_clipped(cells: &[Sampled]) -> Result<(), ColourChartError> {
    let clipped = cells.iter().find(|(_, sample)| sample.clipped > MOST_CLIPPED);
    clipped.map_or(Ok(()), |(cell, sample)| {
        Err(ColourChartError::Overexposed {
            place: place(*cell),
            share_percent: 100.0 * sample.clipped,
        })
    })
}

fn refuse_dark(whites: &[Sampled]) -> Result<(), ColourChartError> {
    let lights = whites.iter().flat_map(|(_, sample)| sample.light);
    let weakest = lights.fold(f64::INFINITY, f64::min);
    let level = 255.0 * Srgb::<f64>::from_linear(LinSrgb::new(weakest, weakest, weakest)).red;
    if level < LEAST_WHITE {
        return Err(ColourChartError::TooDark { level });
    }
    Ok(())
}

fn light_on(whites: &[Sampled], chart: &FoundChart) -> Result<ChartLight, ColourChartError> {
    let places = whites.iter().map(|(cell, sample)| (cell.centre_mm(), sample.light));
    let light = ChartLight::fit(&places.collect::<Vec<_>>(), chart.layout.size_mm);
    let light = light.ok_or(ColourChartError::TooDark { level: 0.0 })?;
    let worst = whites.iter().zip(&light.off).max_by(|(_, a), (_, b)| a.total_cmp(b));
    match worst {
        Some(((cell, _), off)) if *off > MOST_OFF_LIGHT => Err(ColourChartError::UnevenLight {
            off_percent: 100.0 * off,
            place: place(*cell),
        }),
        _ => Ok(light),
    }
}

fn refuse_reflections(inked: &[Sampled], light: &ChartLight) -> Result<(), ColourChartError> {
    for (cell, sample) in inked {
        let luminance = luminance(over(sample.light, light.at(cell.centre_mm())));
        if luminance > MOST_BRIGHT {
            return Err(ColourChartError::Reflection {
                place: place(*cell),
                percent: 100.0 * luminance,
            });
        }
    }
    Ok(())
}

/// Returns median and worst patchiness (ΔE2000).
fn evenness(inked: &[Sampled], light: &ChartLight) -> Result<(f64, f64), ColourChartError> {
    let patchiness = |(cell, sample): &Sampled| {
        let white = light.at(cell.centre_mm());
        let whole = Lab::from_linear(over(sample.light, white));
        let off = |part: &[f64; 3]| Lab::from_linear(over(*part, white)).delta_e(whole);
        sample.parts.iter().map(off).fold(0.0, f64::max)
    };
    let mut all: Vec<(f64, ChartCell)> = inked.iter().map(|patch| (patchiness(patch), patch.0)).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let patchy = all.iter().filter(|(own, _)| *own > MOST_PATCHY).count();
    match all.first() {
        Some((_, cell)) if patchy > 0 => Err(ColourChartError::Patchy {
            patches: patchy,
            place: place(*cell),
        }),
        Some((worst, _)) => Ok((all[all.len() / 2].0, *worst)),
        None => Ok((0.0, 0.0)),
    }
}

fn refuse_uneven_black(patches: &[([u8; 3], [f64; 3])]) -> Result<(), ColourChartError> {
    let blacks = patches.iter().filter(|(asked, _)| *asked == [0; 3]);
    let (low, high) = extent(blacks.map(|(_, light)| Lab::from_linear(*light).l));
    if high - low > MOST_BLACK_SPREAD {
        return Err(ColourChartError::UnevenBlack { low, high });
    }
    Ok(())
}

fn over(light: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| light[i] / white[i])
}
