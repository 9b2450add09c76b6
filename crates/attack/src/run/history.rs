//! The history of a run, and the chart of several.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::judge::HeldOutFigures;
use crate::AttackError;
use scaleproof_core::files;
use scaleproof_core::message::message;
use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, distinct, scatter};
use scaleproof_pose::scene::Classes;

pub const FILE: &str = "history.json";

/// Measurements of a run after one of its steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Entry {
    /// Steps of the run so far.
    pub step: u32,
    /// Images looked at so far, those of judging not counted.
    pub queries: u64,
    /// Wall time so far on the machine of the run, judging included.
    pub wall_s: f64,
    /// Mean over the views of the step of the loss summed over the detectors; `null` for methods that see no loss.
    pub loss: Option<f64>,
    /// Mean confidence over the views of the step and the detectors; `null` where the method does not know it.
    pub confidence: Option<f64>,
    /// Figures of predicted images of held-out views; `null` after steps that are not judged.
    pub held_out: Option<HeldOutFigures>,
}

/// Widths of a repeat on the model, mm.
pub const TILES_MM: RangeInclusive<f64> = 0.1..=100_000.0;
const SHARES: RangeInclusive<f64> = 0.0..=1.0;
/// Up to thirty years.
const SECONDS: RangeInclusive<f64> = 0.0..=1e9;

/// The history of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct History {
    /// Version of the program.
    pub scaleproof: String,
    /// Name of the method: `dta`, `er`, `camou`, `random`, `flat`, `import` or `patches`.
    pub method: String,
    /// Seed of the run's random numbers.
    pub seed: u64,
    /// Width of one repeat of the pattern on the model.
    pub tile_mm: f64,
    /// SHA-256 of the `frames.json` that the pattern was made from.
    pub frames_sha256: String,
    /// The detectors that the pattern was made against, each with the first 12 digits of its weights' SHA-256.
    pub detectors: Vec<String>,
    /// The labels that count as the model; `null` in histories of versions that did not note them.
    #[serde(default)]
    pub classes: Option<Classes>,
    /// The course of the run, from the first step to the last.
    pub entries: Vec<Entry>,
}

impl History {
    /// Reads the history in the folder of a result.
    pub fn load(folder: &Path) -> Result<Self, AttackError> {
        let path = folder.join(FILE);
        let read = serde_json::from_str::<Self>(&files::read_text(&path)?).map_err(|e| e.to_string());
        let possible = read.and_then(|history| history.fault().map_or(Ok(history), Err));
        let path = path.display();
        Ok(possible.map_err(|reason| message!("{path} is no history of a pattern ({reason}): make it again"))?)
    }

    /// Finds a figure that no run can have.
    fn fault(&self) -> Option<String> {
        let of_entry = |entry: &Entry| {
            let of_held_out = |f: HeldOutFigures| {
                [
                    ("ap50", f.ap50, SHARES),
                    ("hit_rate", f.hit_rate, SHARES),
                    ("mean_confidence", f.mean_confidence, SHARES),
                ]
            };
            let held_out = entry.held_out.into_iter().flat_map(of_held_out);
            std::iter::once(("wall_s", entry.wall_s, SECONDS)).chain(held_out)
        };
        let mut figures =
            std::iter::once(("tile_mm", self.tile_mm, TILES_MM)).chain(self.entries.iter().flat_map(of_entry));
        let impossible = figures.find(|(_, value, possible)| !possible.contains(value));
        impossible.map(|(name, value, _)| format!("its {name} is {value}"))
    }

    /// Encodes the history as a file of the folder.
    pub fn to_file(&self, folder: &Path) -> Result<(PathBuf, Vec<u8>), AttackError> {
        Ok((folder.join(FILE), serde_json::to_vec_pretty(self)?))
    }

    /// Lists the differences for which two cannot stand on one chart, as clauses.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let classes = |history: &History| {
            let classes = history.classes.as_ref();
            classes.map_or("not stated".to_owned(), |c| c.labels().join(", "))
        };
        let both = [
            ("frames", self.frames_sha256.clone(), other.frames_sha256.clone()),
            ("detectors", self.detectors.join(", "), other.detectors.join(", ")),
            ("classes", classes(self), classes(other)),
        ];
        let differing = both.into_iter().filter(|(_, own, others)| own != others);
        let clauses = differing.map(|(what, own, others)| match what {
            "frames" => "other frames".to_owned(),
            _ => format!("other {what} ({own}; {others})"),
        });
        clauses.collect()
    }

    pub fn queries(&self) -> u64 {
        self.entries.last().map_or(0, |e| e.queries)
    }

    pub fn wall_s(&self) -> f64 {
        self.entries.last().map_or(0.0, |e| e.wall_s)
    }

    pub fn last_judged(&self) -> Option<(&Entry, HeldOutFigures)> {
        self.entries.iter().rev().find_map(|e| Some((e, e.held_out?)))
    }
}

/// Draws the chart: AP@0.5 on the held-out views against wall time, a colour for each method; the filled share of a mark is the hit rate.
pub fn draw(histories: &[History]) -> String {
    let methods = distinct(histories.iter().map(|history| history.method.clone()));
    let dots: Vec<Dot> = histories.iter().flat_map(|history| of_one(history, &methods)).collect();
    let last = histories.first().and_then(History::last_judged);
    let views = last.map_or(0, |(_, figures)| figures.views);
    ap_chart(
        [
            "Patterns: AP@0.5 on held-out views against time",
            "after so many seconds",
            "the end",
        ],
        &format!("{views} views by the surrogate renderer"),
        methods,
        vec![(String::new(), dots)],
    )
}

/// Draws AP@0.5 against seconds, a colour for each method and a plot for each group. `words`: the title, what a mark is, and what a ring about one means.
pub(crate) fn ap_chart(words: [&str; 3], of: &str, methods: Vec<String>, groups: Vec<(String, Vec<Dot>)>) -> String {
    let [title, shape, ringed] = words.map(str::to_owned);
    let dots = || groups.iter().flat_map(|(_, dots)| dots);
    scatter(&Cloud {
        title,
        note: format!("{of}; filled: share with a hit at confidence 0.5; lower left is better"),
        x: PlotAxis::around("seconds", Scale::Log, dots().map(|d| d.x)),
        y: PlotAxis::around("AP@0.5", Scale::Linear, dots().map(|d| d.y).chain([1.0])),
        colours: methods,
        shapes: vec![shape],
        ringed,
        groups,
    })
    .svg()
}

/// Creates a mark of [`ap_chart`]; a pattern that took no time stands at the left end.
pub(crate) fn ap_dot(wall_s: f64, [ap50, hit_rate]: [f64; 2], series: usize, is_ringed: bool) -> Dot {
    Dot {
        x: wall_s.max(1.0),
        y: ap50,
        share: hit_rate,
        series,
        shape: 0,
        name: None,
        is_ringed,
    }
}

fn of_one<'a>(history: &'a History, methods: &'a [String]) -> impl Iterator<Item = Dot> + 'a {
    let series = methods.iter().position(|m| *m == history.method).unwrap_or(0);
    let last = history.last_judged().map(|(entry, _)| entry.step);
    let judged = history.entries.iter().filter_map(|e| Some((e, e.held_out?)));
    judged.map(move |(entry, judgement)| {
        let figures = [judgement.ap50, judgement.hit_rate];
        ap_dot(entry.wall_s, figures, series, Some(entry.step) == last)
    })
}
