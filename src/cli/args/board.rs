//! Arguments of `print board`.

use std::path::PathBuf;

use crate::cli::print::{CutSheetArgs, value_names};
use scaleproof_print::board::BoardKind;

#[derive(clap::Args)]
pub struct BoardArgs {
    /// The kind of board
    #[arg(long = "type", value_parser = board_kind())]
    pub kind: BoardKind,
    /// Columns and rows, as in 9x7; of an AprilGrid, of tags
    #[arg(long, value_name = "CxR", value_parser = columns_and_rows)]
    pub squares: (u32, u32),
    /// Side of a square in mm; of an AprilGrid, from one tag to the next
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub square_mm: f64,
    /// Side of a marker or tag, black border included, in mm [default: 0.75 of a ChArUco square, 1/1.3 of an AprilGrid's]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub marker_mm: Option<f64>,
    /// OpenCV's dictionary of the ChArUco markers [default: DICT_5X5_100]
    #[arg(long, value_name = "NAME")]
    pub dictionary: Option<String>,
    #[command(flatten)]
    pub sheets: CutSheetArgs,
    /// The definition to write [default: beside the PDF, ending in .toml]
    #[arg(long, value_name = "TOML")]
    pub definition: Option<PathBuf>,
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}

value_names!(board_kind -> BoardKind:
    Charuco "charuco" "Chessboard with markers in its white squares, as OpenCV 4.6 and later lay it out",
    Chessboard "chessboard",
    Aprilgrid "aprilgrid" "Kalibr's grid of tag36h11");

fn columns_and_rows(text: &str) -> Result<(u32, u32), String> {
    let read = |part: &str| part.trim().parse().ok();
    let both = text
        .split_once(['x', 'X', '×'])
        .and_then(|(c, r)| Some((read(c)?, read(r)?)));
    both.ok_or_else(|| "write columns and rows, as in 9x7".to_owned())
}
