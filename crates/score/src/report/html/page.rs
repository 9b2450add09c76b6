//! Frame of a page: self-contained, without a link to anywhere. The one script filters and enlarges photos.

use maud::{Markup, html};

use crate::evaluated::EvaluatedDetector;
use crate::figures::Scores;
use crate::report::words::verdict;
use scaleproof_core::spelling;
use scaleproof_detect::ForeignKind;
use scaleproof_plot::html_page;

const STYLE: &str = include_str!("style.css");
pub(crate) const SCRIPT: &str = include_str!("script.js");

/// A part of a page below its first screen.
pub(crate) struct Section {
    id: &'static str,
    title: &'static str,
    content: Markup,
    /// True if it is opened by a click.
    is_folded: bool,
}

impl Section {
    pub(crate) fn open(id: &'static str, title: &'static str, content: Markup) -> Section {
        Section {
            id,
            title,
            content,
            is_folded: false,
        }
    }

    pub(crate) fn folded(id: &'static str, title: &'static str, content: Markup) -> Section {
        let section = Section::open(id, title, content);
        Section {
            is_folded: true,
            ..section
        }
    }
}

pub(crate) fn shell(scores: &Scores, lead: &str, first: &Markup, sections: &[Section], tail: Markup) -> String {
    let title = title(scores);
    let body = html! {
        header { h1 { (title) } p.lead { (lead) } }
        main {
            section #result { (first) }
            (recorded_banner(scores))
            nav { @for section in sections { a href=(format!("#{}", section.id)) { (section.title) } } }
            @for section in sections {
                @if section.is_folded {
                    // A link to what lies inside opens it.
                    details { summary { (section.title) } section id=(section.id) { (section.content) } }
                } @else {
                    section id=(section.id) { h2 { (section.title) } (section.content) }
                }
            }
        }
        (tail)
    };
    html_page(&title, STYLE, &body)
}

pub(crate) fn title(scores: &Scores) -> String {
    let mut models: Vec<&str> = scores.sessions.iter().map(|s| s.scene.model.name.as_str()).collect();
    models.dedup();
    models.join(", ")
}

/// Returns the line below the title: `1:10 model of a car · 16 photos · 5 detectors, their detections recorded`.
pub(crate) fn lead(scores: &Scores) -> String {
    let model = &scores.sessions[0].scene.model;
    let left_out = match scores.not_scored.len() {
        0 => String::new(),
        n => format!(", {n} not scored"),
    };
    let recorded = scores
        .detectors
        .iter()
        .filter(|detector| detector.is_recorded())
        .count();
    let recorded = match recorded {
        0 => String::new(),
        all if all == scores.detectors.len() => ", their detections recorded".to_owned(),
        some => format!(", {some} of them recorded"),
    };
    format!(
        "1:{} model of a {} · {}{left_out} · {}{recorded}",
        model.scale,
        model.class,
        spelling::count(scores.photos.len(), a_photo(scores)),
        spelling::count(scores.detectors.len(), "detector"),
    )
}

/// Returns the word for a photo of the run: `render` or `photo`.
fn a_photo(scores: &Scores) -> &'static str {
    if verdict::are_renders(scores) {
        "render"
    } else {
        "photo"
    }
}

fn recorded_banner(scores: &Scores) -> Markup {
    let titles = |is: &dyn Fn(&EvaluatedDetector) -> bool| -> Vec<&str> {
        let detectors = scores.detectors.iter().filter(|c| is(c));
        detectors.map(|c| c.manifest.title.as_str()).collect()
    };
    let recorded = titles(&EvaluatedDetector::is_recorded);
    let did_not_run = if recorded.len() == scores.detectors.len() {
        "no detector ran"
    } else {
        "these did not run"
    };
    let results = titles(&|c| c.foreign().is_some_and(|card| card.kind == ForeignKind::Results));
    html! {
        @if !recorded.is_empty() {
            p.banner {
                "Recorded detections: " (did_not_run) " for this report. The detections of " (recorded.join(", "))
                " were stored with the session by an earlier run; see Provenance."
            }
        }
        @if !results.is_empty() {
            p.banner {
                "Detections from outside: another program found those of " (results.join(", ")) " and wrote them into files; see Provenance."
            }
        }
    }
}
