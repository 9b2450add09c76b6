//! What patterns do on the model against the time that making them took.

use serde::Serialize;

use super::finished::RenderedFigures;
use crate::run::history::History;
use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, distinct, scatter};

/// A run, and what its pattern does in rendered photos.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RenderedRun {
    pub method: String,
    pub seed: u64,
    /// Images looked at in all.
    pub queries: u64,
    /// Wall time in all, on the machine of the run.
    pub wall_s: f64,
    /// Of each detector.
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

/// The chart: AP@0.5 in rendered photos against the whole wall time, a plot for each detector, a colour for each method; the filled share of a mark is the
/// hit rate.
pub fn draw(runs: &[RenderedRun]) -> String {
    let methods = distinct(runs.iter().map(|run| run.method.clone()));
    let all = || runs.iter().flat_map(|run| &run.rendered);
    let detectors = distinct(all().map(|figures| figures.detector.clone()));
    let photos = all().map(|figures| figures.photos).max().unwrap_or(0);
    scatter(&Cloud {
        title: "Patterns: AP@0.5 in rendered photos against time".to_owned(),
        note: format!("{photos} photos a pattern; filled: share with a hit at confidence 0.5; lower left is better"),
        x: PlotAxis::around("seconds", Scale::Log, runs.iter().map(seconds)),
        y: PlotAxis::around(
            "AP@0.5",
            Scale::Linear,
            all().map(|figures| figures.ap50).chain([0.0, 1.0]),
        ),
        groups: detectors
            .into_iter()
            .map(|name| of_detector(name, runs, &methods))
            .collect(),
        colours: methods,
        shapes: vec!["a whole run".to_owned()],
        ringed: "no other is both faster and lower".to_owned(),
    })
}

/// A pattern that took no time stands at the left end.
fn seconds(run: &RenderedRun) -> f64 {
    run.wall_s.max(1.0)
}

fn of_detector(detector: String, runs: &[RenderedRun], methods: &[String]) -> (String, Vec<Dot>) {
    let figures = |run: &'_ RenderedRun| {
        run.rendered
            .iter()
            .find(|figures| figures.detector == detector)
            .cloned()
    };
    let judged: Vec<(&RenderedRun, RenderedFigures)> =
        runs.iter().filter_map(|run| Some((run, figures(run)?))).collect();
    let is_beaten = |(run, own): &(&RenderedRun, RenderedFigures)| {
        let mut others = judged.iter();
        others.any(|(other, of_other)| seconds(other) < seconds(run) && of_other.ap50 <= own.ap50)
    };
    let dots = judged.iter().map(|pair| Dot {
        x: seconds(pair.0),
        y: pair.1.ap50,
        share: pair.1.hit_rate,
        series: methods.iter().position(|method| *method == pair.0.method).unwrap_or(0),
        shape: 0,
        name: None,
        is_ringed: !is_beaten(pair),
    });
    let dots = dots.collect();
    (detector, dots)
}
