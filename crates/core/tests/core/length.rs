//! Lengths that users give.

use scaleproof_core::geometry::length::{
    is_size, number, parse_mm, parse_sides_mm, place_mm, shown, size_mm, strip_mm,
};

#[test]
fn what_is_no_length_is_refused_in_one_short_sentence() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200, -1e200, 100_000.1] {
        for check in [size_mm, strip_mm, place_mm] {
            let sentence = check("margin", value).unwrap_err().to_string();
            assert!(sentence.starts_with("margin cannot be "), "{sentence}");
            assert!(sentence.ends_with(" to 100000 mm"), "{sentence}");
            assert!(sentence.len() < 80, "{sentence}");
        }
    }
    let sentence = |value| size_mm("square", value).unwrap_err().to_string();
    assert_eq!(sentence(1e200), "square cannot be 1e200 mm; give 0.001 to 100000 mm");
    assert_eq!(sentence(0.0), "square cannot be 0 mm; give 0.001 to 100000 mm");
}

#[test]
fn sizes_are_there_strips_may_be_missing_and_places_have_two_sides() {
    assert!(
        [0.0, -0.0, -1.0, 1e-300]
            .iter()
            .all(|mm| size_mm("", *mm).is_err() && !is_size(*mm))
    );
    assert!(
        [0.001, 455.0, 1e5]
            .iter()
            .all(|mm| size_mm("", *mm) == Ok(*mm) && is_size(*mm))
    );
    assert!(strip_mm("", -0.5).is_err() && strip_mm("", 1e-300).is_ok());
    assert_eq!(place_mm("", -1e5), Ok(-1e5));
    assert!(
        strip_mm("", -0.0).is_ok_and(f64::is_sign_positive),
        "no minus before a zero"
    );
}

#[test]
fn numbers_are_plain_where_that_is_short() {
    let plain = [0.0, -118.0, 0.01, 1e6, f64::NAN].map(shown);
    assert_eq!(plain, ["0", "-118", "0.01", "1000000", "NaN"]);
    assert_eq!([1e200, -1e-300].map(shown), ["1e200", "-1e-300"]);
    assert_eq!([118.0, 7.375, 0.1 + 0.2].map(number), ["118", "7.375", "0.3"]);
}

#[test]
fn a_length_may_have_a_unit() {
    for (text, mm) in [
        ("455", 455.0),
        (" 455 mm ", 455.0),
        ("45.5cm", 455.0),
        ("0.455m", 455.0),
        ("10in", 254.0),
        ("1e1 inches", 254.0),
        ("10\"", 254.0),
        ("2ft", 609.6),
        ("-1in", -25.4),
    ] {
        assert!((parse_mm(text).unwrap() - mm).abs() < 1e-9, "{text}");
    }
    for text in ["", "in", "5 furlong", "5in5", "five"] {
        assert!(parse_mm(text).is_err(), "{text}");
    }
    assert_eq!(parse_sides_mm("200x1e2"), Some([200.0, 100.0]));
    assert_eq!(parse_sides_mm("1cmX2 \u{d7} 3"), Some([10.0, 2.0, 3.0]));
    assert_eq!(parse_sides_mm("1x2x3in"), Some([25.4, 50.8, 3.0 * 25.4]));
    for text in ["1x2", "1x2x3x4", "", "1xx3"] {
        assert_eq!(parse_sides_mm::<3>(text), None, "{text}");
    }
}
