//! `scaleproof attack judge`: patterns on every view of frames, as the surrogate renderer predicts them.

use std::collections::BTreeMap;
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
    let (columns, normal, by_tile) = args.asked()?;
    let (mut views, mut rows) = (0, Vec::<JudgedPattern>::new());
    // A pattern lies on the views as its width says, so each width has views of its own.
    for (tile_mm, patterns) in &by_tile {
        let on = Looking {
            tile_mm: Some(*tile_mm),
            ..args.on.clone()
        };
        let setup = on.open(columns, false, &Eot::NONE)?;
        views = setup.view_set.views.len();
        let patterns: Vec<NamedCells> = std::iter::once(&normal).chain(patterns).cloned().collect();
        let judged = progress::frames("looking", views * patterns.len())
            .during(|bar| judged(&setup, &patterns, || bar.inc(1)))?;
        // The plain model is the same in all of them.
        let new = judged
            .into_iter()
            .filter(|row| row.pattern != normal.0 || rows.iter().all(|r| r.detector != row.detector));
        let new: Vec<JudgedPattern> = new.collect();
        rows.extend(new);
    }
    let order = |name: &str| {
        args.patterns
            .iter()
            .position(|text| named(text).0 == name)
            .map_or(0, |at| at + 1)
    };
    let detectors: Vec<String> = rows.iter().map(|row| row.detector.clone()).collect();
    rows.sort_by_key(|row| {
        (
            detectors.iter().position(|name| *name == row.detector),
            order(&row.pattern),
        )
    });
    let tile_of = |(tile_mm, patterns): &(f64, Vec<NamedCells>)| -> Vec<(String, f64)> {
        patterns.iter().map(|(name, _)| (name.clone(), *tile_mm)).collect()
    };
    let judgement = Judgement {
        views,
        tile_mm: by_tile.iter().flat_map(tile_of).collect(),
        classes: &args.on.class,
        results: &rows,
    };
    told(args.on.json, &judgement, table(&judgement), out)
}

/// Patterns by the width of one repeat, mm.
type ByTile = Vec<(f64, Vec<NamedCells>)>;

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

    /// How many cells the patterns have along each side, the plain colour, and the patterns by the width of one repeat: as asked for, else as their
    /// cards say; those without a card are repeated as the first with one.
    fn asked(&self) -> Result<(u32, NamedCells, ByTile)> {
        let loaded = self.loaded()?;
        let own = loaded
            .iter()
            .map(|(_, path, pattern)| self.on.own_tile_mm(path, pattern));
        let own: Vec<Option<f64>> = own.collect::<Result<_, _>>()?;
        let usual = own.iter().copied().flatten().next().unwrap_or(self.on.tile_mm());
        let columns = loaded.first().map_or(1, |(_, _, pattern)| pattern.columns());
        let grid = self.on.mapping.grid(columns);
        let normal = vec![hex(&self.normal)?; columns as usize * grid[1] as usize];
        let mut by_tile = ByTile::new();
        for ((name, path, pattern), own) in loaded.into_iter().zip(own) {
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
            let tile_mm = own.unwrap_or(usual);
            let pattern = (name, of_pattern(&pattern));
            match by_tile.iter_mut().find(|(known, _)| *known == tile_mm) {
                Some((_, patterns)) => patterns.push(pattern),
                None => by_tile.push((tile_mm, vec![pattern])),
            }
        }
        Ok((columns, (self.normal.clone(), srgb(&normal)), by_tile))
    }
}

/// `attack judge --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Judgement<'a> {
    /// How many were looked at.
    views: usize,
    /// The width of one repeat of each pattern, by its name.
    tile_mm: BTreeMap<String, f64>,
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
    let mut tiles: Vec<String> = judgement.tile_mm.values().map(f64::to_string).collect();
    tiles.sort();
    tiles.dedup();
    let tiles = match &tiles[..] {
        [one] => one.clone(),
        _ => judgement
            .tile_mm
            .iter()
            .map(|(name, mm)| format!("{mm} ({name})"))
            .collect::<Vec<_>>()
            .join(", "),
    };
    let (detectors, patterns) = (longest(|row| &row.detector, 14), longest(|row| &row.pattern, 20));
    let mut text = format!(
        "predicted, not rendered, on {}, tile {tiles} mm; drop: of the mean confidence, with its 95 % interval over the views\n\
         {:<detectors$} {:<patterns$} {:>7} {:>9} {:>11} {:>18}  drop",
        count(judgement.views, "view"),
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
