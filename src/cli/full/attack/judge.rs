//! `scaleproof attack judge`: patterns on every view of frames, as the surrogate renderer predicts them.

use crate::cli::answer::answer;
use scaleproof_pose::scene::Classes;
use schemars::JsonSchema;
use std::error::Error;
use std::io::Write;
use std::path::Path;

use nalgebra::Point3;
use serde::Serialize;

use super::on_frames::{Looking, pattern_of};
use super::render::{hex, named};
use crate::cli::{CommandResult, Outcome, progress};
use scaleproof_attack::run::augmentation::{Augmentation, Eot};
use scaleproof_attack::run::judge::{SeenByDetector, look};
use scaleproof_attack::run::{Rgb, of_pattern, srgb};
use scaleproof_attack::setup::Setup;
use scaleproof_core::spelling::count;
use scaleproof_core::statistics::intervals_95;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_surface::pattern::Pattern;

/// What detectors make of patterns on every view of frames, predicted and not rendered: a minute's look before `attack evaluate`
#[derive(clap::Args)]
pub(super) struct JudgeArgs {
    #[command(flatten)]
    on: Looking,
    /// Patterns and their names: PNG files of one size, square, or with --laying sides six squares below each other
    #[arg(long = "pattern", value_name = "NAME=PNG", num_args = 1.., required = true)]
    patterns: Vec<String>,
    /// What they are compared with: a flat colour as hex sRGB
    #[arg(long, value_name = "HEX", default_value = "808080")]
    normal: String,
}

/// What a pattern is called, and its cells.
type NamedCells = (String, Vec<Rgb>);

/// What a pattern is called, where it lies, and the pattern.
type Loaded<'a> = (String, &'a Path, Pattern);

/// What is to be judged.
struct Asked {
    /// How many cells the patterns have along each side.
    columns: u32,
    /// Width of one repeat of all of them.
    tile_mm: f64,
    /// The plain colour first.
    patterns: Vec<NamedCells>,
}

/// A pattern seen by each detector.
struct Judged {
    name: String,
    seen: Vec<SeenByDetector>,
}

pub(super) fn run(args: &JudgeArgs, out: &mut dyn Write) -> CommandResult {
    let Asked {
        columns,
        tile_mm,
        patterns,
    } = args.asked()?;
    let on = Looking {
        tile_mm: Some(tile_mm),
        ..args.on.clone()
    };
    let setup = on.open(columns, false, &Eot::NONE)?;
    let views: Vec<usize> = (0..setup.view_set.views.len()).collect();
    let bar = progress::frames("looking", views.len() * patterns.len());
    let look = |(name, cells): NamedCells| {
        let seen = look(&setup.view_set, &setup.detectors, &views, |view| {
            bar.inc(1);
            Ok(setup
                .view_set
                .textured(view, &cells, &Augmentation::NONE)
                .augmented
                .image)
        })?;
        Ok(Judged { name, seen })
    };
    let judged = patterns
        .into_iter()
        .map(look)
        .collect::<Result<Vec<_>, Box<dyn Error>>>();
    bar.finish_and_clear();
    let judged = judged?;
    let rows = rows(&setup, &judged);
    if args.on.json {
        let judgement = Judgement {
            views: views.len(),
            tile_mm,
            classes: &args.on.class,
            results: rows,
        };
        answer(&judgement, out)?;
        return Ok(Outcome::Done);
    }
    table(&setup, &rows, out)?;
    Ok(Outcome::Done)
}

impl JudgeArgs {
    fn loaded(&self) -> Result<Vec<Loaded<'_>>, Box<dyn Error>> {
        let mut loaded = Vec::<Loaded>::new();
        for text in &self.patterns {
            let (name, path) = named(text);
            if name.is_empty() || name.chars().any(char::is_control) {
                return Err(
                    format!("the name of {path:?} is {name:?}: give one that can be read, as in NAME=FILE").into(),
                );
            }
            if name == self.normal || loaded.iter().any(|(other, _, _)| *other == name) {
                return Err(
                    format!("`{name}` is named twice: give each pattern a name of its own, as in NAME=FILE").into(),
                );
            }
            loaded.push((name, path, pattern_of(path)?));
        }
        Ok(loaded)
    }

    fn asked(&self) -> Result<Asked, Box<dyn Error>> {
        let loaded = self.loaded()?;
        let files: Vec<(&Path, &Pattern)> = loaded.iter().map(|(_, path, pattern)| (*path, pattern)).collect();
        let tile_mm = self.on.tile_mm_of(&files)?;
        let columns = loaded.first().map_or(1, |(_, _, pattern)| pattern.columns());
        let grid = self.on.mapping.grid(columns);
        let normal = vec![hex(&self.normal)?; columns as usize * grid[1] as usize];
        let mut patterns = vec![(self.normal.clone(), srgb(&normal))];
        for (name, path, pattern) in loaded {
            let size = [pattern.columns(), pattern.rows()];
            if size != grid {
                return Err(format!(
                    "{} has {}×{} cells, where {}×{} are needed with --laying {}: give patterns of one size",
                    path.display(),
                    size[0],
                    size[1],
                    grid[0],
                    grid[1],
                    self.on.mapping.name()
                )
                .into());
            }
            patterns.push((name, of_pattern(&pattern)));
        }
        Ok(Asked {
            columns,
            tile_mm,
            patterns,
        })
    }
}

/// The views by the direction they are seen from.
struct Sectors(Vec<usize>);

/// So many around the model, the first about the front.
const SECTORS: usize = 8;

impl Sectors {
    fn of(setup: &Setup) -> Self {
        let step = 360.0 / SECTORS as f64;
        let sector = |azimuth_deg: f64| (azimuth_deg / step).round().rem_euclid(SECTORS as f64) as usize;
        let views = setup.view_set.views.iter();
        Self(
            views
                .map(|view| {
                    let camera_mm = view.frame.pose().inverse() * Point3::origin();
                    sector(Viewpoint::from_camera(camera_mm, Point3::origin()).azimuth_deg)
                })
                .collect(),
        )
    }

    /// The sector in which the model is seen best: its middle in degrees and the mean confidence.
    fn worst(&self, confidences: &[f64]) -> (f64, f64) {
        let mean = |sector: usize| {
            let inside = self.0.iter().zip(confidences).filter(|(s, _)| **s == sector);
            let (sum, n) = inside.fold((0.0, 0), |(sum, n), (_, c)| (sum + c, n + 1));
            (n > 0).then(|| sum / f64::from(n))
        };
        let means = (0..SECTORS).filter_map(|sector| Some((sector as f64 * 360.0 / SECTORS as f64, mean(sector)?)));
        means.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
    }
}

/// How much less confident a detector is than of the plain model, view by view, and its 95 % interval over the views.
fn drop(plain: &SeenByDetector, seen: &SeenByDetector) -> (f64, Option<[f64; 2]>) {
    let differences: Vec<f64> = plain
        .confidences
        .iter()
        .zip(&seen.confidences)
        .map(|(a, b)| a - b)
        .collect();
    let mean = |weights: &[u32]| {
        let weighted = differences.iter().zip(weights).map(|(d, w)| d * f64::from(*w));
        weighted.sum::<f64>() / f64::from(weights.iter().sum::<u32>().max(1))
    };
    let all = mean(&vec![1; differences.len()]);
    let [interval] = intervals_95(differences.len(), |weights| [mean(weights)]);
    (all, interval.map(|interval| [interval.low, interval.high]))
}

/// A pattern and a detector.
/// `attack judge --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Judgement<'a> {
    /// How many were looked at.
    views: usize,
    /// The width of one repeat of all patterns.
    tile_mm: f64,
    /// The labels that count as the model.
    classes: &'a Classes,
    /// Detector by detector, the plain model first.
    results: Vec<Row<'a>>,
}

/// A pattern as a detector sees it.
#[derive(Serialize, JsonSchema)]
struct Row<'a> {
    detector: &'a str,
    pattern: &'a str,
    /// Over all views, as predicted, like the next two.
    ap50: f64,
    hit_rate: f64,
    mean_confidence: f64,
    worst_direction: WorstDirection,
    /// By how much the confidence is below that of the plain model in the same views, in the mean.
    drop: f64,
    /// Its 95 % interval over the views.
    drop_95: Option<[f64; 2]>,
}

/// Of eight directions around the model, the one in which it is seen best.
#[derive(Serialize, JsonSchema)]
struct WorstDirection {
    /// Its middle.
    azimuth_deg: f64,
    mean_confidence: f64,
}

/// Detector by detector, the plain model first.
fn rows<'a>(setup: &'a Setup, judged: &'a [Judged]) -> Vec<Row<'a>> {
    let sectors = Sectors::of(setup);
    let mut rows = Vec::new();
    for (d, detector) in setup.detectors.iter().enumerate() {
        for pattern in judged {
            let seen = &pattern.seen[d];
            let (azimuth_deg, mean_confidence) = sectors.worst(&seen.confidences);
            let (drop, drop_95) = drop(&judged[0].seen[d], seen);
            rows.push(Row {
                detector: detector.name(),
                pattern: &pattern.name,
                ap50: seen.ap50(),
                hit_rate: seen.hit_rate(),
                mean_confidence: seen.mean_confidence(),
                worst_direction: WorstDirection {
                    azimuth_deg,
                    mean_confidence,
                },
                drop,
                drop_95,
            });
        }
    }
    rows
}

fn table(setup: &Setup, rows: &[Row], out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "predicted, not rendered, on {}, tile {} mm; drop: of the mean confidence, with its 95 % interval over the views",
        count(setup.view_set.views.len(), "view"),
        setup.tile_mm
    )?;
    writeln!(
        out,
        "{:<14} {:<20} {:>7} {:>9} {:>11} {:>18}  drop",
        "detector", "pattern", "AP@0.5", "hit rate", "confidence", "worst direction"
    )?;
    for row in rows {
        let interval = row
            .drop_95
            .map_or_else(String::new, |[low, high]| format!(" [{low:.2}, {high:.2}]"));
        writeln!(
            out,
            "{:<14} {:<20} {:>7.2} {:>9.2} {:>11.2} {:>10.2} at {:>3}°  {:.2}{interval}",
            row.detector,
            row.pattern,
            row.ap50,
            row.hit_rate,
            row.mean_confidence,
            row.worst_direction.mean_confidence,
            row.worst_direction.azimuth_deg,
            row.drop,
        )?;
    }
    Ok(())
}
