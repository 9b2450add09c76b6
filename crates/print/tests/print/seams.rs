//! Letters of the seams of a template.

use crate::layout::request;
use scaleproof_print::template::{layout, letters};

#[test]
fn both_sheets_of_a_seam_have_its_letter() {
    let made = layout(&request((600.0, 300.0))).unwrap();
    assert_eq!((made.rows, made.columns), (2, 3));
    let mut seen = std::collections::BTreeMap::<String, usize>::new();
    for sheet in &made.sheets {
        let seams = made.seams(sheet.row, sheet.column);
        assert_eq!(seams.left.is_none(), sheet.column == 0);
        if sheet.column > 0 {
            assert_eq!(seams.left, made.seams(sheet.row, sheet.column - 1).right);
        }
        if sheet.row > 0 {
            assert_eq!(seams.above, made.seams(sheet.row - 1, sheet.column).below);
        }
        for letter in [seams.left, seams.right, seams.above, seams.below]
            .into_iter()
            .flatten()
        {
            *seen.entry(letter).or_default() += 1;
        }
    }
    let expected = "ABCDEFG".chars().map(|c| (c.to_string(), 2));
    assert_eq!(seen, expected.collect());
}

#[test]
fn rows_have_letters() {
    let all: Vec<_> = [0, 1, 25, 26, 51, 52, 399].map(letters).into();
    assert_eq!(all, ["A", "B", "Z", "AA", "AZ", "BA", "OJ"]);
}
