//! Tests of `cli/mistakes.rs`.

use super::*;

fn said(line: &str) -> String {
    let mut whole = crate::cli::command();
    let arguments: Vec<OsString> = line.split(' ').map(OsString::from).collect();
    let e = whole.try_get_matches_from_mut(&arguments).unwrap_err();
    sentence(&e, &whole, &arguments)
}

#[test]
fn the_sentence_names_the_command_and_what_was_meant() {
    for (line, sentence) in [
        (
            "scaleproof print check --ouput x.pdf",
            "'scaleproof print check' has no option '--ouput': did you mean '--output'? (see scaleproof print check --help)",
        ),
        (
            "scaleproof score s --recored -o x",
            "'scaleproof score' has no option '--recored': did you mean '--recorded' or '--record'? (see scaleproof score --help)",
        ),
        (
            "scaleproof scene new --scale 1:18 -o x",
            "invalid value '1:18' for '--scale <SCALE>': write 18 (see scaleproof scene new --help)",
        ),
        (
            "scaleproof -q scene new --bananas",
            "'scaleproof scene new' has no option '--bananas' (see scaleproof scene new --help)",
        ),
        (
            "scaleproof print check extra -o x.pdf",
            "'scaleproof print check' does not take 'extra' (see scaleproof print check --help)",
        ),
        (
            "scaleproof scor",
            "there is no command 'scaleproof scor': did you mean 'score'? (see scaleproof --help)",
        ),
        (
            "scaleproof print tempalte",
            "there is no command 'scaleproof print tempalte': did you mean 'template'? (see scaleproof print --help)",
        ),
        (
            "scaleproof bananas",
            "there is no command 'scaleproof bananas' (see scaleproof --help)",
        ),
        (
            "scaleproof print board --type charucco --squares 9x7 --square-mm 22 -o b.pdf",
            "invalid value 'charucco' for '--type <KIND>' [possible values: charuco, chessboard, aprilgrid]: did you mean 'charuco'? (see \
             scaleproof print board --help)",
        ),
        (
            "scaleproof print check",
            "the following required arguments were not provided: --output <FILE> (see scaleproof print check --help)",
        ),
    ] {
        assert_eq!(said(line), sentence);
    }
}
