//! `report.html` and `comparison.html`: self-contained pages without a link to anywhere. The one script filters and enlarges photos.

pub mod comparison;
mod contact;
pub(super) mod curves;
mod defences;
pub(super) mod evaluation;
mod filters;
mod first;
pub(super) mod heat;
pub(super) mod interval_chart;
mod misses;
mod notes;
mod pairs;
mod patterns;
pub mod polar;
mod ranking;
pub(super) mod reliability;
pub(super) mod robustness;
mod sequential;
pub(super) mod speed;
mod strip;

use maud::{Markup, PreEscaped, html};

use crate::compare::paired as all_paired;
use crate::evaluated::EvaluatedDetector;
use crate::figures::{Scores, Summary};
use crate::report::paper::Judged;
use crate::report::table::Table;
use crate::report::{tables, verdict};
use scaleproof_core::spelling;
use scaleproof_detect::{ForeignKind, Speeds};
use scaleproof_plot::Anchor::{End, Middle};
use scaleproof_plot::{BLACK, Colour, Drawing, FAINT, Mark, NOTE, html_page};

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Largest number of columns of detectors or patterns that a laptop shows without scrolling.
const ACROSS: usize = 8;

/// Renders the page of a scoring run; without `speeds` there is no chart of AP against time.
pub fn render(scores: &Scores, speeds: Option<&Speeds>) -> String {
    let (results, base) = (all_paired(scores), scores.base.as_str());
    let library = first::library(scores, results, base, contact::shown(scores));
    let tail = html! { (library) script { (PreEscaped(SCRIPT)) } };
    let first = first::screen(scores, results, base);
    shell(scores, &lead(scores), &first, &sections(scores, speeds), tail)
}

/// A part of a page below its first screen.
struct Section {
    id: &'static str,
    title: &'static str,
    content: Markup,
    /// True if it is opened by a click.
    is_folded: bool,
}

impl Section {
    fn open(id: &'static str, title: &'static str, content: Markup) -> Section {
        Section {
            id,
            title,
            content,
            is_folded: false,
        }
    }

    fn folded(id: &'static str, title: &'static str, content: Markup) -> Section {
        let section = Section::open(id, title, content);
        Section {
            is_folded: true,
            ..section
        }
    }
}

fn shell(scores: &Scores, lead: &str, first: &Markup, sections: &[Section], tail: Markup) -> String {
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

fn sections(scores: &Scores, speeds: Option<&Speeds>) -> Vec<Section> {
    let table = |table: Table| html! { h3 { (table.caption) } (table.markup()) };
    let figures = html! { (table(tables::figures(scores))) (table(tables::papers(scores))) @for transfer in tables::transferred(scores, ACROSS) { (table(transfer)) } };
    let outcomes = html! { (misses::outcomes(scores)) (table(tables::taken(scores))) };
    let directions = html! { (polar::row(scores)) (heat::maps(scores)) };
    let photos = html! { (contact::sheet(scores)) (notes::not_scored(scores)) };
    let conditions: Vec<Table> = tables::conditions(scores);
    let conditions = (!conditions.is_empty()).then(|| html! { @for condition in conditions { (table(condition)) } });
    let method = notes::method(scores, all_paired(scores), &scores.base, Judged::default());
    let chance = "the bootstrap behind the intervals of drops has its own seed";
    let open = [
        ("conditions", "By condition", conditions),
        ("robustness", "On photos made worse", robustness::section(scores)),
        ("defences", "On defended photos", defences::section(scores)),
        (
            "ranking",
            "Order of the textures in other sessions",
            ranking::section(scores),
        ),
        ("directions", "By viewing direction", Some(directions)),
        ("photos", "Photos", Some(photos)),
    ];
    let folded = [
        ("protocol", "Protocol", tables::protocol(scores).map(table)),
        ("method", "How this was decided, and what to write", Some(method)),
        ("comparable", "All figures, for comparison with papers", Some(figures)),
        ("outcomes", "Hits and misses", Some(outcomes)),
        ("patterns", "Patterns", patterns::cards(scores)),
        ("curves", "Curves", Some(curves::section(scores))),
        (
            "reliability",
            "Reliability of the confidences",
            Some(reliability::diagrams(scores)),
        ),
        ("speed", "AP against time", Some(speed::chart(scores, speeds))),
        ("definitions", "Definitions", Some(notes::definitions(scores))),
        ("provenance", "Provenance", Some(notes::provenance(scores, chance))),
    ];
    let open = open
        .into_iter()
        .filter_map(|(id, title, content)| Some(Section::open(id, title, content?)));
    let folded = folded
        .into_iter()
        .filter_map(|(id, title, content)| Some(Section::folded(id, title, content?)));
    open.chain(folded).collect()
}

fn title(scores: &Scores) -> String {
    let mut models: Vec<&str> = scores.sessions.iter().map(|s| s.scene.model.name.as_str()).collect();
    models.dedup();
    models.join(", ")
}

/// Returns the line below the title: `1:10 model of a car · 16 photos · 5 detectors, their detections recorded`.
fn lead(scores: &Scores) -> String {
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

/// Renders a table that scrolls sideways where it is wider than the page.
fn table(class: Option<&str>, head: &Markup, rows: &Markup) -> Markup {
    html! { div.scroll { table class=[class] { thead { tr { (head) } } tbody { (rows) } } } }
}

/// Renders the heads of a table whose first column may be a number and whose others are text.
fn heads(first: &str, others: &[&str]) -> Markup {
    html! { th { (first) } @for name in others { th.text { (name) } } }
}

/// Renders the rows of a table of detectors and textures; a detector's name stands in the first of its rows alone.
fn rows_by_detector(
    scores: &Scores,
    name: impl Fn(&EvaluatedDetector) -> Markup,
    cells: impl Fn(&Summary) -> Markup,
) -> Markup {
    html! {
        @for c in &scores.detectors {
            @for (i, variant) in scores.variants().into_iter().enumerate() {
                @if let Some(s) = scores.summary(&c.manifest.name, variant) {
                    tr.first[i == 0] { td { @if i == 0 { (name(c)) } } td.text { (variant) } (cells(s)) }
                }
            }
        }
    }
}

fn title_of(detector: &EvaluatedDetector) -> Markup {
    html! { (detector.manifest.title) }
}

/// Renders the entries of a legend: names by the colours of the variants, in their order.
fn colour_names(names: &[&str]) -> Markup {
    html! { @for (i, name) in names.iter().enumerate() { li { i style=(format!("background:{}", colour(i))) {} (name) } } }
}

fn small_charts(charts: impl IntoIterator<Item = (Markup, Drawing)>) -> Markup {
    html! {
        div.small-charts {
            @for (caption, chart) in charts { figure { (chart.inline(None)) figcaption { (caption) } } }
        }
    }
}

/// Plot area for shares from 0 to 1, one to the right and one up; its size in px.
struct Plane {
    width: f64,
    height: f64,
}

/// Plot area in which both shares have the same length.
const SQUARE: Plane = Plane {
    width: SIDE,
    height: SIDE,
};
const SIDE: f64 = 180.0;

impl Plane {
    fn at(&self, across: f64, up: f64) -> [f64; 2] {
        [across * self.width, (1.0 - up) * self.height]
    }

    /// Draws lines at 0, 0.5 and 1 with their numbers at x = `left`; upright lines too where `below` has the place of their numbers below the area.
    fn grid(&self, left: f64, below: Option<f64>) -> Vec<Mark> {
        let mut marks = Vec::new();
        for tick in [0.0, 0.5, 1.0] {
            let [x, y] = self.at(tick, tick);
            marks.extend(below.map(|_| Mark::line([x, 0.0], [x, self.height], FAINT)));
            marks.push(Mark::line([0.0, y], [self.width, y], FAINT));
            marks.extend(below.map(|below| Mark::text([x, self.height + below], 9.0, Middle, NOTE, tick)));
            marks.push(Mark::text([left, y + 3.0], 9.0, End, NOTE, tick));
        }
        marks
    }

    /// Draws the title of the upright axis, along it.
    fn upright_title(&self, left: f64, title: &str) -> Mark {
        Mark::text([left, self.height / 2.0], 10.0, Middle, BLACK, title).upright()
    }
}

/// Returns the colours of the variants, with their names.
pub(super) fn legend(scores: &Scores) -> Vec<(Colour, String)> {
    let all = scores.variants().into_iter().enumerate();
    all.map(|(i, variant)| (colour(i), variant.to_owned())).collect()
}

/// Returns the colour of the variant at `index`; the base variant is grey. None is a colour of an outcome.
fn colour(index: usize) -> Colour {
    Colour([0x5b6573, 0x0f7f8c, 0x1f4fb4, 0xa0522d, 0xb03a9b, 0x4a4a9c][index % 6])
}

/// Returns the side of the model that is seen from an azimuth: `front left`.
fn side(azimuth_deg: f64) -> &'static str {
    const SIDES: &str = "front, front left, left, rear left, rear, rear right, right, front right";
    let eighth = ((azimuth_deg / 45.0).round() as usize) % 8;
    SIDES.split(", ").nth(eighth).unwrap_or_default()
}
