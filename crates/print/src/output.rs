//! Output files of sheets: one PDF, or one SVG per sheet.

use std::path::{Path, PathBuf};

use super::sheet::Sheet;
use super::{SheetError, pdf, svg};
use scaleproof_core::files::{self, FileError};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SheetFormat {
    /// One file with all sheets.
    Pdf,
    /// One file per sheet, named OUTPUT-SHEET.svg.
    Svg,
}

#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error("{path} does not say whether PDF or SVG is meant: let it end in .pdf or .svg", path = path.display())]
    UnknownEnding { path: PathBuf },
    #[error("SVG makes one file per page, so it cannot go to standard output: name a file")]
    SvgToStandardOutput,
    #[error(transparent)]
    File(#[from] FileError),
}

#[derive(Debug, Clone, PartialEq)]
pub struct SheetOutput {
    path: PathBuf,
    /// Format of the files.
    pub format: SheetFormat,
}

impl SheetOutput {
    /// Creates an output in the requested format, else in that of the path's ending. Standard output, pipes and devices get a PDF.
    pub fn named(path: &Path, format: Option<SheetFormat>) -> Result<Self, OutputError> {
        let format = format.map_or_else(|| format_of(path), Ok)?;
        if format == SheetFormat::Svg && files::is_standard_output(path) {
            return Err(OutputError::SvgToStandardOutput);
        }
        let path = path.to_owned();
        Ok(Self { path, format })
    }

    /// Returns the files' contents, not written yet: one PDF, or one SVG for each of the names.
    ///
    /// # Errors
    /// Only if the PDF cannot be put together.
    pub fn files(
        &self,
        title: &str,
        names: &[String],
        sheets: &[Sheet],
    ) -> Result<Vec<(PathBuf, Vec<u8>)>, SheetError> {
        let svg = |(name, sheet): (&String, &Sheet)| {
            let text = svg::write(&format!("{title}: {name}"), sheet);
            (svg_path(&self.path, name), text.into_bytes())
        };
        Ok(match self.format {
            SheetFormat::Pdf => vec![(self.path.clone(), pdf::write(title, sheets)?)],
            SheetFormat::Svg => names.iter().zip(sheets).map(svg).collect(),
        })
    }
}

impl SheetOutput {
    /// Writes such files; the names of SVG's are this program's.
    pub fn write(&self, files: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
        files::write_beside(&[&self.path], files)
    }
}

fn format_of(path: &Path) -> Result<SheetFormat, OutputError> {
    let ends_in = |ending| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    match (ends_in("pdf"), ends_in("svg")) {
        (true, _) => Ok(SheetFormat::Pdf),
        (_, true) => Ok(SheetFormat::Svg),
        _ if files::is_stream(path)? => Ok(SheetFormat::Pdf),
        _ => Err(OutputError::UnknownEnding { path: path.to_owned() }),
    }
}

/// Returns the path of a sheet's SVG: `out/t.svg` and sheet `B2` give `out/t-B2.svg`.
fn svg_path(output: &Path, name: &str) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    // The sheet `cards 1` of the map is `cards-1` in a file's name.
    output.with_file_name(format!("{stem}-{}.svg", name.replace(' ', "-")))
}
