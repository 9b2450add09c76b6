//! Tests of `cli/overview.rs`.

use std::collections::BTreeSet;

use super::*;

#[test]
fn every_command_stands_in_one_group() {
    let whole = crate::cli::command();
    let there: BTreeSet<&str> = whole
        .get_subcommands()
        .filter(|sub| !sub.is_hide_set())
        .map(Command::get_name)
        .collect();
    let commands = || paragraphs(GROUPS).flat_map(|(_, commands)| commands.lines().filter_map(command_and_purpose));
    let grouped: Vec<&str> = commands().map(|(name, _)| name).collect();
    assert_eq!(there, grouped.iter().copied().collect());
    assert_eq!(there.len(), grouped.len(), "one is there twice");
    assert!(commands().all(|(_, purpose)| purpose.len() <= 78));
}

#[test]
fn every_example_is_a_command_line_that_the_program_takes() {
    for (path, lines) in paragraphs(EXAMPLES) {
        for line in lines.lines().map(str::trim_start) {
            let words = line.split(" > ").next().unwrap().split(' ');
            assert!(line.starts_with(path), "{line}");
            if let Err(e) = crate::cli::command().try_get_matches_from(words) {
                let is_help = e.kind() == clap::error::ErrorKind::DisplayHelp;
                assert!(is_help, "{line}: {e}");
            }
        }
    }
}
