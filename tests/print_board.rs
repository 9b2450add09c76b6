//! Prints calibration boards, renders the PDF with poppler, and finds them with OpenCV.

use crate::common;
use crate::print_tags::paper;
mod theirs;

use std::path::Path;

use common::{assert_refused, program, stderr};
use opencv::core::{Mat, Point2f, Size, TermCriteria, Vector};
use opencv::prelude::*;
use paper::{A4, Mm, Page, distance, render};
use scaleproof_print::board::{BoardKind, BoardRequest, Definition, board};
use scaleproof_print::media::Media;
use scaleproof_print::paper::Paper;
use scaleproof_print::sheet::RectMm;
use theirs::Charuco;

const DICT_5X5_100: i32 = 5;
const DICT_6X6_250: i32 = 10;
const DICT_APRILTAG_36H11: i32 = 20;

/// A printed board: its page, and where the program says it lies.
struct Printed {
    page: Page,
    area: RectMm,
    definition: Definition,
}

impl Printed {
    /// A place by the distance right of and below the board's upper left corner.
    fn at(&self, x_mm: f64, y_mm: f64) -> Mm {
        [self.area.left_mm + x_mm, self.area.top_mm - y_mm]
    }

    fn picture(&self) -> Mat {
        let picture = &self.page.picture;
        let flat = Mat::from_slice(picture.as_raw()).unwrap();
        flat.reshape(1, picture.height() as i32).unwrap().try_clone().unwrap()
    }
}

fn print(
    command: &str,
    kind: BoardKind,
    squares: (u32, u32),
    square_mm: f64,
    marker_mm: Option<f64>,
    dictionary: Option<&str>,
) -> Printed {
    let folder = tempfile::tempdir().unwrap();
    let mut command = format!(
        "print board --type {command} --squares {}x{} --square-mm {square_mm} -o b.pdf",
        squares.0, squares.1
    );
    if let Some(marker_mm) = marker_mm {
        command += &format!(" --marker-mm {marker_mm}");
    }
    if let Some(dictionary) = dictionary {
        command += &format!(" --dictionary {dictionary}");
    }
    let output = program()
        .current_dir(folder.path())
        .args(command.split(' '))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let text = std::fs::read_to_string(folder.path().join("b.toml")).unwrap();
    let request = BoardRequest {
        kind,
        squares,
        square_mm,
        marker_mm,
        dictionary: dictionary.map(str::to_owned),
        media: Media::new(Paper::A4),
    };
    let mut pages = render(&folder.path().join("b.pdf"), 300, A4);
    assert_eq!(pages.len(), 1);
    Printed {
        page: pages.remove(0),
        area: board(&request).unwrap().area,
        definition: toml::from_str(&text).unwrap(),
    }
}

/// OpenCV's markers on a page: id and corners in mm.
fn markers(printed: &Printed, dictionary: i32, border_bits: i32) -> Vec<(i32, [Mm; 4])> {
    let found = theirs::markers(&printed.picture(), dictionary, border_bits);
    let on_page = |(id, corners): theirs::Found| (id, corners.map(|px| printed.page.mm(px)));
    let mut found: Vec<_> = found.into_iter().map(on_page).collect();
    found.sort_by_key(|(id, _)| *id);
    found
}

/// Holds the markers found against their upper left corners and size, in the order of their ids; `first` is OpenCV's name for
/// the printed marker's upper left corner.
fn assert_markers(
    printed: &Printed,
    found: &[(i32, [Mm; 4])],
    upper_left: &[(f64, f64)],
    size_mm: f64,
    first: usize,
) -> f64 {
    let ids: Vec<_> = found.iter().map(|(id, _)| *id).collect();
    assert_eq!(
        ids,
        (0..upper_left.len() as i32).collect::<Vec<_>>(),
        "every marker once"
    );
    let mut worst = 0.0_f64;
    for ((id, corners), (x, y)) in found.iter().zip(upper_left) {
        for (i, (right, down)) in [(0.0, 0.0), (size_mm, 0.0), (size_mm, size_mm), (0.0, size_mm)]
            .iter()
            .enumerate()
        {
            let error = distance(corners[(first + i) % 4], printed.at(x + right, y + down));
            assert!(error < 0.1, "corner {i} of marker {id} is {error:.3} mm off");
            worst = worst.max(error);
        }
        for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
            let error = (distance(corners[a], corners[b]) - size_mm).abs();
            assert!(error < 0.1, "a side of marker {id} is {error:.3} mm off");
        }
    }
    worst
}

/// Both at the middle of every tenth of a square.
fn assert_equals_opencvs_drawing(printed: &Printed, board: Charuco) {
    const PX: i32 = 120;
    let Charuco { squares, square_mm, .. } = board;
    let size = Size::new(squares.0 as i32 * PX, squares.1 as i32 * PX);
    let drawing = theirs::drawing(board, size);
    let (mut compared, mut apart) = (0, 0);
    for row in 0..squares.1 * 40 {
        for column in 0..squares.0 * 40 {
            let share = |i: u32| (f64::from(i) + 0.5) / 40.0;
            let px = |i: u32| (share(i) * f64::from(PX)) as i32;
            let [x, y] = [share(column), share(row)].map(|share| share * square_mm);
            let theirs = *drawing.at_2d::<u8>(px(row), px(column)).unwrap() < 128;
            // A sample nearer than OpenCV's rounding to whole pixels to an edge may differ; elsewhere none may.
            let near = |dx: f64, dy: f64| printed.page.is_black(printed.at(x + dx, y + dy));
            let round = [
                near(0.0, 0.0),
                near(0.25, 0.25),
                near(-0.25, -0.25),
                near(0.25, -0.25),
                near(-0.25, 0.25),
            ];
            if round.iter().all(|black| *black == round[0]) {
                compared += 1;
                apart += u32::from(round[0] != theirs);
            }
        }
    }
    assert_eq!(apart, 0, "of {compared} places");
    assert!(
        f64::from(compared) > 0.6 * f64::from(squares.0 * squares.1 * 1600),
        "{compared} places compared"
    );
}

fn assert_charuco(squares: (u32, u32), square_mm: f64, marker_mm: f64, name: &str, dictionary: i32) {
    let printed = print(
        "charuco",
        BoardKind::Charuco,
        squares,
        square_mm,
        Some(marker_mm),
        Some(name),
    );
    let board = Charuco {
        squares,
        square_mm,
        marker_mm,
        dictionary,
    };
    assert_equals_opencvs_drawing(&printed, board);
    let Definition::Charuco {
        squares: [x, y],
        dictionary: told,
        legacy_layout,
        ..
    } = &printed.definition
    else {
        panic!("not a ChArUco definition: {:?}", printed.definition)
    };
    assert_eq!(((*x, *y), told.as_str(), *legacy_layout), (squares, name, false));
    let white = (0..squares.1).flat_map(|row| (0..squares.0).map(move |column| (row, column)));
    let inset = (square_mm - marker_mm) / 2.0;
    let upper_left: Vec<_> = white
        .filter(|(row, column)| (row + column) % 2 == 1)
        .map(|(row, column)| {
            (
                f64::from(column) * square_mm + inset,
                f64::from(row) * square_mm + inset,
            )
        })
        .collect();
    let found = markers(&printed, dictionary, 1);
    let worst = assert_markers(&printed, &found, &upper_left, marker_mm, 0);
    let corners = theirs::corners(board, &printed.picture());
    assert_eq!(
        corners.len() as u32,
        (squares.0 - 1) * (squares.1 - 1),
        "every inner corner"
    );
    let mut worst_corner = 0.0_f64;
    for (id, px) in corners {
        let place = printed.page.mm(px);
        // Row by row from the top left.
        let (row, column) = (id / (squares.0 - 1) + 1, id % (squares.0 - 1) + 1);
        let error = distance(
            place,
            printed.at(f64::from(column) * square_mm, f64::from(row) * square_mm),
        );
        assert!(error < 0.1, "corner {id} is {error:.3} mm off");
        worst_corner = worst_corner.max(error);
    }
    println!(
        "ChArUco {squares:?}: {} markers within {worst:.3} mm, corners within {worst_corner:.3} mm",
        found.len()
    );
}

#[test]
fn charuco_boards_are_opencvs() {
    assert_charuco((9, 7), 22.0, 16.0, "DICT_5X5_100", DICT_5X5_100);
    // An even number of rows is where layouts before OpenCV 4.6 differ.
    assert_charuco((6, 8), 25.0, 18.5, "DICT_6X6_250", DICT_6X6_250);
}

#[test]
fn chessboards_are_found_and_measure_what_they_say() {
    let printed = print("chessboard", BoardKind::Chessboard, (9, 6), 20.5, None, None);
    let Definition::Chessboard {
        inner_corners: [across, down],
        square_mm,
        ..
    } = printed.definition
    else {
        panic!("not a chessboard definition: {:?}", printed.definition)
    };
    assert_eq!((across, down, square_mm), (8, 5, 20.5));
    let (picture, size) = (printed.picture(), Size::new(across as i32, down as i32));
    let mut corners = Vector::<Point2f>::new();
    assert!(opencv::calib3d::find_chessboard_corners_def(&picture, size, &mut corners).unwrap());
    let stop = TermCriteria::new(3, 50, 0.001).unwrap();
    opencv::imgproc::corner_sub_pix(&picture, &mut corners, Size::new(9, 9), Size::new(-1, -1), stop).unwrap();
    let mut worst = 0.0_f64;
    for row in 1..=down {
        for column in 1..=across {
            let told = printed.at(f64::from(column) * square_mm, f64::from(row) * square_mm);
            let seen = corners
                .iter()
                .map(|p| distance(told, printed.page.mm([f64::from(p.x), f64::from(p.y)])));
            worst = worst.max(seen.fold(f64::INFINITY, f64::min));
        }
    }
    assert!(worst < 0.1, "{worst} mm");
    assert!(
        printed.page.is_black(printed.at(1.0, 1.0)),
        "the top left square is black"
    );
    println!("chessboard: {} corners within {worst:.3} mm", corners.len());
}

#[test]
fn aprilgrids_are_kalibrs() {
    let (columns, rows, pitch) = (6, 5, 26.0);
    let printed = print("aprilgrid", BoardKind::Aprilgrid, (columns, rows), pitch, None, None);
    let Definition::Aprilgrid {
        tag_mm,
        tag_spacing,
        border_modules,
        ..
    } = printed.definition
    else {
        panic!("not an AprilGrid definition: {:?}", printed.definition)
    };
    assert_eq!((tag_mm, tag_spacing, border_modules), (20.0, 0.3, 2));
    let gap = tag_mm * tag_spacing;
    let from_bottom_left = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let upper_left: Vec<_> = from_bottom_left
        .map(|(row, column)| (gap + f64::from(column) * pitch, gap + f64::from(rows - 1 - row) * pitch))
        .collect();
    // OpenCV's images of this family are turned by 180°: its first corner is the printed tag's lower right.
    let found = markers(&printed, DICT_APRILTAG_36H11, 2);
    let worst = assert_markers(&printed, &found, &upper_left, tag_mm, 2);
    for row in 0..=rows {
        for column in 0..=columns {
            let middle = |n: u32| gap / 2.0 + f64::from(n) * pitch;
            assert!(
                printed.page.is_black(printed.at(middle(column), middle(row))),
                "no square at a crossing"
            );
        }
    }
    assert!(
        !printed.page.is_black(printed.at(gap / 2.0, gap + tag_mm / 2.0)),
        "white between tags"
    );
    println!("AprilGrid: {} tags within {worst:.3} mm", found.len());
}

const REFUSALS: &[(&str, &str)] = &[
    (
        "--type chessboard --squares 9x7 --square-mm 22 --definition /dev/null/b.toml",
        "cannot write /dev/null/b.toml",
    ),
    ("--type charuco --squares 0x7 --square-mm 22", "a board of 0×7 squares"),
    ("--type charuco --squares 2x2 --square-mm 22", "give 3 to 100"),
    ("--type charuco --squares 9 --square-mm 22", "as in 9x7"),
    ("--type charuco --squares 9x7 --square-mm 0", "square cannot be 0"),
    ("--type charuco --squares 9x7 --square-mm nan", "square cannot be NaN"),
    (
        "--type charuco --squares 9x7 --square-mm 22 --marker-mm 22",
        "does not fit",
    ),
    (
        "--type charuco --squares 9x7 --square-mm 22 --marker-mm -1",
        "marker cannot be -1",
    ),
    (
        "--type charuco --squares 9x7 --square-mm 22 --dictionary DICT_9X9",
        "is not known",
    ),
    (
        "--type charuco --squares 20x20 --square-mm 9",
        "needs 200 markers and DICT_5X5_100 has 100",
    ),
    ("--type charuco --squares 9x7 --square-mm 1.5", "modules of 0.161 mm"),
    (
        "--type charuco --squares 9x7 --square-mm 40",
        "the board is 360 × 280 mm",
    ),
    ("--type charuco --squares 9x7 --square-mm 22 --paper 90x90", "too small"),
    (
        "--type chessboard --squares 9x7 --square-mm 22 --marker-mm 16",
        "--marker-mm means nothing on a chessboard",
    ),
    (
        "--type aprilgrid --squares 6x6 --square-mm 20 --dictionary DICT_5X5_100",
        "which is made of tag36h11",
    ),
    ("--type aprilgrid --squares 30x30 --square-mm 5", "needs 900 markers"),
    ("--type circles --squares 9x7 --square-mm 22", "invalid value"),
    (
        "--type chessboard --squares 9x7 --square-mm 22 --definition b.pdf",
        "give them different names",
    ),
];

#[test]
fn impossible_boards_are_refused_in_one_sentence_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    for (request, word) in REFUSALS {
        let command = format!("print board -o b.pdf {request}");
        let output = program()
            .current_dir(folder.path())
            .args(command.split(' '))
            .output()
            .unwrap();
        println!("{}", stderr(&output).trim_end());
        assert_refused(&output, &[word]);
        assert_eq!(files_in(folder.path()), 0, "{request} left a file");
    }
}

fn files_in(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}
