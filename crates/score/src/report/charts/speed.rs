//! Chart of AP against milliseconds per photo.

use crate::figures::Scores;
use crate::report::charts::colours::colour;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{Speed, Speeds};
use scaleproof_plot::Anchor::{End, Middle, Start};
use scaleproof_plot::{Anchor, BLACK, Drawing, FAINT, Mark, NOTE, PlotAxis, Scale, WHITE, tick_label};

const PLOT: (f64, f64) = (430.0, 250.0);
const RADIUS: f64 = 4.5;

pub(crate) fn timed<'a>(scores: &Scores, speeds: &'a Speeds) -> Vec<&'a Speed> {
    let names = scores.detectors.iter().map(|c| c.manifest.name.as_str());
    names.filter_map(|name| speeds.find(name)).collect()
}

pub(crate) fn plot(scores: &Scores, speeds: &Speeds) -> Drawing {
    let timed = timed(scores, speeds);
    let axis = PlotAxis::around("milliseconds a photo", Scale::Log, timed.iter().map(|s| s.ms_per_photo));
    let x = |ms: f64| axis.share(ms) * PLOT.0;
    let mut marks = Vec::new();
    for tick in axis.ticks() {
        let (x, name) = (x(tick), tick_label(tick));
        marks.push(Mark::line([x, 0.0], [x, PLOT.1], FAINT));
        marks.push(Mark::text([x, PLOT.1 + 15.0], 11.0, Middle, NOTE, name));
    }
    for tick in [0.0, 0.25, 0.5, 0.75, 1.0] {
        marks.push(Mark::line([0.0, y(tick)], [PLOT.0, y(tick)], FAINT));
        marks.push(Mark::text([-6.0, y(tick) + 4.0], 11.0, End, NOTE, tick));
    }
    marks.push(Mark::rect([0.0; 2], [PLOT.0, PLOT.1]).outlined(NOTE, 1.0));
    let below = format!("{}, logarithmic", axis.title);
    marks.push(Mark::text([PLOT.0 / 2.0, PLOT.1 + 36.0], 12.0, Middle, BLACK, below));
    marks.push(Mark::text([-32.0, PLOT.1 / 2.0], 12.0, Middle, BLACK, "AP@0.5").upright());
    let detectors = timed.iter().map(|speed| detector(scores, speed, x(speed.ms_per_photo)));
    marks.extend(detectors.flatten());
    marks.extend(names(scores, &timed, x));
    Drawing {
        area: [-42.0, -14.0, PLOT.0 + 130.0, PLOT.1 + 62.0],
        label: "AP at IoU 0.5 against milliseconds a photo".to_owned(),
        marks,
    }
}

fn y(ap: f64) -> f64 {
    (1.0 - ap) * PLOT.1
}

/// Returns the AP of a detector on each texture, by the index of the texture.
fn aps(scores: &Scores, detector: &str) -> Vec<(usize, f64)> {
    let all = scores.variants().into_iter().enumerate();
    all.filter_map(|(i, variant)| Some((i, scores.summary(detector, variant)?.overall.ap50)))
        .collect()
}

/// Returns the heights of a detector's best and worst texture in the chart, in px.
fn ends(scores: &Scores, speed: &Speed) -> (f64, f64) {
    let all = aps(scores, &speed.detector).into_iter().map(|(_, ap)| y(ap));
    all.fold((f64::INFINITY, 0.0_f64), |(top, bottom), v| (top.min(v), bottom.max(v)))
}

/// Draws a mark for each texture of a detector, on one upright line.
fn detector(scores: &Scores, speed: &Speed, x: f64) -> Vec<Mark> {
    let (top, bottom) = ends(scores, speed);
    let line = Mark::line([x, top.min(bottom)], [x, bottom], NOTE).outlined(NOTE, 1.2);
    let textures = aps(scores, &speed.detector).into_iter().map(|(i, ap)| {
        let ([from, to], texture) = (speed.ms_range, scores.variants()[i]);
        let time = format!("{} ms ({from} to {to})", speed.ms_per_photo);
        mark([x, y(ap)], i).titled(format!("{}, {texture}: AP@0.5 {ap:.3}, {time}", speed.detector))
    });
    [line].into_iter().chain(textures).collect()
}

/// Draws the mark of a texture, with a shape and colour by its index.
pub(crate) fn mark([x, y]: [f64; 2], variant: usize) -> Mark {
    let corners: &[[f64; 2]] = match variant % 4 {
        0 => &[],
        1 => &[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]],
        2 => &[[0.9, 0.9], [0.9, -0.9], [-0.9, -0.9], [-0.9, 0.9]],
        _ => &[[0.0, 1.3], [1.3, 0.0], [0.0, -1.3], [-1.3, 0.0]],
    };
    let shape = match corners {
        [] => Mark::circle([x, y], RADIUS),
        _ => Mark::polygon(corners.iter().map(|[dx, dy]| [x + RADIUS * dx, y + RADIUS * dy])),
    };
    shape.filled(colour(variant)).outlined(WHITE, 0.8)
}

/// Draws the detectors' names beside the middles of their lines: where they cover neither another name nor another's line, if there is such a place.
fn names<'a>(scores: &'a Scores, timed: &[&'a Speed], x: impl Fn(f64) -> f64) -> Vec<Mark> {
    let line = |speed: &&'a Speed| {
        let (top, bottom) = ends(scores, speed);
        ErrorBar {
            x: x(speed.ms_per_photo),
            top,
            bottom,
            title: scores.title(&speed.detector),
        }
    };
    let lines: Vec<ErrorBar> = timed.iter().map(line).collect();
    let mut taken: Vec<BoxPx> = Vec::new();
    let name = |line: &ErrorBar| {
        let label = free_label(line, &lines, &taken);
        taken.push(label.area);
        Mark::text(label.at, 11.0, label.anchor, BLACK, line.title).outlined(WHITE, 3.0)
    };
    lines.iter().map(name).collect()
}

/// A detector's line from its best to its worst texture.
struct ErrorBar<'a> {
    x: f64,
    top: f64,
    bottom: f64,
    title: &'a str,
}

struct Label {
    at: [f64; 2],
    anchor: Anchor,
    area: BoxPx,
}

/// Returns a label beside an error bar that overlaps no other bar or label: rather right than left of it, and shifted up or down as little as
/// possible; unshifted on the right where no place is free.
fn free_label(line: &ErrorBar, lines: &[ErrorBar], taken: &[BoxPx]) -> Label {
    let middle = 0.5 * (line.top + line.bottom);
    let moves = [0.0, 13.0, -13.0, 26.0, -26.0].into_iter();
    let mut places = moves.flat_map(|dy| [true, false].map(|is_right| label_at(line, middle + dy, is_right)));
    let around = |l: &ErrorBar| BoxPx::new(l.x - RADIUS, l.top - RADIUS, l.x + RADIUS, l.bottom + RADIUS);
    let others: Vec<BoxPx> = lines.iter().map(around).chain(taken.iter().copied()).collect();
    let overlaps = |a: &BoxPx, b: &BoxPx| a.x1 < b.x2 && b.x1 < a.x2 && a.y1 < b.y2 && b.y1 < a.y2;
    let is_free = |label: &Label| label.area.x1 > 0.0 && !others.iter().any(|other| overlaps(&label.area, other));
    places.find(is_free).unwrap_or_else(|| label_at(line, middle, true))
}

fn label_at(line: &ErrorBar, middle: f64, is_right: bool) -> Label {
    // Approximate width of letters of 11 px.
    let width = 6.2 * line.title.chars().count() as f64;
    let x = line.x + if is_right { 8.0 } else { -8.0 };
    let (anchor, left) = if is_right { (Start, x) } else { (End, x - width) };
    Label {
        at: [x, middle + 4.0],
        anchor,
        area: BoxPx::new(left, middle - 6.0, left + width, middle + 6.0),
    }
}
