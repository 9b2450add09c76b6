//! Tests of `cli/output.rs`.

use super::*;

/// Commands that write no file, only into a folder that is their input, or only a file of another kind (`plan --seal`).
const WITHOUT: [&str; 17] = [
    "locate",
    "camera show",
    "session import",
    "capture list-cameras",
    "detectors list",
    "detectors fetch",
    "detectors check",
    "detectors validate",
    "detectors register",
    "detectors remove",
    "session new",
    "session show",
    "scene show",
    "attack check",
    "attack judge",
    "plan",
    "completions",
];

/// The commands that do something, by their path, as in `print check`.
fn leaves<'a>(command: &'a Command, path: &str, found: &mut Vec<(String, &'a Command)>) {
    if !command.has_subcommands() {
        found.push((path.to_owned(), command));
    }
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        leaves(sub, format!("{path} {}", sub.get_name()).trim_start(), found);
    }
}

fn whole() -> Command {
    let mut whole = crate::cli::command();
    whole.build();
    whole
}

#[test]
fn every_command_with_an_output_takes_it_as_output_and_o() {
    let (whole, mut all) = (whole(), Vec::new());
    leaves(&whole, "", &mut all);
    let mut wrong = Vec::new();
    for (path, command) in &all {
        let output = command
            .get_arguments()
            .find(|argument| argument.get_long() == Some("output"));
        let named = output.map(|output| (output.get_id().as_str(), output.get_short()));
        match (WITHOUT.contains(&path.as_str()), named) {
            (true, None) | (false, Some(("output", Some('o')))) => {}
            (_, named) => wrong.push(format!("{path}: {named:?}")),
        }
        for argument in command.get_arguments() {
            let names = argument
                .get_long()
                .into_iter()
                .chain(argument.get_visible_aliases().unwrap_or_default());
            if names.into_iter().any(|name| name == "out") {
                wrong.push(format!("{path} shows --out"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let paths: Vec<&str> = all.iter().map(|(path, _)| path.as_str()).collect();
    assert!(WITHOUT.iter().all(|path| paths.contains(path)), "{paths:?}");
}

/// What a new command calls its output decides whether `-` is a file there.
#[test]
fn every_output_is_called_a_folder_or_a_kind_of_file() {
    let kinds = ["FILE", "PNG", "TOML", "YAML", "HTML", "SVG", "FILE.toml", "JSON"];
    let (whole, mut all, mut seen) = (whole(), Vec::new(), 0);
    leaves(&whole, "", &mut all);
    for (path, command) in all {
        for argument in command
            .get_arguments()
            .filter(|argument| OUTPUTS.contains(&argument.get_id().as_str()))
        {
            let kind = argument
                .get_value_names()
                .and_then(|names| names.first())
                .map_or("", |kind| kind.as_str());
            assert!(FOLDERS.contains(&kind) || kinds.contains(&kind), "{path} {argument}");
            seen += 1;
        }
    }
    assert!(seen > 25, "{seen}");
}
