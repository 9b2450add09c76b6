//! `scaleproof attack judge`: patterns on every view of frames, as the surrogate renderer predicts them.

use std::io::Write;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::on_frames::{Looking, pattern_of};
use super::render::{hex, named};
use crate::cli::answer::told;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_attack::judged::{JudgedPattern, NamedCells, judged};
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::{of_pattern, srgb};
use scaleproof_core::spelling::count;
use scaleproof_pose::scene::Classes;
use scaleproof_surface::pattern::Pattern;

/// What detectors make of patterns on every view of frames, predicted and not rendered: a minute's look before `attack evaluate`
#[derive(clap::Args)]
pub(in crate::cli) struct JudgeArgs {
    #[command(flatten)]
    on: Looking,
    /// Patterns and their names: PNG files of one size, square, or with --laying sides six squares below each other
    #[arg(long = "pattern", value_name = "NAME=PNG", num_args = 1.., required = true)]
    patterns: Vec<String>,
    /// What they are compared with: a flat colour as hex sRGB
    #[arg(long, value_name = "HEX", default_value = "808080")]
    normal: String,
}

pub(super) fn run(args: &JudgeArgs, out: &mut dyn Write) -> CommandResult {
    let (columns, tile_mm, patterns) = args.asked()?;
    let on = Looking {
        tile_mm: Some(tile_mm),
        ..args.on.clone()
    };
    let setup = on.open(columns, false, &Eot::NONE)?;
    let views = setup.view_set.views.len();
    let rows =
        progress::frames("looking", views * patterns.len()).during(|bar| judged(&setup, &patterns, || bar.inc(1)))?;
    let judgement = Judgement {
        views,
        tile_mm,
        classes: &args.on.class,
        results: &rows,
    };
    told(args.on.json, &judgement, table(&judgement), out)
}

impl JudgeArgs {
    /// What each pattern is called, where it lies, and the pattern.
    fn loaded(&self) -> Result<Vec<(String, &Path, Pattern)>> {
        let mut loaded = Vec::<(String, &Path, Pattern)>::new();
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

    /// How many cells the patterns have along each side, the width of one repeat of all of them, and their names and cells, the plain colour
    /// first.
    fn asked(&self) -> Result<(u32, f64, Vec<NamedCells>)> {
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
        Ok((columns, tile_mm, patterns))
    }
}

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
    results: &'a [JudgedPattern],
}

fn table(judgement: &Judgement) -> String {
    let longest = |name: fn(&JudgedPattern) -> &str, least: usize| {
        let names = judgement.results.iter().map(|row| name(row).chars().count());
        names.fold(least, usize::max)
    };
    let (detectors, patterns) = (longest(|row| &row.detector, 14), longest(|row| &row.pattern, 20));
    let mut text = format!(
        "predicted, not rendered, on {}, tile {} mm; drop: of the mean confidence, with its 95 % interval over the views\n\
         {:<detectors$} {:<patterns$} {:>7} {:>9} {:>11} {:>18}  drop",
        count(judgement.views, "view"),
        judgement.tile_mm,
        "detector",
        "pattern",
        "AP@0.5",
        "hit rate",
        "confidence",
        "worst direction"
    );
    for row in judgement.results {
        let interval = row
            .drop_95
            .map_or_else(String::new, |[low, high]| format!(" [{low:.2}, {high:.2}]"));
        text += &format!(
            "\n{:<detectors$} {:<patterns$} {:>7.2} {:>9.2} {:>11.2} {:>10.2} at {:>3}°  {:.2}{interval}",
            row.detector,
            row.pattern,
            row.ap50,
            row.hit_rate,
            row.mean_confidence,
            row.worst_direction.mean_confidence,
            row.worst_direction.azimuth_deg,
            row.drop,
        );
    }
    text
}
