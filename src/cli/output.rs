//! `-o -`: an output that goes to standard output.

use clap::{ArgMatches, CommandFactory};

use super::Cli;

/// Options that name an output.
const OUTPUTS: [&str; 4] = ["output", "out", "report", "definition"];

/// What the help calls an output that is a folder.
const FOLDERS: [&str; 2] = ["DIR", "SESSION"];

/// Whether the command that was given writes to standard output.
///
/// # Errors
/// A folder, or more than one file, cannot go there; a sentence.
pub(super) fn goes_to_standard_output(matches: &ArgMatches) -> Result<bool, String> {
    let mut whole = Cli::command();
    whole.build();
    let (mut command, mut matches) = (&whole, matches);
    while let Some((name, inner)) = matches.subcommand() {
        let Some(found) = command.find_subcommand(name) else {
            break;
        };
        (command, matches) = (found, inner);
    }
    let named = command.get_arguments().filter(|argument| {
        OUTPUTS.contains(&argument.get_id().as_str()) && is_standard_output(matches, argument.get_id().as_str())
    });
    let named: Vec<_> = named.collect();
    for argument in &named {
        let kind = argument.get_value_names().and_then(|names| names.first());
        if kind.is_some_and(|kind| FOLDERS.contains(&kind.as_str())) {
            let option = argument.get_long().unwrap_or("output");
            return Err(format!(
                "--{option} is a folder here, and standard output is none: name one"
            ));
        }
    }
    match named.len() {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err("only one file can go to standard output: name the other".into()),
    }
}

/// How standard output is named. What is said of a file must not get into it.
const STANDARD_OUTPUT: [&str; 2] = ["-", "/dev/stdout"];

fn is_standard_output(matches: &ArgMatches, id: &str) -> bool {
    let raw = matches.try_get_raw(id).ok().flatten();
    raw.is_some_and(|mut values| values.any(|value| STANDARD_OUTPUT.iter().any(|name| value == *name)))
}
