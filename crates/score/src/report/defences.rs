//! What is left of the differences when photos are defended: tables of defence by texture for the terminal, the page and a paper, and lines for spreadsheets.

use serde_json::json;

use super::latex::{escaped, row, tabular};
use super::robustness::columns;
use super::{ReportError, counted, csv_of, protocol};
use crate::score::{Defences, DefendedRow, Held, Scores, UNDEFENDED};
use scaleproof_core::spelling::digits;
use scaleproof_plot::distinct;

pub(super) const NAMES: [&str; 2] = ["defences.csv", "defences.tex"];

pub(super) const DROPS: &str = "AP@0.5 of the base → of the texture, and the 95 % interval of the drop, nothing tested";

pub(super) const CHANGES: &str = "AP@0.5 of the same photos without → with the defence, and the 95 % interval of what it adds; * the defence is shown to change the mean confidence, tested over the defences of a detector and texture";

/// Names and contents of the files; none where it was not asked for.
pub(super) fn files(scores: &Scores) -> Result<Vec<(String, String)>, ReportError> {
    let Some(defences) = &scores.defences else {
        return Ok(Vec::new());
    };
    let rows = [("drop", &defences.rows), ("change", &defences.changes)];
    let rows = rows
        .into_iter()
        .flat_map(|(what, rows)| rows.iter().map(move |row| (what, row)));
    let csv = csv_of(rows.map(|(what, row)| {
        let mut line = vec![("of", json!(what)), ("defence", json!(row.defence))];
        line.extend(columns(scores, &row.held));
        line
    }))?;
    Ok(vec![
        (NAMES[0].to_owned(), csv),
        (NAMES[1].to_owned(), tex(scores, defences)),
    ])
}

/// The two tables, each with what its cells are: a head, then a line for each detector and comparison with a column for each defence.
pub(super) fn tables(defences: &Defences) -> [(&'static str, Vec<Vec<String>>); 2] {
    let names = || defences.defences.iter().map(|defence| defence.name.as_str());
    let with_none: Vec<&str> = std::iter::once(UNDEFENDED).chain(names()).collect();
    [
        (DROPS, matrix(&defences.rows, &with_none, |held| cell(held, 1.0))),
        (
            CHANGES,
            matrix(&defences.changes, &names().collect::<Vec<_>>(), |held| cell(held, -1.0)),
        ),
    ]
}

fn matrix(rows: &[DefendedRow], columns: &[&str], cell: fn(&Held) -> String) -> Vec<Vec<String>> {
    let head = ["detector", "texture", "from"]
        .into_iter()
        .chain(columns.iter().copied());
    let mut lines = vec![head.map(str::to_owned).collect::<Vec<_>>()];
    let key = |row: &DefendedRow| [&row.held.detector, &row.held.variant, &row.held.base].map(String::clone);
    for names in distinct(rows.iter().map(key)) {
        let own = |column: &&str| rows.iter().find(|row| row.defence == *column && key(row) == names);
        let cells = columns
            .iter()
            .map(|column| own(column).map_or_else(String::new, |row| cell(&row.held)));
        lines.push(names.iter().cloned().chain(cells).collect());
    }
    lines
}

/// As in `0.87 → 0.16 [0.45, 0.93]*`; `sign`: 1 for a drop, −1 for what is added.
fn cell(held: &Held, sign: f64) -> String {
    let number = |v: f64| digits(v, 2);
    let interval = held.ap50.interval_95.map(|i| {
        let (a, b) = (sign * i.low, sign * i.high);
        format!(" [{}, {}]", number(a.min(b)), number(a.max(b)))
    });
    let mark = if held.finding.is_some_and(|finding| finding.effect.is_shown()) {
        "*"
    } else {
        ""
    };
    let [base, other] = [held.ap50.base, held.ap50.other].map(number);
    format!("{base} → {other}{}{mark}", interval.unwrap_or_default())
}

/// For the terminal; nothing where it was not asked for.
pub(super) fn lines(scores: &Scores) -> Vec<String> {
    let tables = scores.defences.iter().flat_map(tables);
    let lines = tables
        .zip(["on defended photos", "what each defence changes"])
        .flat_map(|((cells, rows), what)| {
            let aligned = protocol::aligned(&rows.iter().collect::<Vec<_>>());
            [String::new(), format!("{what}: {cells}")].into_iter().chain(aligned)
        });
    lines.collect()
}

/// Both tables, with what the defences are above them.
fn tex(scores: &Scores, defences: &Defences) -> String {
    let cards = defences
        .defences
        .iter()
        .map(|d| format!("% {}: {} ({})", d.name, d.does, d.source));
    let cards: String = cards.map(|card| one_line(&card) + "\n").collect();
    let cell = |cell: &String| match escaped(cell) {
        // Numbers, with their true minus sign.
        numbers if cell.contains('→') => numbers.replace('-', "$-$").replace('→', "$\\to$"),
        name => name,
    };
    let line = |cells: &Vec<String>| row(cells.iter().map(cell));
    let tables = tables(defences).map(|(cells, rows)| {
        let columns = "l".repeat(rows[0].len());
        let table = tabular(&columns, [vec![line(&rows[0])], rows[1..].iter().map(line).collect()]);
        format!("% {cells}.\n{table}")
    });
    let counted = one_line(&counted::counted(scores));
    format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}. AP@0.5: {}. Counts as the model: {counted}.\n{cards}{}",
        env!("CARGO_PKG_VERSION"),
        scores.criteria.ap.name(),
        tables.join("\n")
    )
}

/// As one line of a comment.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}
