//! The commands of the program and their options, as `--help` shows them: hidden spellings are not among them.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use crate::common;

/// Words of a command, as in `["print", "template"]`, with what its help says.
pub struct Commands(BTreeMap<Vec<String>, Command>);

#[derive(Default)]
struct Command {
    options: BTreeSet<String>,
    subcommands: Vec<String>,
}

impl Commands {
    pub fn of_program() -> &'static Commands {
        static COMMANDS: OnceLock<Commands> = OnceLock::new();
        COMMANDS.get_or_init(Commands::asked)
    }

    fn asked() -> Commands {
        let mut all = BTreeMap::new();
        let mut open: Vec<_> = asked(&[]).map(|found| (Vec::new(), found)).into_iter().collect();
        while let Some((path, (mut command, names))) = open.pop() {
            for name in names {
                let inner = [&path[..], std::slice::from_ref(&name)].concat();
                // What the help lists need not be commands.
                if let Some(found) = asked(&inner) {
                    command.subcommands.push(name);
                    open.push((inner, found));
                }
            }
            all.insert(path, command);
        }
        assert!(all.len() > 40, "only {} commands were found in the help", all.len());
        Commands(all)
    }

    /// Commands that do something themselves, as in `print template`.
    pub fn leaves(&self) -> Vec<String> {
        let leaves = self.0.iter().filter(|(_, command)| command.subcommands.is_empty());
        leaves.map(|(path, _)| path.join(" ")).collect()
    }

    /// Commands with an option for where they write.
    pub fn writing(&self) -> BTreeSet<String> {
        let writes = |command: &Command| {
            ["-o", "--save", "--seal"]
                .iter()
                .any(|option| command.options.contains(*option))
        };
        let writing = self.0.iter().filter(|(_, command)| writes(command));
        writing.map(|(path, _)| path.join(" ")).collect()
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

/// The options in the help of a command, and the names that may be its subcommands. `None` for what is no command.
fn asked(path: &[String]) -> Option<(Command, BTreeSet<String>)> {
    let output = common::program().args(path).arg("--help").output().unwrap();
    let help = common::stdout(&output);
    let usage = format!("scaleproof {}", path.join(" "));
    let is_its_own = help
        .lines()
        .any(|line| line.contains("Usage: ") && line.contains(usage.trim_end()));
    if !output.status.success() || !is_its_own {
        return None;
    }
    let (mut command, mut names) = (Command::default(), BTreeSet::new());
    for line in help.lines() {
        let mut words = line.split_whitespace().peekable();
        match words.peek() {
            Some(first) if first.starts_with('-') => {
                // A value that may be left out stands behind the name: `--sequential[=<AFTER>]`.
                let name = |word: &str| {
                    word.split('[')
                        .next()
                        .unwrap_or_default()
                        .trim_end_matches([',', '.'])
                        .to_owned()
                };
                let own = words.take_while(|word| word.starts_with('-'));
                command.options.extend(own.map(name));
            }
            // A name stands at two blanks; further lines of its text stand deeper.
            Some(first) if line.starts_with("  ") && !line.starts_with("   ") && is_word(first) && *first != "help" => {
                names.insert((*first).to_owned());
            }
            _ => {}
        }
    }
    Some((command, names))
}
