//! Import of a CSV table with a header and one photo per line.

use std::collections::BTreeMap;

use csv::{Position, ReaderBuilder, StringRecord};

use super::rows::{ImportFault, ImportedPhoto, ImportedRows, viewpoint};
use crate::conditions::is_name;
use crate::list::PhotoEntry;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::spelling;
use scaleproof_pose::scene::Classes;

/// Columns, in any order; all others are conditions. Those after the seventh may be missing or empty, and so may `variant` and `place`.
const COLUMNS: [&str; 10] = [
    "file",
    "variant",
    "place",
    "x1",
    "y1",
    "x2",
    "y2",
    "azimuth_deg",
    "pitch_deg",
    "distance_mm",
];
const NEEDED: [&str; 5] = ["file", "x1", "y1", "x2", "y2"];

/// Parses a table with the header `file,variant,place,x1,y1,x2,y2,azimuth_deg,pitch_deg,distance_mm`, boxes in px; every box is the model's.
pub fn parse(text: &str, _: &Classes) -> Result<ImportedRows, ImportFault> {
    // Spreadsheet programs prefix UTF-8 with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| fault(e, text))?.clone();
    let columns = columns(&header)?;
    let conditions = header.iter().enumerate().filter(|(_, name)| !COLUMNS.contains(name));
    let conditions: Vec<(usize, &str)> = conditions.collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| fault(e, text))?;
        let line = record.position().map_or(0, |p| line(p, text));
        let at = |message: String| ImportFault::at(format!("line {line}"), message);
        rows.push(ImportedPhoto {
            place: format!("line {line}"),
            entry: entry(&record, &columns, &conditions).map_err(at)?,
            size: None,
        });
    }
    Ok((rows, Vec::new()))
}

/// Returns the index of each of [`COLUMNS`].
fn columns(header: &StringRecord) -> Result<[Option<usize>; 10], ImportFault> {
    let wanted = COLUMNS.join(",");
    let mut places = BTreeMap::new();
    for (i, name) in header.iter().enumerate() {
        if !COLUMNS.contains(&name) && !is_condition(name) {
            let message = format!(
                "`{name}` is no column this program reads: the header is {wanted}, and conditions by other names"
            );
            return Err(ImportFault::at("line 1", message));
        }
        if places.insert(name, i).is_some() {
            return Err(ImportFault::at("line 1", format!("the column {name} is there twice")));
        }
    }
    if let Some(name) = NEEDED.iter().find(|name| !places.contains_key(**name)) {
        let message = format!("the header has no column {name}: it is {wanted}");
        return Err(ImportFault::at("line 1", message));
    }
    Ok(COLUMNS.map(|name| places.get(name).copied()))
}

/// Returns true if a column besides [`COLUMNS`] can be a condition, and is not a misspelt one of them.
fn is_condition(name: &str) -> bool {
    let is_near = |known: &&str| 3 * spelling::edits(&name.to_lowercase(), known) <= name.chars().count();
    is_name(name) && !COLUMNS.iter().any(is_near)
}

fn entry(
    record: &StringRecord,
    columns: &[Option<usize>; 10],
    conditions: &[(usize, &str)],
) -> Result<PhotoEntry, String> {
    let text = |i: usize| columns[i].and_then(|c| record.get(c)).filter(|t| !t.is_empty());
    let number = |i: usize| match text(i) {
        None => Ok(None),
        Some(t) => match t.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(format!("{} is `{t}`: give a number", COLUMNS[i])),
        },
    };
    let needed = |i: usize| number(i)?.ok_or_else(|| format!("{} is empty: give a number", COLUMNS[i]));
    Ok(PhotoEntry {
        file: text(0).ok_or("file is empty: name the photo")?.to_owned(),
        variant: text(1).unwrap_or_default().to_owned(),
        place: text(2).map(str::to_owned),
        box_xyxy_px: Some(BoxPx::new(needed(3)?, needed(4)?, needed(5)?, needed(6)?)),
        viewpoint: viewpoint([number(7)?, number(8)?, number(9)?])?,
        conditions: conditions
            .iter()
            .filter_map(|(column, name)| Some(((*name).to_owned(), record.get(*column)?.to_owned())))
            .filter(|(_, value)| !value.is_empty())
            .collect(),
        ..PhotoEntry::default()
    })
}

/// Returns the line on which a record begins: the reader's position precedes the empty lines above it.
fn line(position: &Position, text: &str) -> u64 {
    let rest = text.as_bytes().get(position.byte() as usize..).unwrap_or_default();
    let empty = rest.iter().take_while(|b| matches!(b, b'\n' | b'\r'));
    position.line() + empty.filter(|b| **b == b'\n').count() as u64
}

fn fault(e: csv::Error, text: &str) -> ImportFault {
    let message = match e.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("it has {len} values where the header has {expected_len}")
        }
        _ => e.to_string().replace('\n', " "),
    };
    match e.position() {
        Some(position) => ImportFault::at(format!("line {}", line(position, text)), message),
        None => ImportFault::of_file(message),
    }
}
