//! The photos of a comparison side by side: base and texture from one view, with the boxes of each detector, the largest losses first.

use std::collections::BTreeSet;

use maud::{Markup, html};

use crate::compare::paired_photos;
use crate::figures::{Comparison, PhotoOutcome, ScoredPhoto, Scores};
use crate::report::html::{contact, filters};
use crate::report::words::{number, side};

/// Largest number of pairs that are shown: with more the page would be too large to open.
const MOST_PAIRS: usize = 200;

type Pair<'a> = (&'a ScoredPhoto, &'a ScoredPhoto);

/// Outcomes of the model in both photos of a pair: key on the cards, and name.
pub(crate) const OUTCOMES: [(&str, &str); 4] = [
    ("lost", "found, then missed"),
    ("missed", "missed in both"),
    ("gained", "missed, then found"),
    ("kept", "found in both"),
];

fn outcome(base: &PhotoOutcome, other: &PhotoOutcome) -> usize {
    match (base.is_hit(), other.is_hit()) {
        (true, false) => 0,
        (false, false) => 1,
        (false, true) => 2,
        (true, true) => 3,
    }
}

/// Returns the photos of the pairs that are shown, each once.
pub(crate) fn photos<'a>(scores: &'a Scores, comparison: &Comparison) -> Vec<&'a ScoredPhoto> {
    let pairs = shown(&pairs(scores, comparison));
    without_repeats(pairs.into_iter().flat_map(|(base, other)| [base, other]).collect())
}

/// Returns the pairs with previews of both photos, those that lost most confidence first; at most [`MOST_PAIRS`].
fn shown<'a>(all: &[Pair<'a>]) -> Vec<Pair<'a>> {
    let previewed = |(base, other): &&Pair| !base.preview_jpeg.is_empty() && !other.preview_jpeg.is_empty();
    let mut shown: Vec<Pair> = all.iter().filter(previewed).copied().collect();
    let lost = |(base, other): &Pair| {
        let each = base.outcomes.iter().zip(&other.outcomes);
        each.map(|(a, b)| a.confidence - b.confidence).sum::<f64>()
    };
    shown.sort_by(|a, b| lost(b).total_cmp(&lost(a)).then(a.1.id.cmp(&b.1.id)));
    shown.truncate(MOST_PAIRS);
    shown
}

/// Renders a card for each detector and pair; `None` where the run kept no previews.
pub(crate) fn section(scores: &Scores, comparison: &Comparison) -> Option<Markup> {
    let all = pairs(scores, comparison);
    let shown = shown(&all);
    if shown.is_empty() {
        return None;
    }
    let mut cards: Vec<(usize, Pair)> = (0..scores.detectors.len())
        .flat_map(|detector| shown.iter().map(move |pair| (detector, *pair)))
        .collect();
    cards.sort_by(|(i, a), (j, b)| {
        let key = |i: usize, (base, other): &Pair| outcome(&base.outcomes[i], &other.outcomes[i]);
        let drop = |i: usize, (base, other): &Pair| base.outcomes[i].confidence - other.outcomes[i].confidence;
        let by_outcome = key(*i, a).cmp(&key(*j, b));
        by_outcome
            .then(drop(*j, b).total_cmp(&drop(*i, a)))
            .then((i, a.1.id).cmp(&(j, b.1.id)))
    });
    let photos: Vec<&ScoredPhoto> = shown.iter().flat_map(|(base, other)| [*base, *other]).collect();
    Some(html! {
        p.note {
            "Left “" (comparison.base) "”, right the texture, from one place and bin. Dashed white: truth box; solid: detections at confidence ≥ "
            (scores.criteria.hit_confidence) " (blue: the class, orange: another label). Click to enlarge."
        }
        @if shown.len() < all.len() {
            p.banner { "Shown are the " (shown.len()) " of " (all.len()) " pairs that lost most confidence over all detectors; all photos are in photos.csv of `score`." }
        }
        (filters::bar(scores, &photos, &OUTCOMES, "largest losses first"))
        div #sheet .pairs { @for (detector, pair) in cards { (card(scores, pair, detector)) } }
    })
}

fn pairs<'a>(scores: &'a Scores, comparison: &Comparison) -> Vec<Pair<'a>> {
    let textures = scaleproof_plot::distinct(comparison.results.iter().map(|r| r.variant.as_str()));
    let of = |texture: &str| paired_photos(scores, &comparison.base, texture);
    textures.into_iter().flat_map(of).collect()
}

/// Keeps each photo once: a base photo is in a pair with each texture.
fn without_repeats(photos: Vec<&ScoredPhoto>) -> Vec<&ScoredPhoto> {
    let mut seen = BTreeSet::new();
    photos.into_iter().filter(|photo| seen.insert(photo.id)).collect()
}

fn card(scores: &Scores, (base, other): Pair, index: usize) -> Markup {
    let detector = &scores.detectors[index];
    let (a, b) = (&base.outcomes[index], &other.outcomes[index]);
    let (key, name) = OUTCOMES[outcome(a, b)];
    let texture = scores
        .variants()
        .iter()
        .position(|v| *v == other.variant)
        .unwrap_or_default();
    let bin = other.bin;
    html! {
        figure class=(format!("photo pair {key}")) data-detector=(detector.manifest.name) data-variant=(other.variant) data-outcome=(key)
            data-azimuth=[bin.map(|b| b.azimuth_deg)] data-pitch=[bin.map(|b| b.pitch_deg)] data-distance=[bin.map(|b| b.distance_mm)] data-texture=(texture) {
            div.two { (contact::photo_view(scores, base, index)) (contact::photo_view(scores, other, index)) }
            figcaption {
                b { (name) } (format!(" {} → {}", number(a.confidence, 2), number(b.confidence, 2)))
                br; (base.variant) " → " (other.variant) @if let Some(bin) = bin { " · " (bin.azimuth_deg) "° " (side(bin.azimuth_deg)) } @if let Some(place) = &other.place { " · " (place) }
                br; (detector.manifest.title)
                br; small.note { (base.file) ", " (other.file) }
            }
        }
    }
}
