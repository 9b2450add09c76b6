//! What standard error shows of texts from elsewhere.

use std::io::Write;

use super::*;

#[test]
fn notes_are_told_from_results_and_errors() {
    assert!(is_note("note: the camera is a guess") && is_note("note on a.jpg: tag 3 was left out"));
    for other in [
        "error: no such file",
        "not scored: a.jpg",
        "no pose for a.jpg",
        "notes.toml: 3 tags",
    ] {
        assert!(!is_note(other), "{other}");
    }
}

#[test]
fn what_moves_the_cursor_is_shown_and_json_stays_json() {
    let mut out = Vec::new();
    write!(Visible(&mut out), "a\x1b[2Jb\u{9b}c\u{202e}d\r\te\n").unwrap();
    let shown = String::from_utf8(out).unwrap();
    assert_eq!(shown, "a\\u001b[2Jb\\u009bc\\u202ed\\u000d\te\n");
    let mut out = Vec::new();
    let name = "x\u{9b}\u{7f}\x1b";
    writeln!(Visible(&mut out), "{}", serde_json::json!({ "name": name })).unwrap();
    let read: serde_json::Value = serde_json::from_slice(&out).unwrap();
    assert_eq!(read["name"], name);
}

#[test]
fn endless_words_are_cut_and_paths_are_not() {
    let path = format!("/data/{}", "x".repeat(4000));
    let text = format!("error: {path} is not there");
    assert_eq!(without_endless_words(&text), text);
    let number = "7".repeat(100_000);
    let sentence = without_endless_words(&format!(
        "error: n.cfg, line 3: [net] has width={number}: give a number"
    ));
    let beginning = format!("error: n.cfg, line 3: [net] has width={}", "7".repeat(54));
    assert!(sentence.starts_with(&beginning), "{sentence}");
    assert!(sentence.ends_with("7: (100007 letters) give a number"), "{sentence}");
    assert!(sentence.len() < 250);
}
