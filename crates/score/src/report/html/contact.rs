//! The contact sheet: every photo with its truth box and detections, bordered by outcome as in the paper, the worst first.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, PreEscaped, html};

use crate::evaluated::EvaluatedDetector;
use crate::figures::{ScoredPhoto, Scores};
use crate::report::html::filters;
use crate::report::words::{number, other_label, side};
use scaleproof_detect::Detection;

/// Largest number of photos that are shown: with more the page would be too large to open.
const MOST_PHOTOS: usize = 400;

/// Least confidence of the detections below the hit confidence that are drawn in an enlarged photo.
const WEAKEST_DRAWN: f64 = 0.1;

fn previewed(scores: &Scores) -> impl Iterator<Item = &ScoredPhoto> {
    scores.photos.iter().filter(|p| !p.preview_jpeg.is_empty())
}

/// Returns the photos that are shown, those that the most detectors missed first, of these the least confident first; at most [`MOST_PHOTOS`].
pub(crate) fn shown(scores: &Scores) -> Vec<&ScoredPhoto> {
    let mut photos: Vec<&ScoredPhoto> = previewed(scores).collect();
    let hits = |p: &ScoredPhoto| p.outcomes.iter().filter(|o| o.is_hit()).count();
    let confidence = |p: &ScoredPhoto| p.outcomes.iter().map(|o| o.confidence).sum::<f64>();
    photos.sort_by(|a, b| hits(a).cmp(&hits(b)).then(confidence(a).total_cmp(&confidence(b))));
    photos.truncate(MOST_PHOTOS);
    photos
}

/// Renders each photo and its tags once, hidden; the sheet refers to them, so that ten detectors do not embed them ten times.
pub(crate) fn photo_library(photos: &[&ScoredPhoto]) -> Markup {
    html! {
        svg.library aria-hidden="true" {
            defs {
                @for p in photos {
                    image id=(format!("photo{}", p.id)) width=(p.width) height=(p.height) preserveAspectRatio="none"
                        href=(format!("data:image/jpeg;base64,{}", STANDARD.encode(&p.preview_jpeg))) {}
                    g id=(format!("tags{}", p.id)) {
                        @for tag in &p.tag_marks {
                            // Pixel (0, 0) is centred on 0, 0 for tags, and on 0.5, 0.5 in a drawing.
                            @let corners = tag.corners_px.map(|[x, y]| format!("{:.1},{:.1}", x + 0.5, y + 0.5)).join(" ");
                            polygon.line points=(corners) fill="none" stroke=(if tag.is_used { "#39e600" } else { "#c0c0c0" }) {}
                            (draw_text(p, tag.corners_px[0], "#39e600", &tag.id.to_string()))
                        }
                    }
                }
            }
        }
    }
}

/// Renders the legend, the filters, and a card for each detector and photo, the worst first.
pub(crate) fn sheet(scores: &Scores) -> Markup {
    let photos = shown(scores);
    let (kept, all) = (previewed(scores).count(), scores.photos.len());
    let mut cards: Vec<(usize, &ScoredPhoto)> = (0..scores.detectors.len())
        .flat_map(|index| photos.iter().map(move |p| (index, *p)))
        .collect();
    cards.sort_by(|(i, p), (j, q)| {
        let (a, b) = (&p.outcomes[*i], &q.outcomes[*j]);
        let by_rank = (a.verdict as usize).cmp(&(b.verdict as usize));
        by_rank
            .then(a.confidence.total_cmp(&b.confidence))
            .then((i, p.id).cmp(&(j, q.id)))
    });
    html! {
        ul.legend {
            li { i style="background:var(--found)" {} "hit: found as the class" }
            li { i style="background:var(--other)" {} "hit, but another label on it too" }
            li { i.misclassified {} "missed: misclassified, only another class at this confidence" }
            li { i.disappeared {} "missed: disappeared, no detection of any class at this confidence" }
            li.note {
                "dashed white: truth box; solid: detections at confidence ≥ " (scores.criteria.hit_confidence)
                " (blue: the class, orange: another label)"
            }
        }
        @if photos.len() < all {
            p.banner {
                "Shown are the " (photos.len()) " of " (all) " photos that the most detectors missed"
                @if kept < all { ", among " (kept) " that the run kept previews of" }
                "; all are in photos.csv."
            }
        }
        (filters::bar(scores, &photos, &filters::OUTCOMES, "worst first"))
        div #sheet {
            @for (index, p) in cards { (card(scores, p, index)) }
        }
    }
}

fn card(scores: &Scores, p: &ScoredPhoto, index: usize) -> Markup {
    let detector = &scores.detectors[index];
    let outcome = &p.outcomes[index];
    let texture = scores.variants().iter().position(|v| *v == p.variant);
    let texture = texture.unwrap_or_default();
    let class = filters::outcome_key(outcome);
    let word = if outcome.is_hit() { "found" } else { class };
    html! {
        figure class=(format!("photo {class}")) data-detector=(detector.manifest.name) data-variant=(p.variant)
            data-outcome=(filters::outcome_key(outcome)) data-azimuth=[p.bin.map(|b| b.azimuth_deg)]
            data-pitch=[p.bin.map(|b| b.pitch_deg)] data-distance=[p.bin.map(|b| b.distance_mm)] data-texture=(texture) {
            (photo_view(scores, p, index))
            figcaption {
                b { (word) } @if outcome.confidence > 0.0 { (format!(" {}", number(outcome.confidence, 2))) }
                @if let Some((label, confidence)) = other_label(p, index, detector) {
                    (format!(", {label} {}", number(confidence, 2)))
                }
                br; (p.variant) " · " (direction(p))
                br; (detector.manifest.title)
                br; small.note { (p.file) @for fact in facts(p) { br; (fact) } }
            }
        }
    }
}

/// Returns σ and rms of the photo's pose, the time it was taken and its exposure, where they are known.
fn facts(p: &ScoredPhoto) -> Vec<String> {
    let quality = p.rms_px.zip(p.sigma).map(|(rms_px, sigma)| {
        let [azimuth, pitch, distance] = [sigma.azimuth_deg, sigma.pitch_deg, sigma.distance_mm].map(two_digits);
        format!("pose: σ azimuth {azimuth}°, pitch {pitch}°, distance {distance} mm; rms {rms_px:.2} px")
    });
    [quality, p.taken.clone(), p.exposure.clone()]
        .into_iter()
        .flatten()
        .collect()
}

/// Formats a size with two significant digits, at most four behind the point.
fn two_digits(size: f64) -> String {
    let digits = (1.0 - size.max(1e-3).log10().floor()).clamp(0.0, 4.0) as usize;
    format!("{size:.digits$}")
}

fn direction(p: &ScoredPhoto) -> String {
    let Some(v) = p.viewpoint else {
        return "direction not known".into();
    };
    format!("{:.0}° {}", v.azimuth_deg, side(v.azimuth_deg))
}

/// Draws the whole photo.
pub(crate) fn photo_view(scores: &Scores, p: &ScoredPhoto, index: usize) -> Markup {
    view(scores, p, index, [0.0, 0.0, f64::from(p.width), f64::from(p.height)])
}

/// Draws the part of the photo around the model, 4 : 3.
pub(crate) fn model_view(scores: &Scores, p: &ScoredPhoto, index: usize) -> Markup {
    let (width, height) = (f64::from(p.width), f64::from(p.height));
    let (b, most) = (&p.truth, width.min(height * RATIO));
    let wide = (AROUND * b.width().max(b.height() * RATIO)).min(most);
    let high = wide / RATIO;
    let left = ((b.x1 + b.x2 - wide) / 2.0).clamp(0.0, width - wide);
    let top = ((b.y1 + b.y2 - high) / 2.0).clamp(0.0, height - high);
    view(scores, p, index, [left, top, wide, high])
}

/// Ratio of width to height of the part around a model.
const RATIO: f64 = 4.0 / 3.0;
/// Ratio of the size of that part to the size of the model.
const AROUND: f64 = 1.5;

/// Draws a part of a photo (x, y, width and height in its pixels) with the detections of one detector.
fn view(scores: &Scores, p: &ScoredPhoto, index: usize, part: [f64; 4]) -> Markup {
    let detector = &scores.detectors[index];
    let threshold = scores.criteria.hit_confidence;
    let (strong, weak): (Vec<&Detection>, Vec<&Detection>) =
        p.detections[index].iter().partition(|d| d.score >= threshold);
    let is_weak_find = |d: &&&Detection| {
        detector.counts(d) && d.score >= WEAKEST_DRAWN && d.box_px.iou(&p.truth) >= scores.criteria.match_iou()
    };
    let alt = format!("{}, {}, {}", p.file, p.variant, detector.manifest.title);
    html! {
        svg viewBox=(part.map(|v| format!("{v:.0}")).join(" ")) role="img" aria-label=(alt) {
            (PreEscaped(format!("<use href=\"#photo{0}\"/><use class=\"fine\" href=\"#tags{0}\"/>", p.id)))
            (rectangle(&p.truth.to_xywh(), "#fff", Some("6 4")))
            @for d in &strong { (detection(d, detector, None)) }
            g.fine {
                @for d in weak.iter().filter(is_weak_find) { (detection(d, detector, Some("2 3"))) }
                @for d in strong.iter().copied().chain(weak.iter().filter(is_weak_find).copied()) { (draw_label(p, d, detector)) }
                (draw_text(p, [p.truth.x1, p.truth.y2 + 1.2 * letter(p)], "#fff", "truth"))
            }
        }
    }
}

fn detection(d: &Detection, detector: &EvaluatedDetector, dashes: Option<&str>) -> Markup {
    rectangle(&d.box_px.to_xywh(), paint(d, detector), dashes)
}

fn paint(d: &Detection, detector: &EvaluatedDetector) -> &'static str {
    if detector.counts(d) { "#29a3ff" } else { "#ff8c1a" }
}

/// Draws the label and confidence above a detection's box, or in it at the photo's upper edge.
fn draw_label(p: &ScoredPhoto, d: &Detection, detector: &EvaluatedDetector) -> Markup {
    let label = detector.labels().name(d.label).unwrap_or("?");
    let above = d.box_px.y1 - 0.3 * letter(p);
    let y = if above < letter(p) {
        d.box_px.y1 + 1.1 * letter(p)
    } else {
        above
    };
    let content = format!("{label} {}", number(d.score, 2));
    draw_text(p, [d.box_px.x1, y], paint(d, detector), &content)
}

fn rectangle([x, y, width, height]: &[f64; 4], colour: &str, dashes: Option<&str>) -> Markup {
    let tenth = |v: &f64| format!("{v:.1}");
    html! {
        rect.line x=(tenth(x)) y=(tenth(y)) width=(tenth(width)) height=(tenth(height)) fill="none" stroke=(colour) stroke-dasharray=[dashes] {}
    }
}

/// Returns the height of letters in pixels of the photo.
fn letter(p: &ScoredPhoto) -> f64 {
    f64::from(p.width.max(p.height)) / 65.0
}

fn draw_text(p: &ScoredPhoto, [x, y]: [f64; 2], colour: &str, content: &str) -> Markup {
    html! {
        text x=(format!("{x:.1}")) y=(format!("{y:.1}")) font-size=(format!("{:.1}", letter(p))) fill=(colour) { (content) }
    }
}
