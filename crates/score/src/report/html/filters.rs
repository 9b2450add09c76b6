//! Filters above the contact sheet, and the keys on each card that they use. Without scripts they stay hidden.

use std::collections::BTreeSet;

use maud::{Markup, html};

use crate::figures::{PhotoOutcome, ScoredPhoto, Scores, Verdict};
use crate::report::words::side;
use scaleproof_pose::scene::Bin;

/// A filter: its key on the cards, its name, and (value, name) of each option.
type Choice = (&'static str, &'static str, Vec<(String, String)>);

/// Renders the filters, with the names of the outcomes and of the initial order of the cards. A filter with less than two options is left out.
pub(crate) fn bar(scores: &Scores, photos: &[&ScoredPhoto], outcomes: &[(&str, &str)], order: &str) -> Markup {
    let detectors = scores.detectors.iter().map(|c| &c.manifest);
    let textures = scores.variants().into_iter().map(|v| (v.to_owned(), v.to_owned()));
    let outcomes = outcomes
        .iter()
        .map(|(value, name)| ((*value).to_owned(), (*name).to_owned()));
    let bins: BTreeSet<Bin> = photos.iter().filter_map(|p| p.bin).collect();
    let azimuths = values(&bins, |b| b.azimuth_deg, |v| format!("{v}° {}", side(v)));
    let pitches = values(&bins, |b| b.pitch_deg, |v| format!("{v}°"));
    let distances = values(&bins, |b| b.distance_mm, |v| format!("{v} mm"));
    let titles = detectors.map(|m| (m.name.clone(), m.title.clone()));
    let choices: [Choice; 6] = [
        ("detector", "detector", titles.collect()),
        ("variant", "texture", textures.collect()),
        ("outcome", "outcome", outcomes.collect()),
        ("azimuth", "azimuth", azimuths),
        ("pitch", "pitch", pitches),
        ("distance", "distance", distances),
    ];
    html! {
        form #filters hidden {
            @for (key, name, values) in choices.iter().filter(|(_, _, values)| values.len() > 1) {
                label { (name) " " select name=(key) {
                    option value="" { "all" }
                    @for (value, name) in values { option value=(value) { (name) } }
                } }
            }
            label { "order " select name="order" {
                option value="" { (order) }
                option value="direction" { "by direction" }
            } }
            output {}
        }
        dialog #enlarged {}
    }
}

fn values(bins: &BTreeSet<Bin>, of: fn(&Bin) -> f64, name: fn(f64) -> String) -> Vec<(String, String)> {
    let mut values: Vec<f64> = bins.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.into_iter().map(|v| (v.to_string(), name(v))).collect()
}

/// Outcomes of a photo: key on the cards, and name.
pub(crate) const OUTCOMES: [(&str, &str); 4] = [
    ("disappeared", "missed: disappeared"),
    ("misclassified", "missed: misclassified"),
    ("found_with_other", "found, and another label"),
    ("found", "found"),
];

/// Returns the key of an outcome on the cards.
pub(crate) fn outcome_key(outcome: &PhotoOutcome) -> &'static str {
    match outcome.verdict {
        Verdict::Missed if outcome.is_misclassified() => "misclassified",
        Verdict::Missed => "disappeared",
        Verdict::FoundWithOther => "found_with_other",
        Verdict::Found => "found",
    }
}
