//! What a comparison found, in a sentence for each texture: it stands above every table.

use super::paired;
use crate::score::{Compared, Finding, Scores};
use scaleproof_core::spelling::count;
use scaleproof_plot::distinct;

/// What a finding of the hit rate says, before and after the detectors that it is of; in the order in which findings are said.
const SAID: [(Finding, [&str; 2]); 5] = [
    (Finding::Drop, ["lowers the hit rate", ""]),
    (Finding::Rise, ["raises the hit rate", ""]),
    (
        Finding::NotAfterCorrection,
        [
            "shows no difference after correction for the number of tests",
            ", where one test alone would",
        ],
    ),
    (
        Finding::NoDifferenceShown,
        ["shows no difference", ", and one of 0.2 is excluded"],
    ),
    (
        Finding::TooFewPhotosToTell,
        ["leaves it open", ", as the photos are too few to tell"],
    ),
];

/// `On 5 detectors “random” lowers the hit rate on 2 (A, B); leaves it open on 3 (C, D, E), as the photos are too few to tell`. A sentence for each texture.
pub(super) fn sentences(scores: &Scores, results: &[Compared]) -> Vec<String> {
    let textures = distinct(results.iter().map(|r| r.variant.as_str()));
    textures
        .into_iter()
        .map(|texture| sentence(scores, results, texture))
        .collect()
}

fn sentence(scores: &Scores, results: &[Compared], texture: &str) -> String {
    let own: Vec<&Compared> = results.iter().filter(|r| r.variant == texture).collect();
    let part = |(finding, [before, after]): &(Finding, [&str; 2])| {
        let found = own.iter().filter(|r| r.hit_rate.rate.finding == *finding);
        let names: Vec<&str> = found.map(|r| scores.title(&r.detector)).collect();
        let on = match names.len() {
            0 => return None,
            1 if own.len() == 1 => String::new(),
            n if n == own.len() => " on all".to_owned(),
            n => format!(" on {n} ({})", names.join(", ")),
        };
        Some(format!("{before}{on}{after}"))
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
