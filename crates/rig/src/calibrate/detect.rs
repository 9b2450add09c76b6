//! Search for the corners of a calibration board in one photo.

use std::f64::consts::SQRT_2;

use image::GrayImage;
use opencv::calib3d;
use opencv::core::{Mat, Point2d, Point2f, Size, TermCriteria, Vector};
use opencv::prelude::*;

use super::board_photo::SeenCorner;
use super::sharpness::{BLURRED_PX, edge_width_px};
use scaleproof_core::geometry::{distance, extent};
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::statistics::upper_median;
use scaleproof_photo::Luma;
use scaleproof_pose::board::{Definition, Marker};
use scaleproof_pose::tags::{
    DictionaryError, MarkerDictionary, SeenMarker, enlarged, least_reduction, marker_search, sides_px,
};

/// Number of pixels from which photos are reduced for the search: OpenCV takes some 45 bytes for each pixel.
const MOST_SEARCHED_PX: u64 = 27_000_000;

/// Searches for a chessboard, the quick and likely ones first: in a copy of at most so many pixels, with these flags. OpenCV's search takes minutes
/// and gigabytes at 12 megapixels and misses boards there that it finds in smaller copies, whose squares are as wide as its filters; each flag finds
/// boards that the other misses.
const CHESSBOARD_SEARCHES: [(u64, i32); 7] = [
    (1_500_000, calib3d::CALIB_CB_NORMALIZE_IMAGE),
    (1_500_000, calib3d::CALIB_CB_EXHAUSTIVE),
    (400_000, calib3d::CALIB_CB_NORMALIZE_IMAGE),
    (400_000, calib3d::CALIB_CB_EXHAUSTIVE),
    (4_000_000, calib3d::CALIB_CB_NORMALIZE_IMAGE),
    (1_500_000, CHESSBOARD_THOROUGH),
    (4_000_000, calib3d::CALIB_CB_EXHAUSTIVE),
];
const CHESSBOARD_THOROUGH: i32 = calib3d::CALIB_CB_NORMALIZE_IMAGE | calib3d::CALIB_CB_EXHAUSTIVE;

/// Least side of an image that is searched, px.
const LEAST_SIDE_PX: u32 = 32;

/// Least number of corners of a photo: fewer say little, and their halves could not be compared.
pub(super) const LEAST_CORNERS: usize = 12;

/// Largest half side of the square that `cornerSubPix` averages over; more averages the lens's distortion in.
const WIDEST_WINDOW_PX: f64 = 10.0;
/// The least half side: with 1 px, noise alone moves a corner by half a pixel.
const NARROWEST_WINDOW_PX: f64 = 2.0;
/// Largest error of a guess, as a share of the room around the corner: OpenCV puts the corners of an AprilGrid's large tags up to 12 px out (sides of
/// 146 px, room of 44).
const LARGEST_MISS: f64 = 1.0 / 3.0;
/// Least distance from a corner to the next; nearer ones pull at it. Down to here, corners of ChArUco boards lie within 0.1 px (root mean square) of
/// a plane's homography.
const LEAST_ROOM_PX: f64 = 2.4;

/// Refuses a board whose markers OpenCV does not know.
pub fn check(board: &Definition) -> Result<(), DictionaryError> {
    match board {
        Definition::Charuco { dictionary, .. } => MarkerDictionary::named(dictionary).map(drop),
        _ => Ok(()),
    }
}

fn not_found() -> Message {
    message!("no board was found: is this the board of the file, wholly in the photo, sharp and evenly lit?")
}

fn not_flat() -> Message {
    message!(
        "the corners found do not lie on a flat board of these measures: is the board file another board's, or is the board bent?"
    )
}

/// Finds the board's corners to a fraction of a pixel.
///
/// ChArUco: markers, then each inner corner by the homography of the two markers beside it (OpenCV's `interpolateCornersCharuco`
/// without a camera), refined as a saddle point. AprilGrid: Kalibr's tag corners touch black squares, so they are saddle points too.
/// Chessboard: OpenCV's sector-based detector (Duda & Frese 2018), which must see the whole board, in reduced copies of large photos; the corners
/// are then refined as saddle points at full size.
pub(super) fn find(grey: &GrayImage, board: &Definition) -> Result<Vec<SeenCorner>, Message> {
    let factor = least_reduction(grey, MOST_SEARCHED_PX);
    if grey.width().min(grey.height()) / factor < LEAST_SIDE_PX {
        return Err(not_found());
    }
    if factor == 1 {
        return find_in(grey, board);
    }
    let mut found = find_in(&grey.reduced(factor), board)?;
    for corner in &mut found {
        corner.px = enlarged(corner.px, factor);
    }
    Ok(found)
}

fn find_in(grey: &GrayImage, board: &Definition) -> Result<Vec<SeenCorner>, Message> {
    let image = mat(grey).map_err(failed)?;
    let (found, markers) = match board {
        Definition::Chessboard { inner_corners, .. } => {
            let found = chessboard(grey, &image, *inner_corners).map_err(failed)?;
            (found, Vec::new())
        }
        Definition::Charuco { dictionary, .. } => {
            let seen = known(markers(&image, dictionary, 1)?, board, 0)?;
            (charuco(&image, board, &seen).map_err(failed)?, seen)
        }
        Definition::Aprilgrid { border_modules, .. } => {
            // OpenCV's image of this family is turned by 180°: its first corner is the upright tag's lower right.
            let seen = known(markers(&image, "DICT_APRILTAG_36h11", *border_modules)?, board, 2)?;
            (aprilgrid(&image, board, &seen).map_err(failed)?, seen)
        }
    };
    if found.len() >= LEAST_CORNERS {
        return flat_enough(found, board);
    }
    if let Some(small) = small_squares(board, &markers) {
        return Err(small);
    }
    Err(match (found.len(), edge_width_px(grey, &found)) {
        (0, _) => not_found(),
        (_, Some(width_px)) if width_px > BLURRED_PX => message!(
            "it is blurred: its edges are {width_px:.0} px wide, more than {BLURRED_PX} px; hold board and camera still"
        ),
        (found, _) => message!(
            "only {found} of the board's {} corners were found, {LEAST_CORNERS} are needed: bring it nearer, or light it better",
            board.corners_mm().len()
        ),
    })
}

/// Returns the distance from a corner of the board to the nearest thing that its window must not hold, mm.
fn room_mm(board: &Definition) -> f64 {
    match board {
        Definition::Chessboard { square_mm, .. } => *square_mm,
        // The corner of the next marker.
        Definition::Charuco {
            square_mm, marker_mm, ..
        } => (square_mm - marker_mm) / SQRT_2,
        // The far corners of the black square at the crossing, and the inner one of the border.
        Definition::Aprilgrid {
            tag_mm,
            tag_spacing,
            border_modules,
            ..
        } => {
            let border_mm = tag_mm * f64::from(*border_modules) / f64::from(Definition::GRID_TAG_MODULES);
            (tag_mm * tag_spacing).min(border_mm * SQRT_2)
        }
    }
}

/// Returns the error of markers that are seen in squares (or tags) too small for their corners.
fn small_squares(board: &Definition, markers: &[PlacedMarker]) -> Option<Message> {
    let side_mm = match board {
        Definition::Aprilgrid { tag_mm: side_mm, .. }
        | Definition::Charuco { square_mm: side_mm, .. }
        | Definition::Chessboard { square_mm: side_mm, .. } => side_mm,
    };
    let scales: Vec<f64> = markers.iter().map(PlacedMarker::px_per_mm).collect();
    let square_px = side_mm * upper_median(&scales)?;
    let least_px = (side_mm * LEAST_ROOM_PX / room_mm(board)).ceil();
    (square_px < least_px).then(|| {
        message!(
            "the board is too small in the photo: its squares are {square_px:.0} px wide, {least_px:.0} px are needed; bring it nearer"
        )
    })
}

fn mat(grey: &GrayImage) -> opencv::Result<Mat> {
    Mat::from_slice(grey.as_raw().as_slice())?
        .reshape(1, grey.height() as i32)?
        .try_clone()
}

fn failed(e: opencv::Error) -> Message {
    message!("OpenCV gave up: {}", e.message.lines().next().unwrap_or_default())
}

/// Finds every marker of a dictionary, whose black border is `border_modules` modules wide.
fn markers(image: &Mat, dictionary: &str, border_modules: u32) -> Result<Vec<SeenMarker>, Message> {
    let search = marker_search(dictionary, border_modules).map_err(|e| message!("OpenCV gave up: {e}"))?;
    search.find(image).map_err(failed)
}

/// A marker of the board, and its corners in the photo (upper left first).
struct PlacedMarker {
    marker: Marker,
    corners_px: [[f64; 2]; 4],
}

impl PlacedMarker {
    /// Returns the shortest side, in px per mm of the board.
    fn px_per_mm(&self) -> f64 {
        let [mm, ..] = sides_px(&self.marker.corners_mm);
        sides_px(&self.corners_px).into_iter().fold(f64::INFINITY, f64::min) / mm
    }
}

/// Returns the seen markers that the board has, each seen once; `first` is OpenCV's number for the upper left corner.
fn known(seen: Vec<SeenMarker>, board: &Definition, first: usize) -> Result<Vec<PlacedMarker>, Message> {
    let all = board.markers();
    let times = |id: i32| seen.iter().filter(|m| m.id == id).count();
    let place = |m: &SeenMarker| {
        Some(PlacedMarker {
            marker: *all.get(usize::try_from(m.id).ok()?)?,
            corners_px: [0, 1, 2, 3].map(|i| m.corners_px[(first + i) % 4]),
        })
    };
    let once = seen.iter().filter(|m| times(m.id) == 1);
    let placed: Vec<PlacedMarker> = once.filter_map(place).collect();
    let (foreign, seen) = (seen.iter().filter(|m| m.id as usize >= all.len()).count(), seen.len());
    if foreign > placed.len() {
        bail!("{foreign} of the {seen} markers seen are not on this board: is the board file another board's?");
    }
    Ok(placed)
}

fn charuco(image: &Mat, board: &Definition, seen: &[PlacedMarker]) -> opencv::Result<Vec<SeenCorner>> {
    let Definition::Charuco { square_mm, .. } = board else {
        return Ok(Vec::new());
    };
    let mut found = Vec::new();
    for (id, corner) in board.corners_mm().into_iter().enumerate() {
        // The two white squares that meet in this corner are the two with the nearest markers.
        let near = |p: &&PlacedMarker| {
            let [a, _, c, _] = p.marker.corners_mm;
            (0..2).all(|k| ((a[k] + c[k]) / 2.0 - corner[k]).abs() < *square_mm)
        };
        let beside: Vec<&PlacedMarker> = seen.iter().filter(near).collect();
        let [a, b] = beside[..] else { continue };
        let from = [a, b].map(|p| p.marker.corners_mm).concat();
        let to = [a, b].map(|p| p.corners_px).concat();
        // The homography of the two markers maps the corner into the image.
        let homography = calib3d::find_homography_ext_def(&points(&from), &points(&to))?;
        let Some(guess) = through(&homography, corner) else {
            continue;
        };
        let free_px = room_mm(board) * a.px_per_mm().min(b.px_per_mm());
        found.extend(refined(image, guess, free_px)?.map(|px| SeenCorner { id, px }));
    }
    Ok(found)
}

fn aprilgrid(image: &Mat, board: &Definition, seen: &[PlacedMarker]) -> opencv::Result<Vec<SeenCorner>> {
    let mut found = Vec::new();
    for placed in seen {
        for (i, guess) in placed.corners_px.into_iter().enumerate() {
            let id = placed.marker.id as usize * 4 + i;
            let free_px = room_mm(board) * placed.px_per_mm();
            found.extend(refined(image, guess, free_px)?.map(|px| SeenCorner { id, px }));
        }
    }
    found.sort_by_key(|c| c.id);
    Ok(found)
}

fn chessboard(grey: &GrayImage, image: &Mat, inner_corners: [u32; 2]) -> opencv::Result<Vec<SeenCorner>> {
    let mut tried = Vec::new();
    for (most_px, flags) in CHESSBOARD_SEARCHES {
        let factor = least_reduction(grey, most_px);
        if tried.contains(&(factor, flags)) {
            continue;
        }
        tried.push((factor, flags));
        let found = match factor {
            1 => sectors(image, inner_corners, flags | calib3d::CALIB_CB_ACCURACY)?,
            _ => sectors(&mat(&grey.reduced(factor))?, inner_corners, flags)?,
        };
        if !found.is_empty() {
            return match factor {
                1 => Ok(numbered(found)),
                _ => saddles(image, &found, factor),
            };
        }
    }
    Ok(Vec::new())
}

/// Returns all inner corners, row by row, or none.
fn sectors(image: &Mat, inner_corners: [u32; 2], flags: i32) -> opencv::Result<Vec<[f64; 2]>> {
    let size = Size::new(inner_corners[0] as i32, inner_corners[1] as i32);
    let mut corners = Vector::<Point2f>::new();
    if !calib3d::find_chessboard_corners_sb(image, size, &mut corners, flags)? {
        return Ok(Vec::new());
    }
    Ok(corners.iter().map(|p| [p.x, p.y].map(f64::from)).collect())
}

fn numbered(corners: Vec<[f64; 2]>) -> Vec<SeenCorner> {
    let corner = |(id, px)| SeenCorner { id, px };
    corners.into_iter().enumerate().map(corner).collect()
}

/// Returns the saddle points near places in a copy reduced by a factor; those without room are left out.
fn saddles(image: &Mat, found: &[[f64; 2]], factor: u32) -> opencv::Result<Vec<SeenCorner>> {
    let mut corners = Vec::new();
    for (id, place) in found.iter().enumerate() {
        let others = found.iter().enumerate().filter(|(other, _)| *other != id);
        let free_px = others
            .map(|(_, px)| distance(*px, *place))
            .fold(f64::INFINITY, f64::min);
        let guess = enlarged(*place, factor);
        corners.extend(refined(image, guess, free_px * f64::from(factor))?.map(|px| SeenCorner { id, px }));
    }
    Ok(corners)
}

/// Returns the saddle point near a guess; `None` where there is no room to search, or where it lies too far from the guess.
fn refined(image: &Mat, guess: [f64; 2], free_px: f64) -> opencv::Result<Option<[f64; 2]>> {
    // The window's corner does not lie beyond the next corner, or hardly: there its weight is small.
    let half = (free_px / SQRT_2).floor().clamp(NARROWEST_WINDOW_PX, WIDEST_WINDOW_PX);
    let inside = |at: f64, length: i32| at >= half + 1.0 && at <= f64::from(length) - half - 2.0;
    if free_px < LEAST_ROOM_PX || !inside(guess[0], image.cols()) || !inside(guess[1], image.rows()) {
        return Ok(None);
    }
    let mut corner = Vector::<Point2f>::from_iter([Point2f::new(guess[0] as f32, guess[1] as f32)]);
    let stop = TermCriteria::new(3, 60, 1e-4)?;
    let window = Size::new(half as i32, half as i32);
    opencv::imgproc::corner_sub_pix(image, &mut corner, window, Size::new(-1, -1), stop)?;
    let point = corner.get(0)?;
    let px = [f64::from(point.x), f64::from(point.y)];
    let reach = half.min(4.0).max(free_px * LARGEST_MISS);
    Ok((distance(px, guess) < reach).then_some(px))
}

fn through(h: &Mat, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let [a, b, c, d, e, f, g, i, j]: [f64; 9] = h.data_typed::<f64>().ok()?.try_into().ok()?;
    let w = g * x + i * y + j;
    (w != 0.0).then(|| [(a * x + b * y + c) / w, (d * x + e * y + f) / w])
}

/// Checks the corners against one homography, from which a lens bends them by a few per cent at most. A corner further off was found in a wrong place
/// and is left out; when that is every fifth, the board is not the one described.
fn flat_enough(found: Vec<SeenCorner>, board: &Definition) -> Result<Vec<SeenCorner>, Message> {
    const BENT_SHARE: f64 = 0.04;
    let places = board.corners_mm();
    let (from, to): (Vec<[f64; 2]>, Vec<[f64; 2]>) = found.iter().map(|c| (places[c.id], c.px)).unzip();
    let length = |axis: usize| {
        let (low, high) = extent(to.iter().map(|p| p[axis]));
        high - low
    };
    let limit_px = BENT_SHARE * length(0).hypot(length(1));
    let mut mask = Mat::default();
    let h = calib3d::find_homography(&points(&from), &points(&to), &mut mask, calib3d::RANSAC, limit_px);
    let Ok(h) = h else { return Err(not_flat()) };
    let all = found.len();
    let fits = |c: &SeenCorner| through(&h, places[c.id]).is_some_and(|px| distance(px, c.px) <= limit_px);
    let kept: Vec<SeenCorner> = found.into_iter().filter(fits).collect();
    if kept.len() * 5 < all * 4 || kept.len() < LEAST_CORNERS {
        return Err(not_flat());
    }
    Ok(kept)
}

fn points(list: &[[f64; 2]]) -> Vector<Point2d> {
    list.iter().map(|[x, y]| Point2d::new(*x, *y)).collect()
}
