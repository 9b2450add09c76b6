//! Names and sizes of paper.

use scaleproof_print::paper::{Paper, Stock};

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
    let inches = |width: f64, height: f64| Paper::new(25.4 * width, 25.4 * height);
    let sizes = [
        ("legal", inches(8.5, 14.0)),
        ("Ledger", inches(11.0, 17.0)),
        ("a2", Paper::new(420.0, 594.0)),
        ("13x19in", inches(13.0, 19.0)),
        ("8.5in x 14 in", inches(8.5, 14.0)),
        ("8.5\"x11\"", inches(8.5, 11.0)),
        ("21x29.7cm", Paper::A4),
    ];
    for (text, paper) in sizes {
        let found: Paper = text.parse().unwrap();
        let off = (found.width_mm - paper.width_mm).hypot(found.height_mm - paper.height_mm);
        assert!(off < 1e-9, "{text}: {found:?}");
    }
    assert_eq!("roll24in".parse(), Ok(Stock::Roll { width_mm: 25.4 * 24.0 }));
    for nonsense in [
        "in", "5x", "5inx", "4x5x6", "a9", "", "210", "0x10", "nanx10", "-1x5", "9000x20",
    ] {
        assert!(nonsense.parse::<Paper>().is_err(), "{nonsense}");
    }
}
