//! `-o -`: an output that goes to standard output.

use std::path::{Path, PathBuf};

use clap::{Arg, ArgMatches, Command};

use scaleproof_core::files;

/// Options that name an output.
const OUTPUTS: [&str; 3] = ["output", "report", "definition"];

/// Value names in the help of outputs that are folders.
const FOLDERS: [&str; 2] = ["DIR", "SESSION"];

/// Endings of outputs that have one format, by their value name in the help. Commands that write several formats choose by the ending themselves.
const ENDINGS: [(&str, &[&str]); 3] = [("PNG", &["png"]), ("HTML", &["html", "htm"]), ("SVG", &["svg"])];

/// Returns true if the given command, one of `whole`, writes to standard output.
///
/// # Errors
/// A folder, or more than one file, cannot go there; an output is named as another format than it has; a sentence.
pub(super) fn goes_to_standard_output(whole: &Command, matches: &ArgMatches) -> Result<bool, String> {
    let (mut command, mut matches) = (whole, matches);
    while let Some((name, inner)) = matches.subcommand() {
        let Some(found) = command.find_subcommand(name) else {
            break;
        };
        (command, matches) = (found, inner);
    }
    command
        .get_arguments()
        .try_for_each(|argument| check_ending(argument, matches))?;
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

/// Refuses a name that promises another format than the output has.
fn check_ending(argument: &Arg, matches: &ArgMatches) -> Result<(), String> {
    let id = argument.get_id().as_str();
    let kind = argument.get_value_names().and_then(|names| names.first());
    let of_kind = |(known, _): &&(&str, _)| OUTPUTS.contains(&id) && kind.is_some_and(|kind| kind == known);
    let path = matches.try_get_one::<PathBuf>(id).ok().flatten();
    if let (Some((kind, endings)), Some(path)) = (ENDINGS.iter().find(of_kind), path)
        && let Some(ending) = path.extension()
        && !endings.iter().any(|known| ending.eq_ignore_ascii_case(known))
    {
        return Err(format!(
            "{} would hold {kind}: let its name end in .{}",
            path.display(),
            endings[0]
        ));
    }
    Ok(())
}

fn is_standard_output(matches: &ArgMatches, id: &str) -> bool {
    let raw = matches.try_get_raw(id).ok().flatten();
    raw.is_some_and(|mut values| values.any(|value| files::is_standard_output(Path::new(value))))
}

#[cfg(test)]
#[path = "tests/output.rs"]
mod tests;
