//! Results of `attack history`, as JSON and in words.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_attack::evaluate::time_chart::RenderedRun;
use scaleproof_attack::run::history::History;

/// `attack history --json`.
#[derive(Serialize, JsonSchema)]
pub struct Histories<'a> {
    /// What `attack.json` lists.
    pub histories: &'a [History],
    /// The path of `attack.json`.
    pub numbers: Option<&'a PathBuf>,
    /// The path of `attack.svg`.
    pub chart: Option<&'a PathBuf>,
    /// With `--evaluation`, the same list as in `rendered.json`.
    pub rendered: &'a [RenderedRun],
    /// The path of `rendered.svg`; `null` without `--evaluation`.
    pub rendered_chart: Option<&'a PathBuf>,
}

pub fn table(histories: &[History]) -> String {
    let mut text = format!(
        "{:<10} {:>5} {:>8} {:>9} {:>8} {:>7} {:>9} {:>11}\n",
        "method", "seed", "tile mm", "images", "seconds", "AP@0.5", "hit rate", "confidence"
    );
    for history in histories {
        if let Some((entry, judged)) = history.last_judged() {
            text += &format!(
                "{:<10} {:>5} {:>8} {:>9} {:>8.0} {:>7.2} {:>9.2} {:>11.2}\n",
                history.method,
                history.seed,
                history.tile_mm,
                entry.queries,
                entry.wall_s,
                judged.ap50,
                judged.hit_rate,
                judged.mean_confidence
            );
        }
    }
    text
}

pub fn rendered_table(runs: &[RenderedRun]) -> String {
    let mut text = String::new();
    if !runs.is_empty() {
        text += &format!(
            "\nrendered:\n{:<10} {:>5} {:>9} {:>8}  {:<15} {:>6} {:>7} {:>9}\n",
            "method", "seed", "images", "seconds", "detector", "photos", "AP@0.5", "hit rate"
        );
    }
    for (run, of) in runs.iter().flat_map(|run| run.rendered.iter().map(move |of| (run, of))) {
        text += &format!(
            "{:<10} {:>5} {:>9} {:>8.0}  {:<15} {:>6} {:>7.2} {:>9.2}\n",
            run.method, run.seed, run.queries, run.wall_s, of.detector, of.photos, of.ap50, of.hit_rate
        );
    }
    text
}
