//! `scaleproof print board`: a calibration board and the file that describes it.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cli::answer::{told, written};
use crate::cli::args::board::BoardArgs;
use crate::cli::print::board::Answer;
use crate::cli::{CommandResult, units};
use scaleproof_core::files;
use scaleproof_plot::lettering::number;
use scaleproof_print::board::{BoardError, BoardRequest, board};

/// Boards below this are smaller than a matchbox.
const SMALLEST_BOARD_MM: f64 = 50.0;

/// Runs `scaleproof print board`.
pub fn run(args: &BoardArgs, out: &mut dyn Write) -> CommandResult {
    let definition_path = match &args.definition {
        Some(path) => path.clone(),
        None if files::is_standard_output(&args.sheets.output) => {
            return Err("nothing lies beside standard output: name the definition by --definition".into());
        }
        None => args.sheets.output.with_extension("toml"),
    };
    let made = board(&BoardRequest {
        kind: args.kind,
        squares: args.squares,
        square_mm: args.square_mm,
        marker_mm: args.marker_mm,
        dictionary: args.dictionary.clone(),
        media: args.sheets.media()?,
    })
    .map_err(advised)?;
    let line = made.definition.line();
    let mut files = args.sheets.file(&line, &made.sheet)?;
    files.push((definition_path.clone(), made.definition.to_toml()?.into_bytes()));
    let named: Vec<&Path> = [Some(&args.sheets.output), args.definition.as_ref()]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
        .collect();
    files::write_beside(&named, &files)?;
    units::note(doubt(args.squares, args.square_mm));
    let (pdf, definition) = (files[0].0.display(), definition_path.display().to_string());
    let words = format!("{pdf}: {line}; print at 100 %; described by {definition}");
    let facts = Answer {
        board: line,
        definition,
    };
    told(args.json, written(&files, facts), words, out)
}

fn advised(error: BoardError) -> String {
    match &error {
        BoardError::MarkerTooLarge { .. } => format!("{error}; use a smaller --marker-mm"),
        BoardError::MarkerSizeUnused { board } => format!("--marker-mm means nothing on {board}; leave it out"),
        BoardError::DictionaryUnused { board } => format!("--dictionary means nothing on {board}; leave it out"),
        _ => error.to_string(),
    }
}

/// About the squares of a calibration board.
fn doubt(squares: (u32, u32), square_mm: f64) -> Option<String> {
    let [width, height] = [squares.0, squares.1].map(|count| f64::from(count) * square_mm);
    (width.max(height) < SMALLEST_BOARD_MM).then(|| {
        let (size, meant) = (units::sides(&[width, height], " × "), number(square_mm * 10.0));
        format!("the board is {size} mm: were the squares in cm? That is --square-mm {meant}")
    })
}

#[cfg(test)]
#[path = "../tests/board.rs"]
mod tests;
