//! Patterns of a run's textures, and some photos of each texture.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};

use crate::figures::{ScoredPhoto, Scores, TexturePattern};

/// Number of photos that show a texture on the model.
const STRIP: usize = 8;

/// Renders each known pattern, and names the textures whose pattern is not known; `None` for a run of the plain model alone.
pub(crate) fn cards(scores: &Scores) -> Option<Markup> {
    let variants = scores.variants();
    let textures = || variants.iter().filter(|v| **v != scores.base);
    let unknown: Vec<&str> = textures()
        .filter(|v| pattern_of(scores, v).is_none())
        .copied()
        .collect();
    textures().next()?;
    Some(html! {
        @if !scores.patterns.is_empty() {
            div.patterns { @for pattern in &scores.patterns { figure { (image(pattern)) figcaption { (facts(pattern)) ", print " (print(pattern)) "." (hash(pattern)) } } } }
        }
        @if !unknown.is_empty() {
            p.note {
                "Not given: the pattern of " (unknown.join(", ")) ". " code { "score --pattern NAME=FILE" }
                " shows it, with its hash and tile size; without it, this report does not say what was printed."
            }
        }
    })
}

/// Renders each texture with its pattern, where it has one, and some of its photos.
pub(crate) fn strips(scores: &Scores, textures: &[String]) -> Markup {
    html! {
        @for texture in textures {
            h3 { (texture) }
            @if let Some(pattern) = pattern_of(scores, texture) { div.patterns { figure { (image(pattern)) figcaption { (facts(pattern)) "." (hash(pattern)) } } } }
            div.strip {
                @for photo in spread(scores, texture) {
                    img alt=(photo.file) title=(photo.file) src=(format!("data:image/jpeg;base64,{}", STANDARD.encode(&photo.preview_jpeg)));
                }
            }
        }
        p.note { "The same viewpoints in each row, spread over all; hover for a photo's name. All are in the folder session." }
    }
}

fn pattern_of<'a>(scores: &'a Scores, variant: &str) -> Option<&'a TexturePattern> {
    scores.patterns.iter().find(|p| p.variant == variant)
}

/// Returns photos of a texture, evenly spread over those that have a preview.
fn spread<'a>(scores: &'a Scores, variant: &str) -> Vec<&'a ScoredPhoto> {
    let is_own = |p: &&ScoredPhoto| p.variant == variant && !p.preview_jpeg.is_empty();
    let own: Vec<&ScoredPhoto> = scores.photos.iter().filter(is_own).collect();
    let count = own.len().min(STRIP);
    (0..count).map(|i| own[i * own.len() / count]).collect()
}

fn image(pattern: &TexturePattern) -> Markup {
    let source = format!("data:image/png;base64,{}", STANDARD.encode(&pattern.png));
    html! { img alt=(format!("The pattern of {}", pattern.variant)) src=(source); }
}

fn facts(pattern: &TexturePattern) -> Markup {
    let [columns, rows] = pattern.cells;
    html! {
        b { (pattern.variant) } ", " (pattern.file) ": " (columns) " × " (rows) " cells, a repeat "
        @match pattern.tile_mm { Some(mm) => { (mm) " mm wide on the model" } None => { "of unknown width" } }
    }
}

fn print(pattern: &TexturePattern) -> String {
    pattern.print_delta_e.map_or("not measured".to_owned(), |off| {
        format!("off by ΔE2000 {off:.1} (mean over cells)")
    })
}

fn hash(pattern: &TexturePattern) -> Markup {
    html! { br; small { "SHA-256 " (pattern.sha256) } }
}
