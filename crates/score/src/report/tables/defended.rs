//! Tables of differences between variants on defended photos, and of the changes by each defence.

use crate::figures::{Defences, DefendedRow, PairedDifference, UNDEFENDED};
use crate::report::table::{Cell, Column, Table};
use scaleproof_core::statistics::Interval;
use scaleproof_plot::distinct;

/// Returns two tables, each with a row for each detector and comparison and a column for each defence.
pub(crate) fn defended(defences: &Defences) -> [Table; 2] {
    let names = || defences.defences.iter().map(|defence| defence.name.as_str());
    let with_none: Vec<&str> = std::iter::once(UNDEFENDED).chain(names()).collect();
    let drops =
        "On defended photos: AP@0.5 of the base → of the texture, and the 95 % interval of the drop, nothing tested";
    let changes = "What each defence changes: AP@0.5 of the same photos without → with the defence, and the 95 % interval of what it adds; bold, in the terminal with a star: the \
                   defence is shown to change the mean confidence, tested over the defences of a detector and texture";
    [
        matrix(drops, &defences.rows, &with_none, |difference| cell(difference, 1.0)),
        matrix(changes, &defences.changes, &names().collect::<Vec<_>>(), |difference| {
            cell(difference, -1.0)
        }),
    ]
}

fn matrix(caption: &str, rows: &[DefendedRow], defences: &[&str], cell: fn(&PairedDifference) -> Cell) -> Table {
    let names = ["detector", "texture", "from"].map(Column::words);
    let columns = names
        .into_iter()
        .chain(defences.iter().map(|name| Column::numbers(name)));
    let mut table = Table::new(caption, columns.collect());
    let key = |row: &DefendedRow| {
        [&row.difference.detector, &row.difference.variant, &row.difference.base].map(String::clone)
    };
    let lines = distinct(rows.iter().map(key)).into_iter().map(|names| {
        let own = |defence: &&str| rows.iter().find(|row| row.defence == *defence && key(row) == names);
        let cells = defences
            .iter()
            .map(|defence| own(defence).map_or_else(Cell::default, |row| cell(&row.difference)));
        names.clone().map(Cell::text).into_iter().chain(cells).collect()
    });
    table.blocks.push(lines.collect());
    table
}

/// Returns a cell as in `0.87 → 0.16 [0.45, 0.93]`; `sign`: 1 for a drop, −1 for what is added.
fn cell(difference: &PairedDifference, sign: f64) -> Cell {
    let interval = difference.ap50.interval_95.map(|i| {
        let (a, b) = (sign * i.low, sign * i.high);
        Interval {
            low: a.min(b),
            high: a.max(b),
        }
    });
    Cell::change(difference.ap50.base, difference.ap50.other, 2)
        .with_interval(interval)
        .strong(difference.finding.is_some_and(|finding| finding.effect.is_shown()))
}
