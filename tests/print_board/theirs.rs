//! OpenCV's ArUco, where the installed version keeps it: up to 4.6 the contrib module `aruco`, from 4.7 on `objdetect`.

use opencv::core::{Mat, Point2f, Size, Vector};
use opencv::prelude::*;

/// A marker's id and its corners in px.
pub type Found = (i32, [[f64; 2]; 4]);

/// OpenCV's `CORNER_REFINE_SUBPIX`.
const SUBPIX: i32 = 1;
/// Half the gap between a marker and the next edge, px at 300 dpi.
const WINDOW: i32 = 5;

/// Size in squares, sides in mm, and OpenCV's number for the dictionary.
#[derive(Clone, Copy)]
pub struct Charuco {
    pub squares: (u32, u32),
    pub square_mm: f64,
    pub marker_mm: f64,
    pub dictionary: i32,
}

fn square(corners: Vector<Point2f>) -> [[f64; 2]; 4] {
    let at = |i: usize| corners.get(i).map(|p| [f64::from(p.x), f64::from(p.y)]).unwrap();
    [0, 1, 2, 3].map(at)
}

scaleproof_pose::by_opencv! {
before_4_7 {
mod of_this_version {
    use opencv::aruco::{
        CharucoBoard, DetectorParameters, detect_markers, detect_markers_def, get_predefined_dictionary_i32,
        interpolate_corners_charuco_def,
    };
    use opencv::core::Ptr;

    use super::*;

    /// Every marker of a dictionary in a grey image, refined.
    pub fn markers(picture: &Mat, dictionary: i32, border_bits: i32) -> Vec<Found> {
        let mut parameters = DetectorParameters::create().unwrap();
        parameters.set_marker_border_bits(border_bits);
        parameters.set_corner_refinement_method(SUBPIX);
        parameters.set_corner_refinement_win_size(WINDOW);
        let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
        let dictionary = get_predefined_dictionary_i32(dictionary).unwrap();
        let mut rejected = Vector::<Vector<Point2f>>::new();
        detect_markers(picture, &dictionary, &mut corners, &mut ids, &parameters, &mut rejected).unwrap();
        ids.iter().zip(corners.iter().map(square)).collect()
    }

    fn board(b: Charuco) -> Ptr<CharucoBoard> {
        let dictionary = get_predefined_dictionary_i32(b.dictionary).unwrap();
        let (across, down) = (b.squares.0 as i32, b.squares.1 as i32);
        CharucoBoard::create(across, down, b.square_mm as f32, b.marker_mm as f32, &dictionary).unwrap()
    }

    /// OpenCV's own image of the board.
    pub fn drawing(b: Charuco, size: Size) -> Mat {
        let mut drawing = Mat::default();
        board(b).draw(size, &mut drawing, 0, 1).unwrap();
        drawing
    }

    /// The inner corners that OpenCV finds: id, px.
    pub fn corners(b: Charuco, picture: &Mat) -> Vec<(u32, [f64; 2])> {
        let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
        let dictionary = get_predefined_dictionary_i32(b.dictionary).unwrap();
        detect_markers_def(picture, &dictionary, &mut corners, &mut ids).unwrap();
        let (mut places, mut numbers) = (Vector::<Point2f>::new(), Vector::<i32>::new());
        interpolate_corners_charuco_def(&corners, &ids, picture, &board(b), &mut places, &mut numbers).unwrap();
        numbered(&numbers, &places)
    }
}
}
since_4_7 {
mod of_this_version {
    use opencv::objdetect::{
        ArucoDetector, CharucoBoard, CharucoDetector, DetectorParameters, RefineParameters,
        get_predefined_dictionary_i32,
    };

    use super::*;

    /// Every marker of a dictionary in a grey image, refined.
    pub fn markers(picture: &Mat, dictionary: i32, border_bits: i32) -> Vec<Found> {
        let mut parameters = DetectorParameters::default().unwrap();
        parameters.set_marker_border_bits(border_bits);
        parameters.set_corner_refinement_method(SUBPIX);
        parameters.set_corner_refinement_win_size(WINDOW);
        let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
        let dictionary = get_predefined_dictionary_i32(dictionary).unwrap();
        let refine = RefineParameters::new_def().unwrap();
        let detector = ArucoDetector::new(&dictionary, &parameters, refine).unwrap();
        detector.detect_markers_def(picture, &mut corners, &mut ids).unwrap();
        ids.iter().zip(corners.iter().map(square)).collect()
    }

    fn board(b: Charuco) -> CharucoBoard {
        let dictionary = get_predefined_dictionary_i32(b.dictionary).unwrap();
        let size = Size::new(b.squares.0 as i32, b.squares.1 as i32);
        CharucoBoard::new_def(size, b.square_mm as f32, b.marker_mm as f32, &dictionary).unwrap()
    }

    /// OpenCV's own image of the board.
    pub fn drawing(b: Charuco, size: Size) -> Mat {
        let mut drawing = Mat::default();
        board(b).generate_image(size, &mut drawing, 0, 1).unwrap();
        drawing
    }

    /// The inner corners that OpenCV finds: id, px.
    pub fn corners(b: Charuco, picture: &Mat) -> Vec<(u32, [f64; 2])> {
        let (mut places, mut numbers) = (Vector::<Point2f>::new(), Vector::<i32>::new());
        let detector = CharucoDetector::new_def(&board(b)).unwrap();
        detector.detect_board_def(picture, &mut places, &mut numbers).unwrap();
        numbered(&numbers, &places)
    }
}
}
}

fn numbered(numbers: &Vector<i32>, places: &Vector<Point2f>) -> Vec<(u32, [f64; 2])> {
    let px = places.iter().map(|p| [f64::from(p.x), f64::from(p.y)]);
    numbers.iter().map(|id| id as u32).zip(px).collect()
}

pub use of_this_version::{corners, drawing, markers};
