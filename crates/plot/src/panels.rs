//! Many small charts on one page: each a sweep of one condition, with several lines over it.

use maud::{Markup, html};

use super::axis::tick_label;
use super::{FAINT, INK, NOTE, PlotAxis, colour, document, round};

/// One line of a panel: values along the panel's x, gaps where nothing was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotLine {
    pub series: usize,
    pub values: Vec<Option<f64>>,
    pub is_dashed: bool,
}

/// One small chart. The x values are evenly spaced steps with their labels: sweeps go from harmless to hopeless.
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

/// A page of panels, row by row, `across` a row, with a legend of colours and of solid and dashed lines.
pub fn panels(title: &str, notes: &[String], series: &[String], across: usize, all: &[PlotPanel]) -> String {
    let across = across.max(1);
    let notes_height = 14.0 * notes.len() as f64;
    let top = TOP + notes_height;
    let width = CELL.0 * across as f64 + 20.0;
    let height = top + CELL.1 * all.len().div_ceil(across) as f64 + 10.0;
    let content = html! {
        text x="16" y="26" font-size="16" font-weight="bold" fill=(INK) { (title) }
        @for (i, note) in notes.iter().enumerate() {
            text x="16" y=(44.0 + 14.0 * i as f64) font-size="11" fill=(NOTE) { (note) }
        }
        @for (i, name) in series.iter().enumerate() {
            @let x = 16.0 + 150.0 * i as f64;
            @let y = 44.0 + notes_height;
            line x1=(x) x2=(x + 20.0) y1=(y - 4.0) y2=(y - 4.0) stroke=(colour(i)) stroke-width="2.5" {}
            text x=(x + 26.0) y=(y) font-size="11" fill=(INK) { (name) }
        }
        @for (i, panel) in all.iter().enumerate() {
            @let at = (50.0 + CELL.0 * (i % across) as f64, top + 26.0 + CELL.1 * (i / across) as f64);
            g transform=(format!("translate({} {})", at.0, at.1)) { (draw(panel)) }
        }
    };
    document(width, height, title, &content)
}

fn draw(panel: &PlotPanel) -> Markup {
    let last = panel.steps.len().saturating_sub(1).max(1) as f64;
    let x = |step: usize| round(step as f64 / last * PANEL.0);
    let y = |value: f64| round((1.0 - panel.y.share(value)) * PANEL.1);
    // Labels of about 26 px each.
    let every = panel.steps.len().div_ceil(7).max(1);
    html! {
        text y="-7" font-size="11" font-weight="bold" fill=(INK) { (panel.title) }
        @for tick in panel.y.ticks() {
            line x2=(PANEL.0) y1=(y(tick)) y2=(y(tick)) stroke=(FAINT) {}
            text x="-4" y=(y(tick) + 3.0) font-size="8.5" text-anchor="end" fill=(NOTE) { (tick_label(tick)) }
        }
        rect width=(PANEL.0) height=(PANEL.1) fill="none" stroke=(NOTE) {}
        @for (i, step) in panel.steps.iter().enumerate().filter(|(i, _)| i % every == 0) {
            text x=(x(i)) y=(PANEL.1 + 11.0) font-size="8.5" text-anchor="middle" fill=(NOTE) { (step) }
        }
        text x=(PANEL.0 / 2.0) y=(PANEL.1 + 23.0) font-size="9" text-anchor="middle" fill=(NOTE) { (panel.y.title) }
        @for line in &panel.lines {
            @for run in runs(&line.values) {
                polyline points=(run.iter().map(|(i, v)| format!("{},{}", x(*i), y(*v))).collect::<Vec<_>>().join(" "))
                    fill="none" stroke=(colour(line.series)) stroke-width="1.8" stroke-linejoin="round"
                    stroke-dasharray=[line.is_dashed.then_some("4 3")] {}
                @for (i, v) in &run {
                    circle cx=(x(*i)) cy=(y(*v)) r="1.9" fill=(colour(line.series)) {}
                }
            }
        }
    }
}

fn runs(values: &[Option<f64>]) -> Vec<Vec<(usize, f64)>> {
    let numbered = values.iter().enumerate().map(|(i, v)| Some((i, (*v)?)));
    let numbered: Vec<Option<(usize, f64)>> = numbered.collect();
    let runs = numbered.split(Option::is_none).filter(|run| !run.is_empty());
    runs.map(|run| run.iter().flatten().copied().collect()).collect()
}
