//! Mistakes in the arguments: one sentence that names the command, and the word that was probably meant.

use std::ffi::OsString;

use clap::Command;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use scaleproof_core::spelling;

/// Returns what was wrong with the arguments, without the usage that clap adds below.
pub(super) fn sentence(e: &clap::Error, whole: &Command, arguments: &[OsString]) -> String {
    let command = named(whole, arguments);
    let text = |kind| match e.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let mistake = match e.kind() {
        ErrorKind::UnknownArgument => text(ContextKind::InvalidArg).map(|given| {
            if given.starts_with('-') {
                format!("'{command}' has no option '{given}'")
            } else {
                format!("'{command}' does not take '{given}'")
            }
        }),
        ErrorKind::InvalidSubcommand => text(ContextKind::InvalidSubcommand).map(|given| {
            if left_out(&given) {
                format!("this build has no '{given}', only what the demo needs: `./run {given}` builds the rest")
            } else {
                format!("there is no command '{command} {given}'")
            }
        }),
        ErrorKind::ValueValidation if e.to_string().contains("invalid float literal") => {
            let (given, option) = (text(ContextKind::InvalidValue), text(ContextKind::InvalidArg));
            given.zip(option).map(|(given, option)| {
                format!(
                    "invalid value '{given}' for '{option}': {}",
                    number_instead(&given, &option)
                )
            })
        }
        _ => None,
    };
    let elsewhere = match e.kind() {
        ErrorKind::InvalidSubcommand => text(ContextKind::InvalidSubcommand).and_then(|given| inside(whole, &given)),
        _ => None,
    };
    let meant = elsewhere
        .or_else(|| option(e, whole, arguments))
        .or_else(|| suggestion(e, whole));
    let meant = meant.map_or_else(String::new, |meant| format!(": did you mean {meant}?"));
    let mistake = mistake.unwrap_or_else(|| first_paragraph(&e.to_string()));
    format!("{mistake}{meant} (see {command} --help)")
}

/// As far as the arguments name commands: `scaleproof print template`.
fn named(whole: &Command, arguments: &[OsString]) -> String {
    innermost(whole, arguments).1
}

/// The command that the arguments name, and its name with those around it.
fn innermost<'a>(whole: &'a Command, arguments: &[OsString]) -> (&'a Command, String) {
    let (mut command, mut path) = (whole, whole.get_name().to_owned());
    for argument in arguments.iter().skip(1).filter_map(|argument| argument.to_str()) {
        match command.find_subcommand(argument) {
            Some(inner) => {
                command = inner;
                path = format!("{path} {}", inner.get_name());
            }
            // An option of all commands may stand between them.
            None if argument.starts_with('-') => {}
            None => break,
        }
    }
    (command, path)
}

/// The option, or the two, that fewest letters make of one that is not there. Clap names one: of `--recored`, `--record` and not `--recorded`.
fn option(e: &clap::Error, whole: &Command, arguments: &[OsString]) -> Option<String> {
    let Some(ContextValue::String(given)) = e.get(ContextKind::InvalidArg) else {
        return None;
    };
    let given = given
        .strip_prefix("--")
        .filter(|_| e.kind() == ErrorKind::UnknownArgument)?;
    let command = innermost(whole, arguments).0;
    let known = command.get_arguments().filter(|known| !known.is_hide_set());
    let known = known.filter_map(clap::Arg::get_long);
    let edits: Vec<(usize, &str)> = known.map(|known| (spelling::edits(given, known), known)).collect();
    let least = edits
        .iter()
        .map(|(edits, _)| *edits)
        .min()
        .filter(|least| 3 * least <= given.len())?;
    let near = edits.iter().filter(|(edits, _)| *edits == least);
    let near: Vec<String> = near.map(|(_, name)| format!("'--{name}'")).collect();
    (near.len() <= 2).then(|| near.join(" or "))
}

/// Returns the advice on a number that cannot be read: the number that was meant where that is plain, else an example.
fn number_instead(given: &str, option: &str) -> String {
    let number = |text: &str| text.trim_end().parse::<f64>().ok();
    let degrees = given
        .strip_suffix('°')
        .or_else(|| given.strip_suffix("deg"))
        .and_then(number);
    match (
        given.strip_suffix('%').and_then(number),
        number(&given.replace(',', ".")),
        degrees,
    ) {
        (Some(percent), ..) => format!("write {} for {given}", percent / 100.0),
        (None, Some(meant), _) => format!("write {meant}, with a point"),
        (None, None, Some(degrees)) => format!("write {degrees}"),
        (None, None, None) if option.contains("--scale") && given.starts_with("1:") => format!("write {}", &given[2..]),
        (None, None, None) if option.contains("-mm") => "give a length, as in 118, 118mm, 11.8cm or 4.65in".to_owned(),
        (None, None, None) => "give a number, as in 0.5".to_owned(),
    }
}

/// A command of this very name inside others, as in `'attack evaluate'`.
fn inside(whole: &Command, name: &str) -> Option<String> {
    let has =
        |group: &&Command| group.find_subcommand(name).is_some_and(|inner| !inner.is_hide_set()) && name != "help";
    let found: Vec<String> = whole
        .get_subcommands()
        .filter(has)
        .map(|group| format!("'{} {name}'", group.get_name()))
        .collect();
    (!found.is_empty()).then(|| found.join(" or "))
}

/// The word that clap finds nearest, as in `'--output'`.
fn suggestion(e: &clap::Error, whole: &Command) -> Option<String> {
    let kinds = [
        ContextKind::SuggestedArg,
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedValue,
    ];
    let near = kinds.iter().find_map(|kind| e.get(*kind))?;
    match near {
        ContextValue::String(word) => Some(format!("'{word}'")),
        // The nearest is the last. A hidden command is not what was meant.
        ContextValue::Strings(words) => {
            let is_shown = |word: &&String| whole.find_subcommand(word).is_none_or(|command| !command.is_hide_set());
            words.iter().rev().find(is_shown).map(|word| format!("'{word}'"))
        }
        _ => None,
    }
}

fn first_paragraph(message: &str) -> String {
    let lines = message
        .lines()
        .take_while(|line| !line.trim().is_empty())
        .map(str::trim);
    let sentence = lines.collect::<Vec<_>>().join(" ");
    sentence.strip_prefix("error: ").unwrap_or(&sentence).to_owned()
}

/// Returns true if this build lacks a command that builds with the feature `full` have.
fn left_out(name: &str) -> bool {
    let full = ["attack", "calibrate", "capture", "chart", "survey"];
    !cfg!(feature = "full") && full.contains(&name)
}

#[cfg(test)]
#[path = "tests/mistakes.rs"]
mod tests;
