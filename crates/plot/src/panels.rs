//! Page of many small charts: each a sweep of one condition, with several lines.

use super::axis::{PlotAxis, tick_label};
use super::drawing::Drawing;
use super::mark::Anchor::{End, Middle, Start};
use super::mark::Mark;
use super::series::{FAINT, INK, NOTE, colour};

/// Line of a panel: values along the panel's x, with gaps where nothing was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotLine {
    pub series: usize,
    pub values: Vec<Option<f64>>,
    pub is_dashed: bool,
}

/// Small chart. The x values are evenly spaced steps with their labels: sweeps go from harmless to hopeless.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotPanel {
    pub title: String,
    pub steps: Vec<String>,
    pub y: PlotAxis,
    pub lines: Vec<PlotLine>,
}

const PANEL: (f64, f64) = (190.0, 104.0);
const CELL: (f64, f64) = (252.0, 168.0);
const TOP: f64 = 64.0;

/// Draws a page of panels, row by row, `across` per row, with a legend of colours and of solid and dashed lines.
pub fn panels(title: &str, notes: &[String], series: &[String], across: usize, all: &[PlotPanel]) -> Drawing {
    let across = across.max(1);
    let notes_height = 14.0 * notes.len() as f64;
    let top = TOP + notes_height;
    let mut marks = vec![Mark::text([16.0, 26.0], 16.0, Start, INK, title).bold()];
    for (i, note) in notes.iter().enumerate() {
        marks.push(Mark::text([16.0, 44.0 + 14.0 * i as f64], 11.0, Start, NOTE, note));
    }
    for (i, name) in series.iter().enumerate() {
        let (x, y) = (16.0 + 150.0 * i as f64, 44.0 + notes_height);
        marks.push(Mark::line([x, y - 4.0], [x + 20.0, y - 4.0], colour(i)).outlined(colour(i), 2.5));
        marks.push(Mark::text([x + 26.0, y], 11.0, Start, INK, name));
    }
    for (i, panel) in all.iter().enumerate() {
        let (x, y) = (CELL.0 * (i % across) as f64, CELL.1 * (i / across) as f64);
        marks.push(Mark::group([50.0 + x, top + 26.0 + y], draw(panel)));
    }
    let height = top + CELL.1 * all.len().div_ceil(across) as f64 + 10.0;
    Drawing {
        area: [0.0, 0.0, CELL.0 * across as f64 + 20.0, height],
        label: title.to_owned(),
        marks,
    }
}

fn draw(panel: &PlotPanel) -> Vec<Mark> {
    let last = panel.steps.len().saturating_sub(1).max(1) as f64;
    let x = |step: usize| step as f64 / last * PANEL.0;
    let y = |value: f64| (1.0 - panel.y.share(value)) * PANEL.1;
    // Labels are about 26 px wide.
    let every = panel.steps.len().div_ceil(7).max(1);
    let mut marks = vec![Mark::text([0.0, -7.0], 11.0, Start, INK, &panel.title).bold()];
    for tick in panel.y.ticks() {
        marks.push(Mark::line([0.0, y(tick)], [PANEL.0, y(tick)], FAINT));
        marks.push(Mark::text([-4.0, y(tick) + 3.0], 8.5, End, NOTE, tick_label(tick)));
    }
    marks.push(Mark::rect([0.0; 2], [PANEL.0, PANEL.1]).outlined(NOTE, 1.0));
    for (i, step) in panel.steps.iter().enumerate().step_by(every) {
        marks.push(Mark::text([x(i), PANEL.1 + 11.0], 8.5, Middle, NOTE, step));
    }
    let below = [PANEL.0 / 2.0, PANEL.1 + 23.0];
    marks.push(Mark::text(below, 9.0, Middle, NOTE, &panel.y.title));
    for line in &panel.lines {
        let colour = colour(line.series);
        for run in runs(&line.values) {
            let points = || run.iter().map(|(i, v)| [x(*i), y(*v)]);
            marks.push(Mark::polyline(points(), colour, 1.8).dashed(line.is_dashed));
            marks.extend(points().map(|at| Mark::circle(at, 1.9).filled(colour)));
        }
    }
    marks
}

fn runs(values: &[Option<f64>]) -> Vec<Vec<(usize, f64)>> {
    let numbered = values.iter().enumerate().map(|(i, v)| Some((i, (*v)?)));
    let numbered: Vec<Option<(usize, f64)>> = numbered.collect();
    let runs = numbered.split(Option::is_none).filter(|run| !run.is_empty());
    runs.map(|run| run.iter().flatten().copied().collect()).collect()
}
