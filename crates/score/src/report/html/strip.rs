//! Photos of the base and of each texture side by side: the view that lost most, the median, and the one that lost least.

use maud::{Markup, html};

use crate::compare::paired_photos;
use crate::figures::{Compared, ScoredPhoto, Scores};
use crate::report::Findings;
use crate::report::html::contact;
use crate::report::words::{number, side};
use scaleproof_plot::distinct;

/// Largest number of textures: more would push the chart off the first screen.
const MOST_TEXTURES: usize = 2;

/// Photos of one view: of the base, of the texture.
type Pair<'a> = (&'a ScoredPhoto, &'a ScoredPhoto);

/// The views of a texture that are shown, as one detector sees them.
struct Strip<'a> {
    texture: &'a str,
    /// Index of the detector in the run.
    detector: usize,
    views: Vec<(&'static str, Pair<'a>)>,
}

/// Renders a row for each of the textures that weaken a detector most.
pub(crate) fn rows(findings: Findings) -> Markup {
    let (scores, base) = (findings.scores, findings.base);
    let strips = strips(findings);
    html! {
        @for (i, strip) in strips.iter().enumerate() {
            @let title = &scores.detectors[strip.detector].manifest.title;
            div.views {
                @for (name, pair) in &strip.views { (view(scores, strip, name, *pair)) }
            }
            p.note.under {
                (base) " | " (strip.texture) ", as " (title) " sees them, with its confidence"
                @if i == 0 { " (dashed: the model; blue: found; orange: taken for something else)" } "."
            }
        }
    }
}

fn view(scores: &Scores, strip: &Strip, name: &str, (base, other): Pair) -> Markup {
    let [a, b] = [base, other].map(|photo| number(photo.outcomes[strip.detector].confidence, 2));
    html! {
        figure {
            div.two { (contact::model_view(scores, base, strip.detector)) (contact::model_view(scores, other, strip.detector)) }
            figcaption {
                b { (a) " → " (b) } " " (name)
                @if let Some(bin) = other.bin { ", " (side(bin.azimuth_deg)) }
            }
        }
    }
}

/// Returns the photos that the strips show.
pub(crate) fn photos<'a>(findings: Findings<'a>) -> Vec<&'a ScoredPhoto> {
    let strips = strips(findings);
    let views = strips.iter().flat_map(|strip| &strip.views);
    views.flat_map(|(_, (base, other))| [*base, *other]).collect()
}

fn strips<'a>(findings: Findings<'a>) -> Vec<Strip<'a>> {
    let textures = distinct(findings.results.iter().map(|r| r.variant.as_str()));
    let mut strips: Vec<(f64, Strip)> = textures
        .into_iter()
        .filter_map(|texture| strip(findings, texture))
        .collect();
    // Keeps the largest drops, in the order of the textures.
    let mut drops: Vec<f64> = strips.iter().map(|(drop, _)| *drop).collect();
    drops.sort_by(|a, b| b.total_cmp(a));
    let least = drops.get(MOST_TEXTURES - 1).copied().unwrap_or(f64::NEG_INFINITY);
    strips.retain(|(drop, _)| *drop >= least);
    strips.into_iter().map(|(_, strip)| strip).take(MOST_TEXTURES).collect()
}

/// Returns the drop and the views of a texture for the detector whose confidence falls most, shown effects first; `None` where the run kept no
/// previews.
fn strip<'a>(findings: Findings<'a>, texture: &'a str) -> Option<(f64, Strip<'a>)> {
    let scores = findings.scores;
    let own = findings.results.iter().filter(|r| r.variant == texture);
    let most = own.max_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal))?;
    let detector = scores.detectors.iter().position(|d| d.manifest.name == most.detector)?;
    let lost = |(base, other): &Pair| base.outcomes[detector].confidence - other.outcomes[detector].confidence;
    let mut pairs = paired_photos(scores, findings.base, texture);
    pairs.retain(|(base, other)| !base.preview_jpeg.is_empty() && !other.preview_jpeg.is_empty());
    pairs.sort_by(|a, b| lost(b).total_cmp(&lost(a)).then(a.1.id.cmp(&b.1.id)));
    let views = match pairs.as_slice() {
        [] => return None,
        [only] => vec![("the only view", *only)],
        [most, least] => vec![("lost most", *most), ("lost least", *least)],
        all => vec![
            ("lost most", all[0]),
            ("median", all[all.len() / 2]),
            ("lost least", all[all.len() - 1]),
        ],
    };
    let strip = Strip {
        texture,
        detector,
        views,
    };
    Some((most.mean_confidence.drop, strip))
}

fn rank(r: &Compared) -> (bool, f64) {
    (r.effect().is_shown(), r.mean_confidence.drop)
}
