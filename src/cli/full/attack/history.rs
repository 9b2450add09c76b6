//! `scaleproof attack history`: several methods on one chart.

use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::answer::told;
use crate::cli::print::card_fault;
use crate::cli::{CommandResult, Result};
use scaleproof_attack::evaluate::finished::figures_of;
use scaleproof_attack::evaluate::time_chart::{self, RenderedRun};
use scaleproof_attack::result;
use scaleproof_attack::run::history::{History, draw};
use scaleproof_core::files;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::{self, CardError};

/// AP@0.5 on the held-out views against wall time, of several results of `attack run` and `attack baseline`
#[derive(clap::Args)]
pub(in crate::cli) struct HistoryArgs {
    /// Folders of results
    #[arg(value_name = "DIR", required = true)]
    results: Vec<PathBuf>,
    /// What `attack evaluate` wrote of the same patterns: a second chart has AP@0.5 in its photos against the time of each run
    #[arg(long, value_name = "DIR")]
    evaluation: Option<PathBuf>,
    /// Folder for the charts (SVG) and their numbers (JSON)
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// The histories as one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &HistoryArgs, out: &mut dyn Write) -> CommandResult {
    let histories = args
        .results
        .iter()
        .map(|folder| History::load(folder))
        .collect::<Result<Vec<_>, _>>()?;
    args.refuse_twice()?;
    for (folder, history) in args.results.iter().zip(&histories) {
        let folder = folder.display();
        if history.last_judged().is_none() {
            return Err(
                format!("the history of {folder} has no figures of held-out views: make the pattern again").into(),
            );
        }
        let differences = histories[0].differences(history).join(" and ");
        if !differences.is_empty() {
            let first = args.results[0].display();
            return Err(format!(
                "{first} and {folder} were made with {differences}: their figures cannot stand on one chart"
            )
            .into());
        }
    }
    let rendered = args.rendered(&histories)?;
    files::check_writable(&args.output)?;
    let at = |name: &str| args.output.join(name);
    let mut new = vec![
        (at("attack.json"), serde_json::to_vec_pretty(&histories)?),
        (at("attack.svg"), draw(&histories).into_bytes()),
    ];
    if !rendered.is_empty() {
        new.push((at("rendered.json"), serde_json::to_vec_pretty(&rendered)?));
        new.push((at("rendered.svg"), time_chart::draw(&rendered).into_bytes()));
    }
    files::replace_all_atomically(&args.output, &new)?;
    if rendered.is_empty() {
        // Those of an earlier call would pass for these results'.
        ["rendered.json", "rendered.svg"]
            .iter()
            .try_for_each(|name| files::chosen::remove(&args.output, &at(name)))?;
    }
    let path = |i: usize| new.get(i).map(|(path, _)| path);
    let facts = Histories {
        histories: &histories,
        numbers: path(0),
        chart: path(1),
        rendered: &rendered,
        rendered_chart: path(3),
    };
    let paths: Vec<String> = new.iter().map(|(path, _)| path.display().to_string()).collect();
    let words = table(&histories) + &rendered_table(&rendered) + &paths.join("\n");
    told(args.json, &facts, words, out)
}

/// `attack history --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Histories<'a> {
    /// What `attack.json` lists.
    histories: &'a [History],
    /// The path of `attack.json`.
    numbers: Option<&'a PathBuf>,
    /// The path of `attack.svg`.
    chart: Option<&'a PathBuf>,
    /// With `--evaluation`, the same list as in `rendered.json`.
    rendered: &'a [RenderedRun],
    /// The path of `rendered.svg`; `null` without `--evaluation`.
    rendered_chart: Option<&'a PathBuf>,
}

impl HistoryArgs {
    /// What the evaluation says of each run's pattern; nothing without one.
    fn rendered(&self, histories: &[History]) -> Result<Vec<RenderedRun>> {
        let Some(evaluation) = &self.evaluation else {
            return Ok(Vec::new());
        };
        let runs = self.results.iter().zip(histories);
        runs.map(|(folder, history)| {
            let pattern = folder.join(result::PATTERN);
            check_own(&pattern)?;
            let figures = figures_of(evaluation, &pattern, history.tile_mm, history.classes.as_ref())?;
            Ok(RenderedRun::new(history, figures))
        })
        .collect()
    }

    fn refuse_twice(&self) -> Result<()> {
        let mut known = HashMap::new();
        for folder in &self.results {
            if let Some(first) = known.insert(files::whole_path(folder)?, folder) {
                let (first, again) = (first.display(), folder.display());
                return Err(format!("{first} and {again} are the same result: name it once").into());
            }
        }
        Ok(())
    }
}

/// The pattern of a result is the one that its card was written for, and no texture.
fn check_own(path: &Path) -> Result<(), String> {
    let pattern = Pattern::load(path).map_err(|e| e.to_string())?;
    match card::card(path, &pattern) {
        Ok(card) if card.sides => Err(format!(
            "{} has cells for each side, which evaluations hold as a texture: --evaluation shows repeated patterns alone",
            path.display()
        )),
        Ok(_) | Err(CardError::None { .. }) => Ok(()),
        Err(e) => Err(card_fault(&e)),
    }
}

fn table(histories: &[History]) -> String {
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

fn rendered_table(runs: &[RenderedRun]) -> String {
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
