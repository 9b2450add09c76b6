//! Days as the user gives them.

use scaleproof_print::date::Date;

#[test]
fn only_real_days_are_dates() {
    for day in ["2026-11-21", "2024-02-29", "2000-02-29"] {
        assert_eq!(day.parse::<Date>().unwrap().to_string(), day);
    }
    for nonsense in [
        "2026-02-29",
        "1900-02-29",
        "2026-13-01",
        "2026-1-1",
        "21.11.2026",
        "",
        "2026-11-21-1",
        "+026-11-21",
    ] {
        assert!(nonsense.parse::<Date>().is_err(), "{nonsense}");
    }
}
