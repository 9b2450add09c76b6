//! Verdict of a comparison, in a sentence for each texture: it stands above every table.

use crate::figures::{Compared, Effect, Scores};
use crate::report::Findings;
use crate::report::words::paired;
use scaleproof_core::spelling::count;
use scaleproof_plot::distinct;

/// Largest number of words of a sentence.
const MOST_WORDS: usize = 25;

/// Largest number of detectors that are named in a sentence; more are counted.
const MOST_NAMED: usize = 2;

/// Returns a sentence of 25 words at most for each texture: `In the same light, “ours” hides the model from 2 of 5 detectors (A, B); nothing is shown
/// for 3`.
pub(crate) fn sentences(findings: Findings) -> Vec<String> {
    let tested = findings.results.iter().filter(|r| r.finding.is_some());
    let textures = distinct(tested.map(|r| r.variant.as_str()));
    textures
        .into_iter()
        .map(|texture| sentence(findings, texture))
        .collect()
}

/// Returns the pairs that a comparison rests on, after `These photos are renders` where all are.
pub(crate) fn basis(findings: Findings) -> Option<String> {
    let basis = paired::basis(findings.results.first()?);
    Some(match are_renders(findings.scores) {
        true => format!("These photos are renders: {basis}"),
        false => basis,
    })
}

/// Returns true if no camera took the photos.
pub(crate) fn are_renders(scores: &Scores) -> bool {
    scores.sessions.iter().all(|session| session.rendered)
}

fn sentence(findings: Findings, texture: &str) -> String {
    let with_names = worded(findings, texture, MOST_NAMED);
    if with_names.split_whitespace().count() <= MOST_WORDS {
        return with_names;
    }
    worded(findings, texture, 0)
}

/// Returns the sentence, in which groups of at most `most_named` detectors are named.
fn worded(findings: Findings, texture: &str, most_named: usize) -> String {
    let own = findings
        .results
        .iter()
        .filter(|r| r.variant == texture && r.finding.is_some());
    let own: Vec<&Compared> = own.collect();
    let of = |effect: Effect| -> Vec<&str> {
        let own = own.iter().filter(|r| r.effect() == effect);
        own.map(|r| findings.scores.title(&r.detector)).collect()
    };
    let verbs = [
        (of(Effect::Hides), "hides the model from"),
        (of(Effect::Weakens), "weakens"),
        (of(Effect::Strengthens), "strengthens"),
    ];
    let shown: Vec<&(Vec<&str>, &str)> = verbs.iter().filter(|(names, _)| !names.is_empty()).collect();
    let is_few = shown.iter().map(|(names, _)| names.len()).sum::<usize>() <= most_named;
    let shown: Vec<String> = shown
        .iter()
        .enumerate()
        .map(|(i, (names, verb))| format!("{verb} {}", detectors(names, own.len(), i == 0, is_few)))
        .collect();
    let (nothing, unseen) = (of(Effect::NothingShown), of(Effect::BaseUnseen));
    let withheld = match own.iter().filter(|r| paired::is_withheld(r)).count() {
        0 => String::new(),
        n => format!(" ({n} withheld)"),
    };
    let mut parts = Vec::new();
    if shown.is_empty() {
        let on = |names: &[&str]| detectors(names, own.len(), true, names.len() <= most_named);
        if !nothing.is_empty() {
            parts.push(format!("nothing is shown of “{texture}” on {}{withheld}", on(&nothing)));
        }
    } else {
        parts.push(format!("in the same light, “{texture}” {}", shown.join(" and ")));
        if !nothing.is_empty() {
            parts.push(format!("nothing is shown for {}{withheld}", nothing.len()));
        }
    }
    if !unseen.is_empty() {
        let who = detectors(&unseen, own.len(), parts.is_empty(), unseen.len() <= most_named.min(1));
        parts.push(format!(
            "{who} cannot tell, not seeing {}",
            paired::named_base(findings.base)
        ));
    }
    capitalised(&parts.join("; "))
}

/// Returns `2 of 5 detectors (A, B)`, `all 5 detectors`, or the name of the only one.
fn detectors(names: &[&str], all: usize, is_first: bool, are_named: bool) -> String {
    let of = match (names.len(), all) {
        (1, 1) => return names[0].to_owned(),
        (n, all) if n == all => return format!("all {}", count(n, "detector")),
        (n, all) if is_first => format!("{n} of {}", count(all, "detector")),
        (n, _) => n.to_string(),
    };
    if are_named {
        format!("{of} ({})", names.join(", "))
    } else {
        of
    }
}

pub(crate) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
