//! A table for programs: CSV and JSON, with every number in full.

use serde_json::{Map, Value as Json, json};

use crate::report::ReportError;
use crate::report::csv::rows::csv_of;
use crate::report::table::{Cell, Table, Value};

/// Endings of a column's key where its cells hold more than one number.
const ENDINGS: [&str; 6] = ["", "_from", "_to", "_of", "_low", "_high"];

impl Table {
    /// Returns a header of the columns' keys and a line for each row; a cell of two numbers takes two columns, an interval two more.
    pub fn csv(&self) -> Result<String, ReportError> {
        csv_of(self.records())
    }

    /// Returns an object for each row, with the columns of [`Table::csv`].
    pub fn json(&self) -> Json {
        let objects = self
            .records()
            .into_iter()
            .map(|record| Json::Object(Map::from_iter(record)));
        Json::Array(objects.collect())
    }

    fn records(&self) -> Vec<Vec<(String, Json)>> {
        let all: Vec<Vec<&str>> = (0..self.columns.len()).map(|column| self.endings(column)).collect();
        let record = |row: &Vec<Cell>| {
            let cells = row.iter().zip(&self.columns).zip(&all);
            cells
                .flat_map(|((cell, column), endings)| {
                    let named = |ending: &&str| (format!("{}{ending}", column.key), cell.number_of(ending));
                    endings.iter().map(named).collect::<Vec<_>>()
                })
                .collect()
        };
        self.rows().map(record).collect()
    }

    /// Returns the endings that some cell of the column has a value for; the first alone where no cell has any.
    fn endings(&self, column: usize) -> Vec<&'static str> {
        let has = |ending: &&&str| self.rows().any(|row| !row[column].number_of(ending).is_null());
        let found: Vec<&str> = ENDINGS.iter().filter(has).copied().collect();
        if found.is_empty() { vec![ENDINGS[0]] } else { found }
    }
}

impl Cell {
    fn number_of(&self, ending: &str) -> Json {
        match (ending, &self.value) {
            ("", Value::Text(text)) => json!(text),
            ("", Value::Count(count) | Value::Share { count, .. }) => json!(count),
            ("", Value::Number { value, .. }) => json!(value),
            ("_from", Value::Change { from, .. }) => json!(from),
            ("_to", Value::Change { to, .. }) => json!(to),
            ("_from", Value::ShareChange { from, .. }) => json!(from),
            ("_to", Value::ShareChange { to, .. }) => json!(to),
            ("_of", Value::Share { of, .. } | Value::ShareChange { of, .. }) => json!(of),
            ("_low", _) => json!(self.interval.map(|interval| interval.low)),
            ("_high", _) => json!(self.interval.map(|interval| interval.high)),
            _ => Json::Null,
        }
    }
}
