//! `-o -`: an output that goes to standard output.

use std::path::Path;

use clap::{ArgMatches, Command};

use crate::files;

/// Options that name an output.
const OUTPUTS: [&str; 4] = ["output", "out", "report", "definition"];

/// What the help calls an output that is a folder.
const FOLDERS: [&str; 2] = ["DIR", "SESSION"];

/// Whether the command that was given, one of `whole`, writes to standard output.
///
/// # Errors
/// A folder, or more than one file, cannot go there; a sentence.
pub(super) fn goes_to_standard_output(whole: &Command, matches: &ArgMatches) -> Result<bool, String> {
    let (mut command, mut matches) = (whole, matches);
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
            return Err(format!("--{option} must be a folder, not standard output"));
        }
    }
    match named.len() {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err("only one file can go to standard output: name the other".into()),
    }
}

fn is_standard_output(matches: &ArgMatches, id: &str) -> bool {
    let raw = matches.try_get_raw(id).ok().flatten();
    raw.is_some_and(|mut values| values.any(|value| files::is_standard_output(Path::new(value))))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::cli::Cli;

    /// Commands and their options, as in `print check --output`.
    fn options(command: &Command, path: &str) -> Vec<String> {
        let own = command
            .get_arguments()
            .filter(|argument| OUTPUTS.contains(&argument.get_id().as_str()));
        let own = own.map(|argument| {
            let kind = argument.get_value_names().and_then(|names| names.first());
            format!(
                "{path} --{} {}",
                argument.get_long().unwrap_or_default(),
                kind.map_or("", |kind| kind.as_str())
            )
        });
        let inner = command.get_subcommands();
        let inner = inner.flat_map(|sub| options(sub, &format!("{path} {}", sub.get_name())));
        own.chain(inner).collect()
    }

    /// What a new command calls its output decides whether `-` is a file there.
    #[test]
    fn every_output_is_called_a_folder_or_a_kind_of_file() {
        let mut whole = Cli::command();
        whole.build();
        let all = options(&whole, "");
        let kinds = ["FILE", "PNG", "TOML", "YAML", "HTML", "FILE.toml", "JSON"];
        for option in &all {
            let kind = option.rsplit(' ').next().unwrap();
            assert!(FOLDERS.contains(&kind) || kinds.contains(&kind), "{option}");
        }
        assert!(all.len() > 25, "{all:?}");
    }
}
