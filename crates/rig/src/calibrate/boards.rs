//! Photos searched for the board.

use std::path::{Path, PathBuf};

use super::board_photo::{BoardPhoto, UnusedPhoto};
use super::{detect, sharpness};
use scaleproof_core::{files, workers};
use scaleproof_photo::Photo;
use scaleproof_pose::board::Definition;

/// Finds the board in every photo; those without are named with the reason. Both lists keep the photos' order.
pub fn detect_boards(
    photos: &[PathBuf],
    board: &Definition,
    on_done: impl Fn() + Sync,
) -> (Vec<BoardPhoto>, Vec<UnusedPhoto>) {
    let found = workers::map(
        photos,
        || Ok::<(), std::convert::Infallible>(()),
        |(), path| Ok(detect_board(path, board)),
        on_done,
    );
    let (mut board_photos, mut left_out) = (Vec::new(), Vec::new());
    for result in found.unwrap_or_else(|never| match never {}) {
        match result {
            Ok(board_photo) => board_photos.push(board_photo),
            Err(out) => left_out.push(out),
        }
    }
    (board_photos, left_out)
}

fn detect_board(path: &Path, board: &Definition) -> Result<BoardPhoto, UnusedPhoto> {
    let file = files::name_of(path);
    let out = |e: &dyn std::error::Error| UnusedPhoto {
        file: file.clone(),
        reason: e.to_string(),
    };
    let photo = Photo::open(path).map_err(|e| out(&e))?;
    let luma = photo.sensor_luma().map_err(|e| out(&e))?;
    let corners = detect::find(&luma, board).map_err(|e| out(&e))?;
    Ok(BoardPhoto {
        edge_width_px: sharpness::edge_width_px(&luma, &corners),
        file,
        size: luma.dimensions(),
        turned_deg: photo.turned_deg,
        corners,
    })
}
