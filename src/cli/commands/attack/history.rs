//! `scaleproof attack history`: several methods on one chart.

use std::io::Write;

use crate::cli::answer::told;
use crate::cli::args::attack::history::HistoryArgs;
use crate::cli::print::attack::history::{Histories, rendered_table, table};
use crate::cli::{CommandResult, Result};
use scaleproof_attack::evaluate::time_chart::{self};
use scaleproof_attack::run::history::{History, draw};
use scaleproof_core::files;

pub fn run(args: &HistoryArgs, out: &mut dyn Write) -> CommandResult {
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
