//! What a comparison found, in a sentence for each texture: it stands above every table.

use super::paired;
use crate::score::{Compared, Effect, Scores};
use scaleproof_core::spelling::count;
use scaleproof_plot::distinct;

/// So many detectors are named; more are counted.
const MOST_NAMED: usize = 2;

/// `“ours” hides the model from 2 of 5 detectors (A, B) and weakens 1 (C); nothing is shown of 2.` One for each texture.
pub(super) fn sentences(scores: &Scores, results: &[Compared], base: &str) -> Vec<String> {
    let tested = || results.iter().filter(|r| r.finding.is_some());
    let textures = distinct(tested().map(|r| r.variant.as_str()));
    textures
        .into_iter()
        .map(|texture| sentence(scores, results, [texture, base]))
        .collect()
}

fn sentence(scores: &Scores, results: &[Compared], [texture, base]: [&str; 2]) -> String {
    let own = results.iter().filter(|r| r.variant == texture && r.finding.is_some());
    let own: Vec<&Compared> = own.collect();
    let mut is_first = true;
    let mut some = |effect: Effect| {
        let names: Vec<&str> = own
            .iter()
            .filter(|r| r.effect() == effect)
            .map(|r| scores.title(&r.detector))
            .collect();
        if names.is_empty() {
            return None;
        }
        let is_first = std::mem::take(&mut is_first);
        Some(match (names.len(), own.len()) {
            (1, 1) => names[0].to_owned(),
            (n, all) if n == all => format!("all {}", count(n, "detector")),
            (n, all) => {
                let of = if is_first {
                    format!("{n} of {}", count(all, "detector"))
                } else {
                    n.to_string()
                };
                if n <= MOST_NAMED {
                    format!("{of} ({})", names.join(", "))
                } else {
                    of
                }
            }
        })
    };
    let shown = [
        (Effect::Hides, "hides the model from"),
        (Effect::Weakens, "weakens"),
        (Effect::Strengthens, "strengthens"),
    ];
    let shown: Vec<String> = shown
        .into_iter()
        .filter_map(|(effect, verb)| Some(format!("{verb} {}", some(effect)?)))
        .collect();
    let nothing = some(Effect::NothingShown);
    let unseen = some(Effect::BaseUnseen);
    let mut parts = Vec::new();
    if !shown.is_empty() {
        parts.push(format!("“{texture}” {}", shown.join(" and ")));
    }
    parts.extend(nothing.map(|detectors| match parts.is_empty() {
        true => format!("nothing is shown of “{texture}” on {detectors}"),
        false => format!("nothing is shown of {detectors}"),
    }));
    parts.extend(unseen.map(|detectors| match parts.is_empty() {
        true => format!(
            "of “{texture}” nothing can be told by {detectors}, without {} seen",
            paired::named_base(base)
        ),
        false => format!("{detectors} cannot tell, not seeing {}", paired::named_base(base)),
    }));
    parts.join("; ")
}
