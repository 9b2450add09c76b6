//! Tests of `cli/full/board.rs`.

use super::*;

#[test]
fn squares_in_another_unit_are_noticed_and_usual_ones_are_not() {
    for (squares, square) in [((9, 7), 22.0), ((10, 7), 20.0), ((6, 5), 26.0), ((5, 4), 10.0)] {
        assert_eq!(doubt(squares, square), None);
    }
    let said = doubt((9, 7), 2.2).unwrap_or_default();
    assert_eq!(
        said,
        "the board is 19.8 × 15.4 mm: were the squares in cm? That is --square-mm 22"
    );
}
