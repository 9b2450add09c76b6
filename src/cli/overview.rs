//! The help of the whole program: its commands in the order of the work; and examples below the help of each.

use std::any::TypeId;
use std::fmt::Write;
use std::path::PathBuf;

use clap::builder::{StringValueParser, Styles};
use clap::{Arg, Command, ValueHint};
use scaleproof_core::geometry::length::parse_mm;
use scaleproof_detect::Manifest;

use super::choice::completing;

/// The commands in the order of the work, and what each is for.
const GROUPS: &str = include_str!("overview.txt");

const EXAMPLES: &str = include_str!("examples.txt");

/// The paragraphs of a text: each one's first line, and the others.
fn paragraphs(text: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    text.trim_end()
        .split("\n\n")
        .filter_map(|paragraph| paragraph.split_once('\n'))
}

/// A command of [`GROUPS`], and what it is for.
fn command_and_purpose(line: &str) -> Option<(&str, &str)> {
    let (command, purpose) = line.trim_start().split_once(' ')?;
    Some((command, purpose.trim_start()))
}

/// The command line with its commands grouped and with examples.
pub(super) fn explained(command: Command) -> Command {
    let template = format!(
        "{{before-help}}{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}{}\n{{options}}{{after-help}}",
        groups(&command),
        heading("Options")
    );
    with_examples(command, "").help_template(template)
}

fn heading(text: &str) -> String {
    let style = Styles::styled().get_header().to_owned();
    format!("{style}{text}:{style:#}")
}

fn groups(whole: &Command) -> String {
    let style = Styles::styled().get_literal().to_owned();
    let mut text = String::new();
    for (name, commands) in paragraphs(GROUPS) {
        let _ = writeln!(text, "{}", heading(name));
        // Builds without the feature `full` have fewer.
        let commands = commands.lines().filter_map(command_and_purpose);
        for (command, purpose) in commands.filter(|(name, _)| whole.find_subcommand(name).is_some()) {
            let _ = writeln!(text, "  {style}{command:<12}{style:#}{purpose}");
        }
        text.push('\n');
    }
    text
}

fn with_examples(command: Command, path: &str) -> Command {
    let inner: Vec<String> = command.get_subcommands().map(|sub| sub.get_name().to_owned()).collect();
    let command = inner.into_iter().fold(command, |command, name| {
        let path = format!("{path} {name}");
        command.mut_subcommand(name, |sub| with_examples(sub, path.trim_start()))
    });
    let whole = format!("scaleproof {path}");
    let command = command.mut_args(in_any_unit).mut_args(without_files);
    match paragraphs(EXAMPLES).find(|(of, _)| *of == whole.trim_end()) {
        Some((_, lines)) => command.after_help(format!("{}\n{lines}", heading("Examples"))),
        None => command,
    }
}

/// An option for a length in mm takes other units, too.
fn in_any_unit(argument: Arg) -> Arg {
    let is_length = argument.get_long().is_some_and(|name| name.ends_with("-mm"));
    if is_length && argument.get_value_parser().type_id() == TypeId::of::<f64>() {
        argument.value_parser(parse_mm)
    } else {
        argument
    }
}

/// Shells complete names of files only where a file is meant.
fn without_files(argument: Arg) -> Arg {
    const FILES: [&str; 17] = [
        "FILE", "DIR", "PNG", "SVG", "PDF", "HTML", "TOML", "JSON", "YAML", "ONNX", "IMAGE", "MESH", "SESSION",
        "SOURCE", "NPZ", "OBJ", "PATCH",
    ];
    let names = argument.get_value_names().unwrap_or_default();
    let means_file = names.iter().any(|name| FILES.iter().any(|file| name.contains(file)));
    if argument.get_long() == Some("detector") {
        let names = completing(StringValueParser::new(), Manifest::names());
        return argument.value_parser(names).hide_possible_values(true);
    }
    let is_path = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
    if is_path || means_file || argument.get_value_hint() != ValueHint::Unknown {
        argument
    } else {
        argument.value_hint(ValueHint::Other)
    }
}

#[cfg(test)]
#[path = "tests/overview.rs"]
mod tests;
