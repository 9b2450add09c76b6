//! Error against time, with a third figure as the filled share of each mark.

use std::f64::consts::TAU;

use maud::{Markup, html};

use super::axis::tick_label;
use super::{FAINT, INK, NOTE, PlotAxis, colour, document, round};

/// Outlines of the marks, the n-th for the n-th shape; the first is a circle, and a sixth shape starts over.
const OUTLINES: [Option<&str>; 5] = [
    None,
    Some("-5.5,-5.5 5.5,-5.5 5.5,5.5 -5.5,5.5"),
    Some("0,-7.5 7.5,0 0,7.5 -7.5,0"),
    Some("0,-7.5 7,5.5 -7,5.5"),
    Some("0,7.5 7,-5.5 -7,-5.5"),
];

/// One measured method.
#[derive(Debug, Clone, PartialEq)]
pub struct Dot {
    pub x: f64,
    pub y: f64,
    /// How much of the mark is filled, 0 to 1.
    pub share: f64,
    /// Index into the colours' names.
    pub series: usize,
    pub shape: usize,
    /// Written beside it.
    pub name: Option<String>,
    pub is_ringed: bool,
}

/// Dots over shared axes, with what colours and shapes stand for.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    pub title: String,
    /// One line: what the third mark is.
    pub note: String,
    pub x: PlotAxis,
    pub y: PlotAxis,
    pub colours: Vec<String>,
    pub shapes: Vec<String>,
    /// What the ring means.
    pub ringed: String,
    /// One plot each, side by side.
    pub groups: Vec<(String, Vec<Dot>)>,
}

/// Width of a plot: of one of several, and of one alone.
const WIDTHS: [f64; 2] = [300.0, 520.0];
const HEIGHT: f64 = 300.0;
/// Of a letter of the note.
const LETTER: f64 = 6.2;
const LEFT: f64 = 62.0;
const TOP: f64 = 78.0;
const GAP: f64 = 26.0;
const FOOT: f64 = 44.0;
const LEGEND_ROW: f64 = 17.0;
const RADIUS: f64 = 6.0;

impl Cloud {
    fn plot_width(&self) -> f64 {
        WIDTHS[usize::from(self.groups.len() == 1)]
    }
}

pub fn scatter(cloud: &Cloud) -> String {
    let groups = cloud.groups.len().max(1) as f64;
    let of_note = 32.0 + LETTER * cloud.note.chars().count() as f64;
    let width = (LEFT + groups * (cloud.plot_width() + GAP)).max(of_note);
    let rows = cloud.colours.len().max(cloud.shapes.len() + 1) as f64;
    let height = TOP + HEIGHT + FOOT + rows * LEGEND_ROW + 10.0;
    let content = html! {
        text x="16" y="26" font-size="16" font-weight="bold" fill=(INK) { (cloud.title) }
        text x="16" y="45" font-size="11" fill=(NOTE) { (cloud.note) }
        @for (i, (name, dots)) in cloud.groups.iter().enumerate() {
            g transform=(format!("translate({} {TOP})", LEFT + i as f64 * (cloud.plot_width() + GAP))) {
                text x=(cloud.plot_width() / 2.0) y="-10" font-size="12" text-anchor="middle" fill=(INK) { (name) }
                (grid(cloud, i == 0))
                @for dot in dots { (mark(cloud, dot)) }
                (names(cloud, dots))
            }
        }
        g transform=(format!("translate({LEFT} {})", TOP + HEIGHT + FOOT + 12.0)) { (legend(cloud)) }
    };
    document(width, height, &cloud.title, &content)
}

fn grid(cloud: &Cloud, with_y_labels: bool) -> Markup {
    let width = cloud.plot_width();
    html! {
        @for tick in cloud.x.ticks() {
            @let x = round(cloud.x.share(tick) * width);
            line x1=(x) x2=(x) y2=(HEIGHT) stroke=(FAINT) {}
            text x=(x) y=(HEIGHT + 14.0) font-size="10" text-anchor="middle" fill=(NOTE) { (tick_label(tick)) }
        }
        @for tick in cloud.y.ticks() {
            @let y = round((1.0 - cloud.y.share(tick)) * HEIGHT);
            line x2=(width) y1=(y) y2=(y) stroke=(FAINT) {}
            @if with_y_labels { text x="-6" y=(y + 3.5) font-size="10" text-anchor="end" fill=(NOTE) { (tick_label(tick)) } }
        }
        rect width=(width) height=(HEIGHT) fill="none" stroke=(NOTE) {}
        text x=(width / 2.0) y=(HEIGHT + 32.0) font-size="11" text-anchor="middle" fill=(INK) { (cloud.x.title) }
        @if with_y_labels {
            text transform=(format!("translate(-44 {}) rotate(-90)", HEIGHT / 2.0)) font-size="11" text-anchor="middle"
                fill=(INK) { (cloud.y.title) }
        }
    }
}

fn place(cloud: &Cloud, dot: &Dot) -> [f64; 2] {
    [
        round(cloud.x.share(dot.x) * cloud.plot_width()),
        round((1.0 - cloud.y.share(dot.y)) * HEIGHT),
    ]
}

fn mark(cloud: &Cloud, dot: &Dot) -> Markup {
    let [x, y] = place(cloud, dot);
    html! {
        g transform=(format!("translate({x} {y})")) {
            @if dot.is_ringed { circle r=(RADIUS + 4.5) fill="none" stroke=(INK) stroke-width="1.5" {} }
            (symbol(dot.series, dot.shape, dot.share))
        }
    }
}

/// An outline with a clockwise sector of it filled.
fn symbol(series: usize, shape: usize, share: f64) -> Markup {
    let paint = colour(series);
    let share = share.clamp(0.0, 1.0);
    let points = OUTLINES[shape % OUTLINES.len()];
    let outline = |fill: &str, opacity: &str| match points {
        None => html! { circle r=(RADIUS) fill=(fill) fill-opacity=(opacity) stroke=(paint) stroke-width="1.5" {} },
        Some(points) => {
            html! { polygon points=(points) fill=(fill) fill-opacity=(opacity) stroke=(paint) stroke-width="1.5" {} }
        }
    };
    html! {
        @if share > 0.9995 { (outline(paint, "0.85")) } @else {
            (outline("#fff", "1"))
            @if share > 0.0 { path d=(sector(share)) fill=(paint) fill-opacity="0.85" {} }
        }
    }
}

/// A clockwise sector from the top that is this share of a mark, as an SVG path.
pub fn sector(share: f64) -> String {
    let (sin, cos) = (share * TAU).sin_cos();
    let r = RADIUS - 1.0;
    let (x, y) = (round(r * sin), round(-r * cos));
    let large = u8::from(share > 0.5);
    format!("M0 0V{}A{r} {r} 0 {large} 1 {x} {y}Z", -r)
}

/// The written names, moved down where two would cover each other.
fn names(cloud: &Cloud, dots: &[Dot]) -> Markup {
    let mut named: Vec<([f64; 2], &str)> = dots
        .iter()
        .filter_map(|dot| Some((place(cloud, dot), dot.name.as_deref()?)))
        .collect();
    named.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
    let mut lowest = f64::NEG_INFINITY;
    for (at, _) in &mut named {
        at[1] = at[1].max(lowest + 11.0);
        lowest = at[1];
    }
    html! {
        @for ([x, y], name) in named {
            @let (anchor, dx) = if x > 0.6 * cloud.plot_width() { ("end", -13.0) } else { ("start", 13.0) };
            text x=(round(x + dx)) y=(round(y + 3.5)) font-size="10" text-anchor=(anchor) fill=(INK) stroke="#fff"
                stroke-width="3" paint-order="stroke" { (name) }
        }
    }
}

fn legend(cloud: &Cloud) -> Markup {
    let entry = |x: f64, row: usize, mark: Markup, name: &str| {
        html! {
            g transform=(format!("translate({x} {})", row as f64 * LEGEND_ROW)) {
                (mark)
                text x="14" y="4" font-size="11" fill=(INK) { (name) }
            }
        }
    };
    let ring = html! { circle r=(RADIUS + 3.0) fill="none" stroke=(INK) stroke-width="1.5" {} };
    html! {
        @for (i, name) in cloud.colours.iter().enumerate() { (entry(6.0, i, symbol(i, 0, 1.0), name)) }
        @for (i, name) in cloud.shapes.iter().enumerate() { (entry(230.0, i, symbol(6, i, 0.0), name)) }
        (entry(230.0, cloud.shapes.len(), ring, &cloud.ringed))
    }
}
