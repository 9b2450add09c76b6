//! `scaleproof session …`: sessions made of photos that are there already, and what is in one.

mod export;
mod import;
mod new;
mod show;

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use clap::Subcommand;

use super::{CommandResult, full};
use crate::cli::answer::{Named, named};
use scaleproof_core::spelling::{self, quoted};

#[derive(Subcommand)]
pub(super) enum Command {
    Export(export::Args),
    Import(import::Args),
    New(new::Args),
    Show(show::Args),
    #[command(flatten)]
    Full(full::SessionCommand),
}

/// Runs `scaleproof session …`.
pub(super) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Export(args) => export::run(args, out),
        Command::Import(args) => import::run(&args, out),
        Command::New(args) => new::run(args, out),
        Command::Show(args) => show::run(&args, out),
        Command::Full(command) => full::session(command, out),
    }
}

/// Returns the number of photos of each texture.
pub(super) fn by_variant<'a>(photos: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, usize> {
    let mut variants = BTreeMap::new();
    for variant in photos {
        *variants.entry(variant).or_default() += 1;
    }
    variants
}

/// The session that was made, and what to do with it.
pub(super) fn in_words(path: &Path, photos: usize, variants: &BTreeMap<&str, usize>, folder: &Path) -> String {
    let variants: Vec<_> = variants.iter().map(|(name, count)| format!("{name} {count}")).collect();
    format!(
        "{}: {} ({}); score {} with `scaleproof score {} -o REPORT`",
        path.display(),
        spelling::count(photos, "photo"),
        variants.join(", "),
        spelling::choose(photos, "it", "them"),
        quoted(&folder.display().to_string())
    )
}

pub(super) fn schemas() -> Vec<Named> {
    vec![
        named::<export::Exported>("session-export"),
        named::<import::ImportedSession>("session-import"),
        named::<new::Answer>("session-new"),
        named::<show::Page>("session-show"),
    ]
}
