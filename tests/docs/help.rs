//! The commands of the program and their options, as `--help` shows them: hidden spellings are not among them.

use std::collections::{BTreeMap, BTreeSet};

use crate::common;

/// Words of a command, as in `["print", "template"]`, with what its help says.
pub struct Commands(BTreeMap<Vec<String>, Command>);

#[derive(Default)]
struct Command {
    options: BTreeSet<String>,
    subcommands: Vec<String>,
}

impl Commands {
    pub fn of_program() -> Commands {
        let mut all = BTreeMap::new();
        let mut open = vec![Vec::new()];
        while let Some(path) = open.pop() {
            let command = asked(&path);
            let inner = command
                .subcommands
                .iter()
                .map(|name| [&path[..], &[name.clone()]].concat());
            open.extend(inner);
            all.insert(path, command);
        }
        Commands(all)
    }

    /// Commands that do something themselves, as in `print template`.
    pub fn leaves(&self) -> Vec<String> {
        let leaves = self.0.iter().filter(|(_, command)| command.subcommands.is_empty());
        leaves.map(|(path, _)| path.join(" ")).collect()
    }

    /// Whether words are a command or a group of them.
    pub fn is_command(&self, path: &[String]) -> bool {
        self.0.contains_key(path)
    }

    /// Every option of any command, hidden ones left out.
    pub fn options(&self) -> BTreeSet<&str> {
        self.0
            .values()
            .flat_map(|c| c.options.iter().map(String::as_str))
            .collect()
    }

    /// What the program would not understand in these words, which follow its name.
    pub fn fault(&self, words: &[String]) -> Option<String> {
        let mut path: Vec<String> = Vec::new();
        let mut command = &self.0[&path];
        // Behind an option stands its value.
        let mut has_option = false;
        for word in words {
            if let Some(option) = option_of(word) {
                has_option = true;
                if !command.options.contains(option) {
                    return Some(format!("`{}` has no option {option}", path.join(" ")));
                }
            } else if command.subcommands.contains(word) {
                path.push(word.clone());
                command = &self.0[&path];
            } else if !command.subcommands.is_empty() && !has_option && is_word(word) {
                return Some(format!("`{}` has no subcommand {word}", path.join(" ")));
            }
        }
        None
    }
}

/// `--name` of `--name=value`, or `-n`; numbers and a lone dash are values.
fn option_of(word: &str) -> Option<&str> {
    let name = word.split('=').next().unwrap_or(word);
    let first = name.trim_start_matches('-').chars().next()?;
    (name.starts_with('-') && first.is_ascii_alphabetic()).then_some(name)
}

/// What could be the name of a command, and is no `…`, `X` or `SUBCOMMAND`.
fn is_word(word: &str) -> bool {
    !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c == '-')
}

fn asked(path: &[String]) -> Command {
    let output = common::program().args(path).arg("--help").output().unwrap();
    assert!(output.status.success(), "{path:?}: {}", common::stderr(&output));
    let mut command = Command::default();
    let mut part = String::new();
    for line in common::stdout(&output).lines() {
        if !line.starts_with(' ') && line.ends_with(':') {
            part = line.to_owned();
        } else if part == "Commands:" {
            // The name stands at two blanks; further lines of its text stand deeper.
            let name = line.strip_prefix("  ").filter(|l| !l.starts_with(' '));
            let name = name.and_then(|l| l.split_whitespace().next());
            command
                .subcommands
                .extend(name.filter(|name| *name != "help").map(str::to_owned));
        } else if line.trim_start().starts_with('-') {
            let words = line.split_whitespace().take_while(|word| word.starts_with('-'));
            command
                .options
                .extend(words.map(|word| word.trim_end_matches([',', '.']).to_owned()));
        }
    }
    command
}
