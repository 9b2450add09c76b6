//! `report.html`: one self-contained page; no script, no link to anywhere.

mod contact;
mod figures;
mod notes;
mod polar;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::score::{Scores, Summary};

const STYLE: &str = include_str!("style.css");

/// The whole page.
pub(super) fn render(scores: &Scores) -> String {
    let title = title(scores);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) " · scaleproof" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (contact::photo_library(scores))
                header {
                    h1 { (title) }
                    p.lead { (lead(scores)) }
                    (recorded_banner(scores))
                }
                main {
                    section { h2 { "Result" } (figures::headline(scores)) (notes::cautions(scores)) }
                    section { h2 { "By viewing direction" } (polar::row(scores)) (figures::by_azimuth(scores)) }
                    section { h2 { "Photos" } (contact::sheets(scores)) }
                    (notes::not_scored(scores))
                    section { h2 { "Definitions" } (notes::definitions(scores)) }
                    section { h2 { "Provenance" } (notes::provenance(scores)) }
                }
            }
        }
    }
    .into_string()
}

fn title(scores: &Scores) -> String {
    let mut models: Vec<&str> = scores.sessions.iter().map(|s| s.scene.model.name.as_str()).collect();
    models.dedup();
    models.join(", ")
}

fn lead(scores: &Scores) -> String {
    let model = &scores.sessions[0].scene.model;
    let variants = variants(scores).join(", ");
    let left_out = match scores.not_scored.len() {
        0 => String::new(),
        n => format!(", {n} not scored"),
    };
    format!(
        "1:{} model of a {}, {} photos scored{left_out}; textures: {variants}; {} detectors.",
        model.scale,
        model.class,
        scores.photos.len(),
        scores.contestants.len()
    )
}

fn recorded_banner(scores: &Scores) -> Markup {
    let recorded: Vec<&str> = scores
        .contestants
        .iter()
        .filter(|c| c.is_recorded())
        .map(|c| c.manifest.title.as_str())
        .collect();
    html! {
        @if !recorded.is_empty() {
            p.banner {
                "Recorded detections: no detector ran for this report. The detections of " (recorded.join(", "))
                " were stored with the session by an earlier run; see Provenance."
            }
        }
    }
}

/// Variants in the order of the summaries: the base variant first.
fn variants(scores: &Scores) -> Vec<&str> {
    let mut variants: Vec<&str> = Vec::new();
    for s in &scores.summaries {
        if !variants.contains(&s.variant.as_str()) {
            variants.push(&s.variant);
        }
    }
    variants
}

fn summary<'a>(scores: &'a Scores, detector: &str, variant: &str) -> Option<&'a Summary> {
    scores
        .summaries
        .iter()
        .find(|s| s.detector == detector && s.variant == variant)
}

/// Colours of the variants, in their order: the base variant grey. Told apart in grey print and by the colour-blind.
fn colour(index: usize) -> &'static str {
    ["#5b6573", "#d1495b", "#1f77b4", "#b8860b", "#3a7d44", "#7b4fa0"][index % 6]
}

/// What a viewer standing in a bin sees.
fn side(azimuth_deg: f64) -> &'static str {
    const SIDES: [&str; 8] = [
        "front",
        "front left",
        "left",
        "rear left",
        "rear",
        "rear right",
        "right",
        "front right",
    ];
    SIDES[((azimuth_deg / 45.0).round() as usize) % 8]
}
