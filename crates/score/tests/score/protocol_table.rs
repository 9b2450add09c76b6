use scaleproof_score::figures::protocol_table::significant;

/// The physical test of ACTIVE's paper: hits of 240 photos, and the values it prints.
#[test]
fn active_s_printed_values_are_shares_of_240_photos() {
    for (hits, printed) in [
        (218, "90.8"),
        (21, "8.75"),
        (231, "96.3"),
        (97, "40.4"),
        (63, "26.3"),
        (228, "95.0"),
        (117, "48.8"),
    ] {
        assert_eq!(significant(100.0 * f64::from(hits) / 240.0), printed);
    }
}
