//! `scaleproof session …`: sessions made of photos that are there already, and what is in one.

mod import;
mod new;
mod show;

use std::collections::BTreeMap;
use std::error::Error;
use std::io::Write;
use std::path::Path;

use clap::Subcommand;

use super::CommandResult;
use super::sessions::quoted;
use crate::session::import::SessionImportError;
use crate::session::{NewSessionError, PhotoEntry};
use crate::spelling;

/// Make a session of photos that are there already, or show what is in one.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Import(import::Args),
    New(new::Args),
    Show(show::Args),
}

/// What to do about an error of the library.
pub fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(SessionImportError::NoVariant { .. }) = error.downcast_ref() {
        return Some(", or give --variant for all".into());
    }
    match error.downcast_ref()? {
        NewSessionError::NotEmpty { .. } => Some("with --copy name a new folder".into()),
        _ => None,
    }
}

/// Runs `scaleproof session …`.
pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Import(args) => import::run(&args, out),
        What::New(args) => new::run(&args, out),
        What::Show(args) => show::run(&args, out),
    }
}

/// How many photos each texture has.
fn by_variant(photos: &[PhotoEntry]) -> BTreeMap<&str, usize> {
    let mut variants = BTreeMap::new();
    for photo in photos {
        *variants.entry(photo.variant.as_str()).or_default() += 1;
    }
    variants
}

/// The session that was made, and what to do with it.
fn in_words(path: &Path, photos: &[PhotoEntry], folder: &Path) -> String {
    let variants = by_variant(photos).into_iter();
    let variants: Vec<_> = variants.map(|(name, count)| format!("{name} {count}")).collect();
    format!(
        "{}: {} ({}); score {} with `scaleproof score {} -o REPORT`",
        path.display(),
        spelling::count(photos.len(), "photo"),
        variants.join(", "),
        spelling::choose(photos.len(), "it", "them"),
        quoted(&folder.display().to_string())
    )
}
