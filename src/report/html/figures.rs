//! The headline table, in the layout of the paper's tables: detector × texture.

use maud::{Markup, html};

use super::{number, summary, variants};
use crate::score::{BASE_VARIANT, Figures, MATCH_IOU, Scores};

/// Each number beside how many photos it rests on, and its drop from the base variant.
pub(super) fn headline(scores: &Scores) -> Markup {
    let variants = variants(scores);
    html! {
        div.scroll {
            table.headline {
                thead {
                    tr {
                        th { "detector" } th.text { "texture" } th.photos { "photos" }
                        th { "AP@0.5" } th.of { "drop" }
                        th { "hit rate" br; small { "95 % interval" } } th.of { "drop" }
                        th { "confidence" br; small { "mean" } } th.of { "drop" }
                        th { br; small { "median" } }
                    }
                }
                tbody {
                    @for c in &scores.detectors {
                        @for (i, variant) in variants.iter().enumerate() {
                            @if let Some(s) = summary(scores, &c.manifest.name, variant) {
                                tr.first[i == 0] {
                                    td { @if i == 0 { (c.manifest.title) @if !c.is_live() { " " small.recorded { (c.source_name()) } } } }
                                    td.text { (variant) }
                                    td.photos { (s.overall.photos) }
                                    td { (number(s.overall.ap50, 3)) } td.of { (drop(s.drop.map(|d| d.ap50), 3)) }
                                    td { (rate(&s.overall)) } td.of { (drop(s.drop.map(|d| d.hit_rate), 2)) }
                                    td { (number(s.overall.mean_confidence, 2)) }
                                    td.of { (drop(s.drop.map(|d| d.mean_confidence), 2)) }
                                    td { (number(s.overall.median_confidence, 2)) }
                                }
                            }
                        }
                    }
                }
            }
        }
        p.note {
            "AP@0.5: " (scores.criteria.ap.name()) " (" (scores.criteria.ap.meaning()) "). A hit: confidence ≥ "
            (scores.criteria.hit_confidence) " and IoU ≥ " (MATCH_IOU) ". Confidence: misses count 0. Drop: " (BASE_VARIANT)
            " minus this texture; above 0, the detector does worse"
            @if !variants.contains(&BASE_VARIANT) { ". This run lacks " (BASE_VARIANT) ", so no drop is given" } "."
        }
    }
}

fn rate(f: &Figures) -> Markup {
    let r = &f.hit_rate;
    html! { (r.count) "/" (f.photos) " " small { "[" (number(r.low, 2)) ", " (number(r.high, 2)) "]" } }
}

/// A fall of the figure is positive, and marked.
fn drop(drop: Option<f64>, digits: usize) -> Markup {
    html! {
        @if let Some(drop) = drop { span.down[drop > 0.0] { (number(drop, digits)) } }
    }
}
