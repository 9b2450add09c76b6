//! A sequential comparison in words.

use crate::figures::{ClusteredBy, Course, Decision, Scores, Sequential, SequentialFinding};
use crate::report::words::{briefly, p_value};
use scaleproof_core::spelling;

/// Evidence from which a drop is shown, as a base-10 logarithm (a factor of 40).
pub(crate) const SHOWN_FROM: f64 = 1.602;

/// Returns the unit of a look: `place` or `pair`.
pub(crate) fn unit(sequential: &Sequential) -> &'static str {
    match sequential.look_after_each {
        ClusteredBy::Place => "place",
        ClusteredBy::PlaceAndBin => "pair",
    }
}

/// Returns the findings so far in one line: `fake: hides (a drop, shown after 10 of 16 pairs, p = 0.035)`.
pub fn standing(sequential: &Sequential) -> String {
    let each = sequential.results.iter().map(|course| {
        let (word, confidence) = (briefly(course.effect), &course.mean_confidence);
        let found = finding_words(confidence, sequential, course.looks);
        format!("{}: {word} ({found}, p {})", course.detector, p_of(confidence))
    });
    each.collect::<Vec<_>>().join("; ")
}

/// Returns the p value of a decision, and the corrected one where it differs: `= 0.012, corrected = 0.060`.
pub(crate) fn p_of(decision: &Decision) -> String {
    let corrected = decision.p_corrected.filter(|p| *p != decision.p_always_valid);
    let corrected = corrected.map(|p| format!(", corrected {}", p_value(p)));
    p_value(decision.p_always_valid) + &corrected.unwrap_or_default()
}

/// Returns `, 24 repeats not looked at`; an empty text without any.
pub(crate) fn repeats(course: &Course) -> String {
    match course.repeats {
        0 => String::new(),
        n => format!(", {} not looked at", spelling::count(n, "repeat")),
    }
}

pub(crate) fn figures(course: &Course) -> [(&'static str, &Decision); 2] {
    [
        ("mean confidence", &course.mean_confidence),
        ("hit rate", &course.hit_rate),
    ]
}

/// Returns a finding with its looks: `a drop, shown after 7 of 24 pairs`.
pub(crate) fn finding_words(decision: &Decision, sequential: &Sequential, looks: usize) -> String {
    let what = match decision.finding {
        SequentialFinding::Drop => "a drop".to_owned(),
        SequentialFinding::Rise => "a rise".to_owned(),
        SequentialFinding::LessThanLeast => {
            format!("no drop of {} or more", sequential.least.unwrap_or_default())
        }
        SequentialFinding::Undecided => "undecided".to_owned(),
    };
    let all = spelling::count(looks, unit(sequential));
    match decision.decided_after {
        Some(after) => format!("{what}, shown after {after} of {all}"),
        None => format!("{what} after {all}"),
    }
}

/// Returns the number of places or whole rounds that an interval rests on.
pub(crate) fn rounds(decision: &Decision, unit: &str) -> String {
    match unit {
        "place" => spelling::count(decision.rounds, "place"),
        _ => spelling::count(decision.rounds, "whole round"),
    }
}

pub(crate) fn note(scores: &Scores, sequential: &Sequential) -> String {
    let sessions = spelling::choose(scores.sessions.len(), "session lists", "sessions list");
    format!(
        "Looked at after each {}, in the order in which the {sessions} the photos, the first pair of each place and bin. All decisions hold however often one looks and whenever one stops: \
         where no texture changes anything, any drop or rise is ever shown with a probability of 5 % at most (bets on the paired differences, Waudby-Smith and Ramdas 2024; the p of the mean confidences corrected over the detectors by Holm, and for the number of textures; the hit rate not before the confidence). The interval rests on whole rounds alone, so that it may hold 0 where a drop is shown. Average \
         precision is no mean of photos, and so has no such test.",
        unit(sequential)
    )
}
