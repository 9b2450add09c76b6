//! The headline figures as plain text for the terminal.

use crate::score::{Scores, Summary};

/// One line per detector, under a heading: AP@0.5, hit rate and mean confidence of every variant.
pub fn summary_table(scores: &Scores) -> String {
    let mut lines = vec![heading(scores)];
    for contestant in &scores.contestants {
        let name = &contestant.manifest.name;
        let cells = scores.summaries.iter().filter(|s| &s.detector == name).map(cell);
        lines.push(format!("{name:<14}{}", cells.collect::<String>()));
    }
    lines.join("\n")
}

fn heading(scores: &Scores) -> String {
    let first = scores.contestants.first().map(|c| &c.manifest.name);
    let of_first = scores.summaries.iter().filter(|s| Some(&s.detector) == first);
    let cells = of_first.map(|s| format!("  {:<30}", format!("{}: AP@0.5 / hits / conf.", s.variant)));
    format!("{:<14}{}", "detector", cells.collect::<String>())
}

fn cell(s: &Summary) -> String {
    let f = &s.overall;
    let hits = format!("{}/{}", f.hit_rate.hits, f.photos);
    format!(
        "  {:<30}",
        format!(
            "{:.3} / {hits} ({:.0} %) / {:.2}",
            f.ap50,
            100.0 * f.hit_rate.rate,
            f.mean_confidence
        )
    )
}
