//! What stands under the figures: photos left out, definitions, provenance.

use maud::{Markup, html};

use crate::report::{provenance, truth_boxes};
use crate::score::Scores;

pub(super) fn cautions(scores: &Scores) -> Markup {
    html! {
        @for caution in &scores.cautions { p.banner { "Note: " (caution) "." } }
    }
}

pub(super) fn not_scored(scores: &Scores) -> Markup {
    html! {
        @if !scores.not_scored.is_empty() {
            section {
                h2 { "Photos not scored" }
                div.scroll {
                    table {
                        thead { tr { th { "photo" } th { "session" } th { "texture" } th { "reason" } } }
                        tbody {
                            @for n in &scores.not_scored {
                                tr { td { (n.file) } td.text { (n.session) } td.text { (n.variant) } td.wrap { (n.reason) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

pub(super) fn definitions(scores: &Scores) -> Markup {
    html! {
        dl {
            @for (name, definition) in scores.criteria.definitions() { dt { (name) } dd { (definition) "." } }
            dt { "truth box" }
            dd {
                (truth_boxes(scores)) ". Through the pose: the model's envelope projected through the pose that the AprilTags give, cut at "
                "the picture's border; nothing hides the model."
            }
            dt { "azimuth" } dd { "0° looks at the front, counter-clockwise from above; 90° is the model's left side." }
        }
    }
}

pub(super) fn provenance(scores: &Scores) -> Markup {
    let p = provenance::of(scores);
    html! {
        p {
            "scaleproof " (p.scaleproof) "; tags: " (p.tag_detector) "; OpenCV " (p.opencv)
            @if let Some(runtime) = &p.onnx_runtime { "; " (runtime) }
            "; candidates from confidence " (p.score_floor) " up."
        }
        div.scroll {
            table {
                thead { tr { th { "detector" } th { "weights (SHA-256)" } th { "origin" } th { "licence" } th { "detections" } } }
                tbody {
                    @for d in &p.detectors {
                        tr {
                            td { (d.title) } td.hash { (d.weights_sha256) } td.text { (d.origin) } td.text { (d.licence) }
                            td.text { (d.source) @if let Some(by) = &d.recorded_by { " by " (by) } }
                        }
                    }
                }
            }
        }
        @for s in &p.sessions {
            details {
                summary { "Session " (s.folder) ": " (s.files.len()) " files" }
                div.scroll {
                    table { tbody { @for (file, hash) in &s.files { tr { td { (file) } td.hash { (hash) } } } } }
                }
            }
        }
    }
}
