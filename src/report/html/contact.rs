//! Contact sheets: every photo with its truth box and detections, bordered by outcome as in the paper.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, PreEscaped, html};

use super::{side, variants};
use crate::report::other_label;
use crate::score::{Contestant, HIT_CONFIDENCE, ScoredPhoto, Scores, Verdict};

/// Each photo once, hidden; the sheets refer to it, so that ten detectors do not embed it ten times.
pub(super) fn photo_library(scores: &Scores) -> Markup {
    html! {
        svg.library aria-hidden="true" {
            defs {
                @for p in shown(scores) {
                    image id=(format!("photo{}", p.id)) width=(p.width) height=(p.height) preserveAspectRatio="none"
                        href=(format!("data:image/jpeg;base64,{}", STANDARD.encode(&p.preview_jpeg))) {}
                }
            }
        }
    }
}

/// The photos that have a picture: in a large run only some do.
fn shown(scores: &Scores) -> impl Iterator<Item = &ScoredPhoto> {
    scores.photos.iter().filter(|p| !p.preview_jpeg.is_empty())
}

/// One sheet per detector: a group for each viewing direction, so that normal stands beside camouflaged.
pub(super) fn sheets(scores: &Scores) -> Markup {
    let groups = groups(scores);
    let (pictures, photos) = (shown(scores).count(), scores.photos.len());
    html! {
        @if pictures < photos {
            p.note { (format!("{pictures} of {photos} photos are shown, spread evenly; the figures count all, and photos.csv lists all.")) }
        }
        ul.legend {
            li { i style="background:var(--found)" {} "found as the class" }
            li { i style="background:var(--other)" {} "found, but another label on it too" }
            li { i style="background:var(--missed)" {} "missed" }
            li.note { "dashed white: truth box; solid: detections at confidence ≥ 0.5 (blue: the class, orange: another label)" }
        }
        @for (index, contestant) in scores.contestants.iter().enumerate() {
            details open[index == 0] {
                summary { (contestant.manifest.title) }
                div.sheet {
                    @for (azimuth, photos) in &groups {
                        div.group {
                            h3 { (direction(*azimuth)) }
                            div.photos { @for p in photos { (photo(p, index, contestant)) } }
                        }
                    }
                }
            }
        }
    }
}

type Group<'a> = (Option<f64>, Vec<&'a ScoredPhoto>);

/// Photos by azimuth bin from the front on, photos without a viewpoint last; within a bin the base variant first.
fn groups(scores: &Scores) -> Vec<Group<'_>> {
    let order = variants(scores);
    let rank = |p: &&ScoredPhoto| (order.iter().position(|v| *v == p.variant), p.id);
    let centres = scores.sessions[0].scene.bins.azimuth_centres();
    let group = |azimuth: Option<f64>| {
        let mut photos: Vec<_> = shown(scores)
            .filter(|p| p.bin.map(|b| b.azimuth_deg) == azimuth)
            .collect();
        photos.sort_by_key(rank);
        (azimuth, photos)
    };
    let groups = centres.into_iter().map(Some).chain([None]).map(group);
    groups.filter(|(_, photos)| !photos.is_empty()).collect()
}

fn direction(azimuth: Option<f64>) -> String {
    match azimuth {
        Some(azimuth) => format!("{azimuth}° {}", side(azimuth)),
        None => "direction not known".into(),
    }
}

fn photo(p: &ScoredPhoto, index: usize, contestant: &Contestant) -> Markup {
    let outcome = &p.outcomes[index];
    let (class, word) = match outcome.verdict {
        Verdict::Missed => ("missed", "missed"),
        Verdict::FoundWithOther => ("found_with_other", "found"),
        Verdict::Found => ("found", "found"),
    };
    html! {
        figure class=(format!("photo {class}")) {
            (picture(p, index, contestant))
            figcaption {
                b { (word) } @if outcome.confidence > 0.0 { (format!(" {:.2}", outcome.confidence)) }
                @if let Some((label, confidence)) = other_label(p, index, contestant) {
                    (format!(", {label} {confidence:.2}"))
                }
                br;
                (p.variant)
                @if let Some(v) = p.viewpoint { (format!(" · {:.0}°", v.azimuth_deg)) }
                br; small.note { (p.file) }
            }
        }
    }
}

fn picture(p: &ScoredPhoto, index: usize, contestant: &Contestant) -> Markup {
    // Lines keep their thickness whatever the size of the original.
    let stroke = f64::from(p.width) / 200.0;
    let alt = format!("{}, {}", p.file, p.variant);
    html! {
        svg viewBox=(format!("0 0 {} {}", p.width, p.height)) role="img" aria-label=(alt) {
            (PreEscaped(format!("<use href=\"#photo{}\"/>", p.id)))
            rect x=(p.truth.x1) y=(p.truth.y1) width=(p.truth.width()) height=(p.truth.height()) fill="none" stroke="#fff"
                stroke-width=(stroke) stroke-dasharray=(format!("{} {}", 3.0 * stroke, 2.0 * stroke)) {}
            @for d in p.detections[index].iter().filter(|d| d.score >= HIT_CONFIDENCE) {
                @let b = d.box_px;
                rect x=(b.x1) y=(b.y1) width=(b.width()) height=(b.height()) fill="none" stroke-width=(stroke)
                    stroke=(if d.label == contestant.class { "#29a3ff" } else { "#ff8c1a" }) {
                    title { (contestant.labels().name(d.label).unwrap_or("?")) (format!(" {:.2}", d.score)) }
                }
            }
        }
    }
}
