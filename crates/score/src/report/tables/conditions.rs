//! Tables of figures by a condition that photos were grouped by.

use crate::figures::{ConditionFigures, Scores};
use crate::report::table::{Cell, Column, Table};
use scaleproof_core::spelling::digits;
use scaleproof_plot::distinct;

/// Returns a table for each condition that photos were grouped by: values and textures down, detectors across.
pub(crate) fn conditions(scores: &Scores) -> Vec<Table> {
    let all = scores.summaries.iter().flat_map(|s| &s.conditions);
    let names = distinct(all.map(|c| c.condition.as_str()));
    names.into_iter().map(|name| condition(scores, name)).collect()
}

fn condition(scores: &Scores, name: &str) -> Table {
    let titles = scores
        .detectors
        .iter()
        .map(|d| Column::numbers(&d.manifest.title).called(&d.manifest.name));
    let names = [Column::words(name), Column::words("texture")];
    let mut table = Table::new(
        &format!("By {name}: hits, AP@0.5"),
        names.into_iter().chain(titles).collect(),
    );
    let all = scores.summaries.iter().flat_map(|s| &s.conditions);
    let values = distinct(all.filter(|c| c.condition == name).map(|c| c.value.as_str()));
    for value in values {
        let row = |variant: &str| {
            let own = scores.summaries.iter().filter(|s| s.variant == variant);
            let is_own = |c: &&ConditionFigures| c.condition == name && c.value == value;
            let cells = own.map(|s| s.conditions.iter().find(is_own).map_or_else(Cell::default, cell));
            let names = [Cell::text(value), Cell::text(variant)];
            names.into_iter().chain(cells).collect::<Vec<_>>()
        };
        table.add_block(scores.variants().into_iter().map(row));
    }
    table.notes.push("Hits of photos; in brackets AP@0.5, of two photos or more, and the attack success rate of the hits. –: no photo".to_owned());
    table
}

/// Returns the hits of photos, AP@0.5 and the attack success rate of the hit rate.
fn cell(c: &ConditionFigures) -> Cell {
    let f = &c.figures;
    // A single photo has no ranking, and so no AP.
    let ap50 = (f.photos > 1).then(|| format!("AP {}", digits(f.ap50, 2)));
    let asr = c
        .asr
        .and_then(|asr| asr.hit_rate)
        .map(|asr| format!("ASR {}", digits(asr, 2)));
    let beside: Vec<String> = ap50.into_iter().chain(asr).collect();
    let remark = (!beside.is_empty()).then(|| beside.join(", "));
    Cell::share(f.hit_rate.count, f.photos).with_remark(remark)
}
