//! Notes under the figures: method, photos left out, definitions, provenance.

use maud::{Markup, html};

use crate::figures::{Comparison, NotScored, Scores, disagreements};
use crate::report::html::parts::{heads, table};
use crate::report::words::{certainty, counted, paper, truth_boxes};
use crate::report::{Findings, provenance};
use scaleproof_core::spelling;

/// Renders sentences for a paper, how effects were decided, where AP and hits disagree, and the definitions in short.
pub(crate) fn method(findings: Findings) -> Markup {
    let (scores, paper) = (findings.scores, paper::sentences(findings));
    html! {
        @if !paper.is_empty() { h3 { "To write in a paper" } p { (paper.join(" ")) } }
        @if let Some(sentence) = certainty::tested(findings) { h3 { "How effects were decided" } p { (sentence) "." } }
        @for sentence in disagreements(scores) { p.explained { (sentence) "." } }
        p {
            @if let Some(protocol) = scores.criteria.protocol { "Protocol: " (protocol.name()) ". " }
            "AP@0.5: " (scores.criteria.ap.name()) " (" (scores.criteria.ap.meaning()) "); a hit: " (scores.criteria.hit())
            "; counts as the model: " (counted::counted(scores)) ". Confidence: misses count 0. Drop: the base minus the texture."
        }
    }
}

pub(crate) fn not_scored(scores: &Scores) -> Markup {
    html! {
        @if !scores.not_scored.is_empty() {
            h3 { "Photos not scored" }
            (photos_with_reasons(&scores.not_scored))
        }
    }
}

pub(crate) fn photos_with_reasons(photos: &[NotScored]) -> Markup {
    let rows = html! {
        @for p in photos {
            tr { td { (p.file) } td.text { (p.session) } td.text { (p.variant) } td.wrap { (p.reason) } }
        }
    };
    table(None, &heads("photo", &["session", "texture", "reason"]), &rows)
}

pub(crate) fn definitions(scores: &Scores) -> Markup {
    html! {
        dl {
            @for (name, definition) in scores.criteria.definitions() { dt { (name) } dd { (definition) "." } }
            dt { "counts as the model" } dd { "a detection with the label " (counted::labels(scores)) "; any other label is another class." }
            dt { "labels of a box" } dd { (counted::BOX_LABELS) "." }
            dt { "truth box" }
            dd {
                (truth_boxes(scores)) ". Through the pose: the model's envelope projected through the pose that the AprilTags give, cut at "
                "the photo's border; nothing hides the model."
            }
            dt { "azimuth" } dd { "0° looks at the front, counter-clockwise from above; 90° is the model's left side." }
        }
    }
}

/// Returns the text, or `not stated` where it is empty.
fn stated(text: String) -> String {
    if text.is_empty() { "not stated".to_owned() } else { text }
}

/// Returns the first and the last time, or the one time where both are equal; empty where none is known.
fn taken(times: Option<&[String; 2]>) -> String {
    times.map_or(String::new(), |times| match times {
        [first, last] if first == last => first.clone(),
        [first, last] => format!("{first} to {last}"),
    })
}

/// Returns number and seed of the bootstrap draws of a comparison.
pub(crate) fn bootstrap(comparison: &Comparison) -> String {
    let (draws, seed) = (comparison.bootstrap_draws, comparison.bootstrap_seed);
    format!("{draws} bootstrap draws, seed {seed}")
}

/// Renders the provenance of a run; `chance` says which random numbers the figures rest on.
pub(crate) fn provenance(scores: &Scores, chance: &str) -> Markup {
    let p = provenance::from_scores(scores);
    let sources = html! {
        @for d in &p.detectors {
            tr {
                td { (d.title) } td.hash {
                    @if let Some(weights) = &d.weights_sha256 { (weights) }
                    @if let Some(version) = &d.version { (version) br; }
                    @for (file, hash) in &d.files { (file) ": " (hash) br; }
                } td.text { (d.origin) } td.text { (d.licence) }
                td.text { (d.source) @if let Some(by) = &d.recorded_by { " by " (by) } }
            }
        }
    };
    html! {
        dl.settings {
            dt { "program" } dd {
                "scaleproof " (p.scaleproof) @if let Some(runtime) = &p.onnx_runtime { ", " (runtime) }
            }
            dt { "tags" } dd { (p.tag_detector) }
            @if let Some(s) = &p.settings { dt { "settings" } dd { (s.file) ", SHA-256 " code { (s.sha256) } } }
            dt { "thresholds" } dd {
                "match IoU " (p.match_iou) ", hit confidence " (p.hit_confidence) ", candidates from confidence " (p.score_floor) " up, AP "
                (p.ap_definition)
            }
            @if let Some(protocol) = p.protocol { dt { "protocol" } dd { (protocol) } }
            @for s in &p.sessions { dt { "session " (s.folder) } dd {
                (s.model) ", 1:" (s.scale) ", truth envelope: " (s.truth_envelope) "; places: " (stated(s.places.join(", ")))
                "; photos taken: " (stated(taken(s.taken.as_ref()))) "; camera file: " (stated(s.camera.clone().unwrap_or_default()))
            } }
            dt { "chance" } dd { (chance) "; the same input gives the same files, byte for byte" }
        }
        (table(Some("sources"), &heads("detector", &["weights (SHA-256)", "origin", "licence", "detections"]), &sources))
        @for s in &p.sessions {
            details {
                summary { "Session " (s.folder) ": " (spelling::count(s.files.len(), "file")) }
                div.scroll {
                    table { tbody { @for (file, hash) in &s.files { tr { td { (file) } td.hash { (hash) } } } } }
                }
            }
        }
    }
}
