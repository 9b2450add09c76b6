//! The tables: headline figures, and figures by viewing direction.

use maud::{Markup, html};

use super::{side, summary, variants};
use crate::score::{BASE_VARIANT, Figures, Scores};

/// Detector × texture, in the layout of the paper's tables, each number beside how many photos it rests on.
pub(super) fn headline(scores: &Scores) -> Markup {
    let variants = variants(scores);
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th { "detector" } th { "texture" } th { "photos" } th { "AP@0.5" } th { "hit rate" br; small { "95 % interval" } }
                        th { "confidence" }
                    }
                }
                tbody {
                    @for c in &scores.contestants {
                        @for (i, variant) in variants.iter().enumerate() {
                            @if let Some(s) = summary(scores, &c.manifest.name, variant) {
                                tr.first[i == 0] {
                                    td { @if i == 0 { (c.manifest.title) @if c.is_recorded() { " " small { "recorded" } } } }
                                    td.text { (variant) }
                                    td { (s.overall.photos) }
                                    td { (number(s.overall.ap50, 3)) (change(s.drop.map(|d| d.ap50), 3)) }
                                    td { (rate(&s.overall)) (change(s.drop.map(|d| d.hit_rate), 2)) }
                                    td { (number(s.overall.mean_confidence, 2)) (change(s.drop.map(|d| d.mean_confidence), 2)) }
                                }
                            }
                        }
                    }
                }
            }
        }
        p.note {
            "AP@0.5 by the definition " (scores.criteria.ap.name()) ": " (scores.criteria.ap.meaning()) ". A hit needs confidence ≥ "
            (scores.criteria.hit_confidence) " and IoU ≥ 0.5. In parentheses: change from " (BASE_VARIANT)
            @if !variants.contains(&BASE_VARIANT) { ", which this run lacks, so no change is given" } "."
        }
    }
}

/// Hits and mean confidence for each azimuth bin.
pub(super) fn by_azimuth(scores: &Scores) -> Markup {
    let centres = scores.sessions[0].scene.bins.azimuth_centres();
    let variants = variants(scores);
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th { "detector" } th { "texture" }
                        @for azimuth in &centres { th { (azimuth) "°" br; small { (side(*azimuth)) } } }
                    }
                }
                tbody {
                    @for c in &scores.contestants {
                        @for (i, variant) in variants.iter().enumerate() {
                            @if let Some(s) = summary(scores, &c.manifest.name, variant) {
                                tr.first[i == 0] {
                                    td { @if i == 0 { (c.manifest.title) } }
                                    td.text { (variant) }
                                    @for bin in &s.azimuth_bins {
                                        td { @match &bin.figures {
                                            Some(f) => { (f.hit_rate.count) "/" (f.photos) br; small { (number(f.mean_confidence, 2)) } }
                                            None => { "–" }
                                        } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
        p.note { "Hits / photos, and mean confidence below. “–”: no photo in this bin. AP per bin is in summary.json." }
    }
}

fn rate(f: &Figures) -> Markup {
    let r = &f.hit_rate;
    html! { (r.count) "/" (f.photos) " " small { "[" (number(r.low, 2)) ", " (number(r.high, 2)) "]" } }
}

/// The change from the base variant; a fall is negative.
fn change(drop: Option<f64>, digits: usize) -> Markup {
    html! {
        @if let Some(drop) = drop {
            " " span.drop.down[drop > 0.0] { "(" (signed(-drop, digits)) ")" }
        }
    }
}

fn number(value: f64, digits: usize) -> String {
    format!("{value:.digits$}")
}

fn signed(value: f64, digits: usize) -> String {
    let text = format!("{:.digits$}", value.abs());
    let is_zero = text.chars().all(|c| matches!(c, '0' | '.'));
    match (is_zero, value < 0.0) {
        (true, _) => format!("±{text}"),
        (false, true) => format!("−{text}"),
        (false, false) => format!("+{text}"),
    }
}

#[cfg(test)]
mod tests {
    use super::signed;

    #[test]
    fn changes_carry_their_sign() {
        assert_eq!(
            (signed(-0.25, 2), signed(0.25, 2), signed(-0.001, 2)),
            ("−0.25".into(), "+0.25".into(), "±0.00".into())
        );
    }
}
