//! Rows of tables for spreadsheets.

use serde_json::Value;

use crate::report::ReportError;

/// A line of a table for spreadsheets: each column's name and value.
pub(crate) type Row<'a> = Vec<(&'a str, Value)>;

/// Writes a table with a header, for spreadsheets; a value that is null is left empty.
pub(crate) fn csv_of<N: AsRef<str>>(rows: impl IntoIterator<Item = Vec<(N, Value)>>) -> Result<String, ReportError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    for (i, row) in rows.into_iter().enumerate() {
        let (names, values): (Vec<N>, Vec<Value>) = row.into_iter().unzip();
        if i == 0 {
            writer.write_record(names.iter().map(AsRef::as_ref))?;
        }
        writer.serialize(values)?;
    }
    let text = writer.into_inner().map_err(|e| ::csv::Error::from(e.into_error()))?;
    // All values were valid UTF-8: nothing is lost.
    Ok(String::from_utf8_lossy(&text).into_owned())
}
