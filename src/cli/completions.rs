//! `scaleproof completions` and `scaleproof manuals`: what a shell and `man` need, from the same description as the help.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;

use super::{CommandResult, Outcome};
use scaleproof_core::files;

/// Print what lets a shell complete commands and options
#[derive(clap::Args)]
pub(super) struct Args {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Write a manual page for every command, for packages
#[derive(clap::Args)]
pub(super) struct ManualsArgs {
    /// Folder for the pages
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Runs `scaleproof completions`.
pub(super) fn run(args: &Args, out: &mut dyn Write) -> CommandResult {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut super::command(), "scaleproof", &mut script);
    out.write_all(&script)?;
    Ok(Outcome::Done)
}

/// Runs `scaleproof manuals`.
pub(super) fn run_manuals(args: &ManualsArgs, out: &mut dyn Write) -> CommandResult {
    let mut whole = super::command();
    whole.build();
    let mut pages = Vec::new();
    add_pages(&whole, &args.output, &mut pages)?;
    files::replace_all_atomically(&args.output, &pages)?;
    writeln!(out, "{}: {} manual pages", args.output.display(), pages.len())?;
    Ok(Outcome::Done)
}

/// `scaleproof-print-template.1` and so on, of the command and of those below it.
fn add_pages(command: &Command, folder: &Path, pages: &mut Vec<(PathBuf, Vec<u8>)>) -> std::io::Result<()> {
    let name = command
        .get_display_name()
        .unwrap_or_else(|| command.get_name())
        .to_owned();
    let mut page = Vec::new();
    let man = Man::new(command.clone()).title(name.to_uppercase());
    man.source(concat!("scaleproof ", env!("CARGO_PKG_VERSION")))
        .manual("scaleproof")
        .render(&mut page)?;
    pages.push((folder.join(format!("{name}.1")), page));
    let inner = command
        .get_subcommands()
        .filter(|sub| !sub.is_hide_set() && sub.get_name() != "help");
    for sub in inner {
        add_pages(sub, folder, pages)?;
    }
    Ok(())
}
