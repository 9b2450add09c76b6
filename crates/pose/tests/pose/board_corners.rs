//! Where the corners of boards lie.

use scaleproof_pose::board::Definition;

/// OpenCV 5's `CharucoBoard` with `setLegacyPattern`: upper left corners of its first four markers, `getObjPoints()`, x in mm.
#[test]
fn markers_of_the_layout_before_opencv_4_6_are_where_opencv_has_them() {
    let [current, shifted] = [
        [[25.0, 3.0], [69.0, 3.0], [3.0, 25.0]],
        [[3.0, 3.0], [47.0, 3.0], [91.0, 3.0]],
    ];
    for (squares, legacy_layout, first) in [
        ([5, 4], false, current),
        ([5, 4], true, shifted),
        ([4, 5], false, current),
        ([4, 5], true, current),
    ] {
        let board = Definition::Charuco {
            squares,
            square_mm: 22.0,
            marker_mm: 16.0,
            dictionary: "DICT_5X5_100".into(),
            legacy_layout,
        };
        let found: Vec<[f64; 2]> = board.markers().iter().take(3).map(|m| m.corners_mm[0]).collect();
        assert_eq!(found, first, "{squares:?} {legacy_layout}");
        assert_eq!(board.markers().len(), 10);
    }
}

#[test]
fn corners_and_markers_lie_where_they_are_printed() {
    let charuco = Definition::Charuco {
        squares: [9, 7],
        square_mm: 22.0,
        marker_mm: 16.0,
        dictionary: "DICT_5X5_100".into(),
        legacy_layout: false,
    };
    assert_eq!(charuco.corners_mm().len(), 48);
    assert_eq!(
        charuco.corners_mm()[8],
        [22.0, 44.0],
        "the second row starts with corner 8"
    );
    assert_eq!(charuco.markers().len(), 31);
    // The upper left square is black, so marker 0 stands in the second.
    assert_eq!(charuco.markers()[0].corners_mm[2], [41.0, 19.0]);
    let grid = Definition::Aprilgrid {
        tags: [6, 5],
        tag_mm: 20.0,
        tag_spacing: 0.3,
        family: "tag36h11".into(),
        border_modules: 2,
    };
    assert_eq!(grid.corners_mm().len(), 120);
    let [x, y] = grid.corners_mm()[3];
    assert!(
        (x - 6.0).abs() < 1e-9 && (y - 130.0).abs() < 1e-9,
        "tag 0 is at the bottom left"
    );
}
