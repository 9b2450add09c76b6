//! Names and numbers in words.

use scaleproof_core::spelling::{count, digits, edits, hint, nearest};

#[test]
fn one_thing_is_not_several() {
    assert_eq!(
        [0, 1, 2].map(|n| count(n, "photo")),
        ["0 photos", "1 photo", "2 photos"]
    );
}

#[test]
fn a_five_is_rounded_away_from_zero() {
    assert_eq!(
        [0.125, 0.625, 0.375, -0.125, -0.0001].map(|v| digits(v, 2)),
        ["0.13", "0.63", "0.38", "-0.13", "0.00"]
    );
    assert_eq!(digits(8.75, 1), "8.8");
}

#[test]
fn edits_are_counted_as_by_hand() {
    let counted = [
        ("", ""),
        ("", "abc"),
        ("kitten", "sitting"),
        ("tabliod", "tabloid"),
        ("ä4", "a4"),
    ]
    .map(|(a, b)| edits(a, b));
    assert_eq!(counted, [0, 3, 3, 1, 1]);
}

#[test]
fn one_near_name_is_proposed_and_nothing_is_guessed() {
    const PAPERS: [&str; 4] = ["a4", "a3", "letter", "tabloid"];
    let meant = ["leter", "TABLIOD", "a44", "tab", "A4"].map(|text| nearest(text, PAPERS));
    assert_eq!(
        meant,
        [Some("letter"), Some("tabloid"), Some("a4"), Some("tabloid"), Some("a4")]
    );
    // A paper of its own; as near to both; nothing like any; nothing at all.
    for text in ["a5", "b4", "legal", ""] {
        assert_eq!(nearest(text, PAPERS), None, "{text}");
    }
    assert_eq!(hint("leter", PAPERS), "; did you mean letter?");
    assert_eq!(hint("legal", PAPERS), "");
}
