//! Student's t against the printed table.

use scaleproof_core::statistics::students_t_95;

#[test]
fn the_printed_table() {
    for (freedom, t) in [
        (1.0, 12.706),
        (2.0, 4.303),
        (5.0, 2.571),
        (15.0, 2.131),
        (40.0, 2.021),
        (95.0, 1.985),
    ] {
        assert!((students_t_95(freedom) - t).abs() < 6e-4, "{freedom}");
    }
}
