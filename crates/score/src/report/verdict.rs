//! What a comparison found, in a sentence for each texture: it stands above every table.

use super::paired;
use crate::score::{Compared, Finding, Scores};
use scaleproof_core::spelling::{choose, count};
use scaleproof_plot::distinct;

/// What a finding of the hit rate says of detectors, as `lowers the hit rate of 2`; in the order in which findings are said.
const SAID: [(Finding, &str); 5] = [
    (Finding::Drop, "lowers the hit rate of"),
    (Finding::Rise, "raises the hit rate of"),
    (
        Finding::NotAfterCorrection,
        "shows nothing after correction, though by itself it would, of",
    ),
    (
        Finding::NoDifferenceShown,
        "shows no difference, and excludes one of 0.2, of",
    ),
    (
        Finding::TooFewPhotosToTell,
        "leaves open, as the photos are too few to tell,",
    ),
];

/// `On 5 detectors “random” lowers the hit rate of 2 (A, B), and leaves open, as the photos are too few to tell, 3 (C, D, E).` A sentence for each texture.
pub(super) fn sentences(scores: &Scores, results: &[Compared]) -> Vec<String> {
    let textures = distinct(results.iter().map(|r| r.variant.as_str()));
    textures
        .into_iter()
        .map(|texture| sentence(scores, results, texture))
        .collect()
}

fn sentence(scores: &Scores, results: &[Compared], texture: &str) -> String {
    let own: Vec<&Compared> = results.iter().filter(|r| r.variant == texture).collect();
    let part = |(finding, words): &(Finding, &str)| {
        let found = own.iter().filter(|r| r.hit_rate.rate.finding == *finding);
        let names: Vec<&str> = found.map(|r| scores.title(&r.detector)).collect();
        let which = match names.len() {
            0 => return None,
            n if n == own.len() => choose(n, "it", "all").to_owned(),
            n => format!("{n} ({})", names.join(", ")),
        };
        Some(format!("{words} {which}"))
    };
    let parts: Vec<String> = SAID.iter().filter_map(part).collect();
    let on = if own.len() == 1 {
        scores.title(&own[0].detector).to_owned()
    } else {
        count(own.len(), "detector")
    };
    let basis = own.first().map_or(String::new(), |r| paired::basis(r));
    format!("On {on} “{texture}” {} ({basis})", parts.join("; "))
}
