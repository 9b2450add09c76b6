//! Drawing of the black parts of a board.

use super::BoardError;
use crate::shapes::{OutlineMm, TagPlacement, black_modules};
use crate::sheet::RectMm;
use scaleproof_core::geometry::Point2;
use scaleproof_pose::board::Definition;
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::{MarkerDictionary, Modules, TagImage};

/// Returns the black outlines of a board whose upper left corner is at `corner` (page frame).
pub fn black(definition: &Definition, corner: Point2) -> Result<Vec<OutlineMm>, BoardError> {
    match definition {
        Definition::Chessboard { squares, square_mm, .. } => Ok(black_squares(*squares, *square_mm, corner)),
        Definition::Charuco {
            squares,
            square_mm,
            marker_mm,
            dictionary,
            ..
        } => {
            let mut outlines = black_squares(*squares, *square_mm, corner);
            let dictionary = MarkerDictionary::named(dictionary)?;
            // OpenCV numbers the markers through the white squares, row by row from the top left (CharucoBoard, 4.6 and later).
            for (id, (row, column)) in places(*squares).filter(|place| !is_black(*place)).enumerate() {
                let Some(marker) = dictionary.marker(id) else { break };
                let centre = [
                    corner[0] + (f64::from(column) + 0.5) * square_mm,
                    corner[1] - (f64::from(row) + 0.5) * square_mm,
                ];
                outlines.extend(square_of(marker, centre, *marker_mm));
            }
            Ok(outlines)
        }
        Definition::Aprilgrid {
            tags,
            tag_mm,
            tag_spacing,
            border_modules,
            ..
        } => aprilgrid(*tags, *tag_mm, *tag_spacing * *tag_mm, *border_modules as usize, corner),
    }
}

/// Returns all (row, column), row by row from the top left.
fn places([columns, rows]: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
}

fn is_black((row, column): (u32, u32)) -> bool {
    row % 2 == column % 2
}

fn black_squares(squares: [u32; 2], square_mm: f64, corner: Point2) -> Vec<OutlineMm> {
    let x = |column: u32| corner[0] + f64::from(column) * square_mm;
    let y = |row: u32| corner[1] - f64::from(row) * square_mm;
    let square = |(row, column): (u32, u32)| RectMm::new(x(column), y(row + 1), x(column + 1), y(row)).outline();
    places(squares).filter(|place| is_black(*place)).map(square).collect()
}

fn square_of(modules: &Modules, centre: Point2, side_mm: f64) -> Vec<OutlineMm> {
    let place = TagPlacement {
        centre,
        right: [1.0, 0.0],
        module_mm: side_mm / modules.side() as f64,
    };
    black_modules(modules, &place)
}

/// Draws Kalibr's grid (`kalibr_create_target_pdf`): tags with a wide border, and a black square of the gap's width at every crossing.
fn aprilgrid(
    [columns, rows]: [u32; 2],
    tag_mm: f64,
    gap_mm: f64,
    border_modules: usize,
    corner: Point2,
) -> Result<Vec<OutlineMm>, BoardError> {
    let pitch = tag_mm + gap_mm;
    let at = |(row, column): (u32, u32)| {
        [
            corner[0] + f64::from(column) * pitch,
            corner[1] - f64::from(row) * pitch,
        ]
    };
    let crossings = places([columns + 1, rows + 1]).map(at);
    let mut outlines: Vec<OutlineMm> = crossings
        .map(|[x, y]| RectMm::new(x, y - gap_mm, x + gap_mm, y).outline())
        .collect();
    for (row, column) in places([columns, rows]) {
        let id = (rows - 1 - row) * columns + column;
        let image = TagImage::new(TagFamily::Tag36h11, id).ok_or(BoardError::NoImage { id })?;
        // Replaces white ring and border by Kalibr's border.
        let ring = (image.modules().side() - image.border_modules()) / 2;
        let tag = image.modules().cropped(ring + 1).framed(border_modules, true);
        let [x, y] = at((row, column));
        let centre = [x + gap_mm + tag_mm / 2.0, y - gap_mm - tag_mm / 2.0];
        outlines.extend(square_of(&tag, centre, tag_mm));
    }
    Ok(outlines)
}
