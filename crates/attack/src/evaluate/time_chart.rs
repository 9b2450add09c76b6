//! The chart of patterns in rendered photos against the time of their making.

use serde::Serialize;

use super::finished::RenderedFigures;
use crate::run::history::{History, ap_chart, ap_dot};
use scaleproof_plot::{Dot, distinct};

/// Run with the figures of its pattern in rendered photos.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RenderedRun {
    /// Name of the method, such as `dta` or `er` (all are in sidecars.md).
    pub method: String,
    /// Seed of the run's random numbers.
    pub seed: u64,
    /// Images that the detectors looked at in the whole run, those of judging not counted.
    pub queries: u64,
    /// Wall time of the whole run on its machine.
    pub wall_s: f64,
    /// The figures of each detector on rendered photos.
    pub rendered: Vec<RenderedFigures>,
}

impl RenderedRun {
    pub fn new(history: &History, rendered: Vec<RenderedFigures>) -> Self {
        Self {
            method: history.method.clone(),
            seed: history.seed,
            queries: history.queries(),
            wall_s: history.wall_s(),
            rendered,
        }
    }
}

/// Draws the chart: AP@0.5 in rendered photos against the whole wall time, a plot for each detector, a colour for each method; the filled share of a mark is the
/// hit rate.
pub fn draw(runs: &[RenderedRun]) -> String {
    let methods = distinct(runs.iter().map(|run| run.method.clone()));
    let all = || runs.iter().flat_map(|run| &run.rendered);
    let detectors = distinct(all().map(|figures| figures.detector.clone()));
    let photos = all().map(|figures| figures.photos).max().unwrap_or(0);
    let dots = |name: &String| (name.clone(), of_detector(name, runs, &methods));
    let groups = detectors.iter().map(dots).collect();
    ap_chart(
        [
            "Patterns: AP@0.5 in rendered photos against time",
            "a whole run",
            "no other is both faster and lower",
        ],
        &format!("{photos} photos a pattern"),
        methods,
        groups,
    )
}

fn of_detector(detector: &str, runs: &[RenderedRun], methods: &[String]) -> Vec<Dot> {
    let figures = |run: &RenderedRun| {
        let found = run.rendered.iter().find(|f| f.detector == detector)?;
        Some([found.ap50, found.hit_rate])
    };
    let mark = |run: &RenderedRun| {
        let series = methods.iter().position(|method| *method == run.method).unwrap_or(0);
        Some(ap_dot(run.wall_s, figures(run)?, series, false))
    };
    let mut dots: Vec<Dot> = runs.iter().filter_map(mark).collect();
    let places: Vec<[f64; 2]> = dots.iter().map(|dot| [dot.x, dot.y]).collect();
    for dot in &mut dots {
        dot.is_ringed = !places.iter().any(|[x, y]| *x < dot.x && *y <= dot.y);
    }
    dots
}
