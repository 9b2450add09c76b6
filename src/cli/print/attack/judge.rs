//! Results of `attack judge`, as JSON and in words.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_attack::judged::JudgedPattern;
use scaleproof_core::spelling::count;
use scaleproof_pose::scene::Classes;

/// `attack judge --json`.
#[derive(Serialize, JsonSchema)]
pub struct Judgement<'a> {
    /// How many were looked at.
    pub views: usize,
    /// The width of one repeat of each pattern, by its name.
    pub tile_mm: BTreeMap<String, f64>,
    /// The labels that count as the model.
    pub classes: &'a Classes,
    /// Detector by detector, the plain model first.
    pub results: &'a [JudgedPattern],
}

pub fn table(judgement: &Judgement) -> String {
    let longest = |name: fn(&JudgedPattern) -> &str, least: usize| {
        let names = judgement.results.iter().map(|row| name(row).chars().count());
        names.fold(least, usize::max)
    };
    let mut tiles: Vec<String> = judgement.tile_mm.values().map(f64::to_string).collect();
    tiles.sort();
    tiles.dedup();
    let tiles = match &tiles[..] {
        [one] => one.clone(),
        _ => judgement
            .tile_mm
            .iter()
            .map(|(name, mm)| format!("{mm} ({name})"))
            .collect::<Vec<_>>()
            .join(", "),
    };
    let (detectors, patterns) = (longest(|row| &row.detector, 14), longest(|row| &row.pattern, 20));
    let mut text = format!(
        "predicted, not rendered, on {}, tile {tiles} mm; drop: of the mean confidence, with its 95 % interval over the views\n\
         {:<detectors$} {:<patterns$} {:>7} {:>9} {:>11} {:>18}  drop",
        count(judgement.views, "view"),
        "detector",
        "pattern",
        "AP@0.5",
        "hit rate",
        "confidence",
        "worst direction"
    );
    for row in judgement.results {
        let interval = row
            .drop_95
            .map_or_else(String::new, |[low, high]| format!(" [{low:.2}, {high:.2}]"));
        text += &format!(
            "\n{:<detectors$} {:<patterns$} {:>7.2} {:>9.2} {:>11.2} {:>10.2} at {:>3}°  {:.2}{interval}",
            row.detector,
            row.pattern,
            row.ap50,
            row.hit_rate,
            row.mean_confidence,
            row.worst_direction.mean_confidence,
            row.worst_direction.azimuth_deg,
            row.drop,
        );
    }
    text
}
