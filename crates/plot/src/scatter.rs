//! Scatter plot of error against time, with a third value as the filled share of each mark.

use std::f64::consts::TAU;

use super::axis::{PlotAxis, tick_label};
use super::drawing::Drawing;
use super::mark::Anchor::{End, Middle, Start};
use super::mark::Mark;
use super::series::{FAINT, INK, NOTE, WHITE, colour};

/// Outlines of the marks, the n-th for the n-th shape; the first is a circle, and a sixth shape starts over.
const OUTLINES: [&[[f64; 2]]; 5] = [
    &[],
    &[[-5.5, -5.5], [5.5, -5.5], [5.5, 5.5], [-5.5, 5.5]],
    &[[0.0, -7.5], [7.5, 0.0], [0.0, 7.5], [-7.5, 0.0]],
    &[[0.0, -7.5], [7.0, 5.5], [-7.0, 5.5]],
    &[[0.0, 7.5], [7.0, -5.5], [-7.0, -5.5]],
];

/// Measured method.
#[derive(Debug, Clone, PartialEq)]
pub struct Dot {
    pub x: f64,
    pub y: f64,
    /// Filled share of the mark, 0 to 1.
    pub share: f64,
    /// Index of the series in the colours' names.
    pub series: usize,
    pub shape: usize,
    /// Name written beside the mark.
    pub name: Option<String>,
    pub is_ringed: bool,
}

/// Dots over shared axes, with the meaning of colours and shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    pub title: String,
    /// One line on the meaning of the filled share.
    pub note: String,
    pub x: PlotAxis,
    pub y: PlotAxis,
    pub colours: Vec<String>,
    pub shapes: Vec<String>,
    /// Meaning of the ring.
    pub ringed: String,
    /// Groups of dots, one plot each, side by side.
    pub groups: Vec<(String, Vec<Dot>)>,
}

/// Width of a plot: of one of several, and of a single one.
const WIDTHS: [f64; 2] = [300.0, 520.0];
const HEIGHT: f64 = 300.0;
/// Approximate width of a letter of the note.
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

pub fn scatter(cloud: &Cloud) -> Drawing {
    let step = cloud.plot_width() + GAP;
    let of_note = 32.0 + LETTER * cloud.note.chars().count() as f64;
    let width = (LEFT + cloud.groups.len().max(1) as f64 * step).max(of_note);
    let rows = cloud.colours.len().max(cloud.shapes.len() + 1) as f64;
    let mut marks = vec![
        Mark::text([16.0, 26.0], 16.0, Start, INK, &cloud.title).bold(),
        Mark::text([16.0, 45.0], 11.0, Start, NOTE, &cloud.note),
    ];
    let groups = cloud.groups.iter().enumerate();
    marks.extend(groups.map(|(i, group)| Mark::group([LEFT + i as f64 * step, TOP], plot(cloud, group, i == 0))));
    marks.push(Mark::group([LEFT, TOP + HEIGHT + FOOT + 12.0], legend(cloud)));
    Drawing {
        area: [0.0, 0.0, width, TOP + HEIGHT + FOOT + rows * LEGEND_ROW + 10.0],
        label: cloud.title.clone(),
        marks,
    }
}

fn plot(cloud: &Cloud, (name, dots): &(String, Vec<Dot>), with_y_labels: bool) -> Vec<Mark> {
    let middle = cloud.plot_width() / 2.0;
    let mut marks = vec![Mark::text([middle, -10.0], 12.0, Middle, INK, name)];
    marks.extend(grid(cloud, with_y_labels));
    marks.extend(dots.iter().map(|dot| mark(cloud, dot)));
    marks.extend(names(cloud, dots));
    marks
}

fn grid(cloud: &Cloud, with_y_labels: bool) -> Vec<Mark> {
    let width = cloud.plot_width();
    let mut marks = Vec::new();
    for tick in cloud.x.ticks() {
        let x = cloud.x.share(tick) * width;
        marks.push(Mark::line([x, 0.0], [x, HEIGHT], FAINT));
        marks.push(Mark::text([x, HEIGHT + 14.0], 10.0, Middle, NOTE, tick_label(tick)));
    }
    for tick in cloud.y.ticks() {
        let y = (1.0 - cloud.y.share(tick)) * HEIGHT;
        marks.push(Mark::line([0.0, y], [width, y], FAINT));
        marks.extend(with_y_labels.then(|| Mark::text([-6.0, y + 3.5], 10.0, End, NOTE, tick_label(tick))));
    }
    marks.push(Mark::rect([0.0; 2], [width, HEIGHT]).outlined(NOTE, 1.0));
    let title = |at: [f64; 2], title: &str| Mark::text(at, 11.0, Middle, INK, title);
    marks.push(title([width / 2.0, HEIGHT + 32.0], &cloud.x.title));
    marks.extend(with_y_labels.then(|| title([-44.0, HEIGHT / 2.0], &cloud.y.title).upright()));
    marks
}

fn place(cloud: &Cloud, dot: &Dot) -> [f64; 2] {
    [
        cloud.x.share(dot.x) * cloud.plot_width(),
        (1.0 - cloud.y.share(dot.y)) * HEIGHT,
    ]
}

fn mark(cloud: &Cloud, dot: &Dot) -> Mark {
    let ring = dot.is_ringed.then(|| ring(RADIUS + 4.5));
    let symbol = symbol(dot.series, dot.shape, dot.share);
    Mark::group(place(cloud, dot), ring.into_iter().chain(symbol).collect())
}

fn ring(radius: f64) -> Mark {
    Mark::circle([0.0, 0.0], radius).outlined(INK, 1.5)
}

/// Draws an outline with a clockwise sector of it filled.
fn symbol(series: usize, shape: usize, share: f64) -> Vec<Mark> {
    let paint = colour(series);
    let share = share.clamp(0.0, 1.0);
    let outline = match OUTLINES[shape % OUTLINES.len()] {
        [] => Mark::circle([0.0, 0.0], RADIUS),
        points => Mark::polygon(points.iter().copied()),
    };
    let outline = outline.outlined(paint, 1.5);
    if share > 0.9995 {
        return vec![outline.filled(paint).sheer(0.85)];
    }
    let filled = (share > 0.0).then(|| Mark::polygon(sector(share)).filled(paint).sheer(0.85));
    [outline.filled(WHITE)].into_iter().chain(filled).collect()
}

/// Returns a clockwise sector from the top with this share of a mark: the centre, and points of the arc so close that it looks round.
pub fn sector(share: f64) -> Vec<[f64; 2]> {
    let steps = (share * 40.0).ceil().max(1.0);
    let on_arc = |step: u32| {
        let (sin, cos) = (share * TAU * f64::from(step) / steps).sin_cos();
        [(RADIUS - 1.0) * sin, -(RADIUS - 1.0) * cos]
    };
    let arc = (0..=steps as u32).map(on_arc);
    [[0.0; 2]].into_iter().chain(arc).collect()
}

/// Draws the names, moved down where two would overlap.
fn names(cloud: &Cloud, dots: &[Dot]) -> Vec<Mark> {
    let mut named: Vec<([f64; 2], &str)> = dots
        .iter()
        .filter_map(|dot| Some((place(cloud, dot), dot.name.as_deref()?)))
        .collect();
    named.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
    let mut lowest = f64::NEG_INFINITY;
    let written = named.into_iter().map(|([x, y], name)| {
        lowest = y.max(lowest + 11.0);
        let is_right = x > 0.6 * cloud.plot_width();
        let (anchor, dx) = if is_right { (End, -13.0) } else { (Start, 13.0) };
        Mark::text([x + dx, lowest + 3.5], 10.0, anchor, INK, name).outlined(WHITE, 3.0)
    });
    written.collect()
}

fn legend(cloud: &Cloud) -> Vec<Mark> {
    let entry = |x: f64, row: usize, mut marks: Vec<Mark>, name: &str| {
        marks.push(Mark::text([14.0, 4.0], 11.0, Start, INK, name));
        Mark::group([x, row as f64 * LEGEND_ROW], marks)
    };
    let (colours, shapes) = (cloud.colours.iter().enumerate(), cloud.shapes.iter().enumerate());
    let colours = colours.map(|(i, name)| entry(6.0, i, symbol(i, 0, 1.0), name));
    let shapes = shapes.map(|(i, name)| entry(230.0, i, symbol(6, i, 0.0), name));
    let ringed = entry(230.0, cloud.shapes.len(), vec![ring(RADIUS + 3.0)], &cloud.ringed);
    colours.chain(shapes).chain([ringed]).collect()
}
