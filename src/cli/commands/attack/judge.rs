//! `scaleproof attack judge`: patterns on every view of frames, as the surrogate renderer predicts them.

use std::io::Write;

use crate::cli::answer::told;
use crate::cli::args::attack::judge::JudgeArgs;
use crate::cli::args::attack::on_frames::Looking;
use crate::cli::print::attack::judge::{Judgement, table};
use crate::cli::resolve::attack::render::named;
use crate::cli::{CommandResult, progress};
use scaleproof_attack::judged::{JudgedPattern, NamedCells, judged};
use scaleproof_attack::run::augmentation::Eot;

pub fn run(args: &JudgeArgs, out: &mut dyn Write) -> CommandResult {
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
