//! Names and sizes of paper.

use scaleproof_print::print::paper::{Paper, Stock};

#[test]
fn rolls_have_a_width() {
    assert_eq!("Roll610".parse(), Ok(Stock::Roll { width_mm: 610.0 }));
    assert_eq!("a4".parse(), Ok(Stock::Cut(Paper::A4)));
    for nonsense in ["roll", "roll0", "roll-3", "rollnan", "roll9000", "rolled"] {
        assert!(nonsense.parse::<Stock>().is_err(), "{nonsense}");
    }
}

#[test]
fn papers_have_names_or_sizes() {
    assert_eq!("A3".parse(), Ok(Paper::A3));
    assert_eq!(
        "610 x 914.5".parse(),
        Ok(Paper {
            width_mm: 610.0,
            height_mm: 914.5
        })
    );
    assert_eq!(
        Paper::A4.landscape(),
        Paper {
            width_mm: 297.0,
            height_mm: 210.0
        }
    );
    for nonsense in ["a9", "", "210", "0x10", "nanx10", "-1x5", "9000x20"] {
        assert!(nonsense.parse::<Paper>().is_err(), "{nonsense}");
    }
}
