//! The headline table, in the layout of the paper's tables: detector × texture.

use maud::{Markup, html};

use super::{heads, number, rows_by_detector, table};
use crate::report::{certainty, paired};
use crate::score::{
    Compared, Difference, Drop, EvaluatedDetector, Figures, Scores, Summary, disagreements, paired as all_paired,
};
use scaleproof_plot::distinct;

/// Each number beside how many photos it rests on, and its drop from the base variant.
pub(super) fn headline(scores: &Scores) -> Markup {
    let head = html! {
        (heads("detector", &["texture"])) th.photos { "photos" }
        th { "AP@0.5" } th.of { "drop" br; small { "95 %" } }
        th { "hit rate" br; small { "95 % interval" } } th.of { "drop" br; small { "95 %" } }
        th { "confidence" br; small { "mean" } } th.of { "drop" br; small { "95 %" } }
        th { br; small { "median" } }
    };
    let name = |c: &EvaluatedDetector| html! { (c.manifest.title) @if !c.is_live() { " " small.recorded { (c.source_name()) } } };
    let cells = |s: &Summary| {
        html! {
            td.photos { (s.overall.photos) }
            td { (number(s.overall.ap50, 3)) } td.of { (drop(scores, s, |d| d.ap50, (|r| &r.ap50, |_| false))) }
            td { (rate(&s.overall)) } td.of { (drop(scores, s, |d| d.hit_rate, (|r| &r.hit_rate.rate, paired::is_hit_rate_shown))) }
            td { (number(s.overall.mean_confidence, 2)) }
            td.of {
                (drop(scores, s, |d| d.mean_confidence, (|r| &r.mean_confidence, paired::is_confidence_shown)))
                @if let Some(r) = paired::compared(scores, &s.detector, &s.variant) { small { (paired::word(r)) } }
            }
            td { (number(s.overall.median_confidence, 2)) }
        }
    };
    html! {
        (table(Some("headline"), &head, &rows_by_detector(scores, name, cells)))
        @for sentence in disagreements(scores) { p.explained { (sentence) "." } }
        p.note {
            @if let Some(protocol) = scores.criteria.protocol { "Protocol: " (protocol.name()) ". " }
            "AP@0.5: " (scores.criteria.ap.name()) " (" (scores.criteria.ap.meaning()) "). A hit: " (scores.criteria.hit())
            ". Confidence: misses count 0. Drop: " (scores.base) " minus this texture; above 0, the detector does worse"
            @if scores.variants().contains(&scores.base.as_str()) {
                " " (bases(scores)) ". Red: a drop is shown. "
            } @else {
                ". This run lacks " (scores.base) ", so no drop is given. "
            }
        }
        @if let Some(sentence) = certainty::tested(scores, all_paired(scores)) { p.note { (sentence) "." } }
    }
}

/// What the drops rest on: pairs of photos, or all where none pair.
fn bases(scores: &Scores) -> String {
    let dropped = scores.summaries.iter().filter(|s| s.drop.is_some());
    let bases = distinct(
        dropped.map(|s| match paired::compared(scores, &s.detector, &s.variant) {
            Some(r) => format!("{}: {}", s.variant, paired::basis(r)),
            None => format!("{}: no photos pair, over all photos", s.variant),
        }),
    );
    if bases.is_empty() {
        String::new()
    } else {
        format!("({})", bases.join("; "))
    }
}

fn rate(f: &Figures) -> Markup {
    let r = &f.hit_rate;
    html! { (r.count) "/" (f.photos) " " small { "[" (number(r.low, 2)) ", " (number(r.high, 2)) "]" } }
}

/// A figure of a comparison, and whether it is shown to change.
type Figure = (fn(&Compared) -> &Difference, fn(&Compared) -> bool);

/// The drop on paired photos with its interval, or over all photos where none pair. Red only where it is shown.
fn drop(scores: &Scores, s: &Summary, overall: fn(&Drop) -> f64, (of, is_shown): Figure) -> Markup {
    let compared = paired::compared(scores, &s.detector, &s.variant).map(|r| (of(r), is_shown(r)));
    html! {
        @match (compared, s.drop) {
            (Some((d, is_shown)), _) => {
                span.down[is_shown && d.drop > 0.0] { (number(d.drop, 2)) }
                br; small { @if let Some(interval) = paired::interval(d, |v| number(v, 2)) { (interval) " " } }
            }
            (None, Some(drop)) => { (number(overall(&drop), 2)) br; small { "not paired" } }
            (None, None) => {}
        }
    }
}
