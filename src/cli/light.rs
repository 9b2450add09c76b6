//! In place of `full`, in a program without that feature: no further command.

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;

use super::advice::Advise;
use super::answer::Named;
use super::{CommandResult, Result};
use scaleproof_detect::{Manifest, WeightFolders};

#[derive(Subcommand)]
pub(super) enum Command {}

pub(super) type OnModelCommand = Command;
pub(super) type PrintCommand = Command;
pub(super) type SessionCommand = Command;
pub(super) type DetectorsCommand = Command;

/// No mesh is read here.
#[derive(clap::Args)]
pub(super) struct SceneMesh {}

impl SceneMesh {
    pub(super) fn is_given(&self) -> bool {
        false
    }

    pub(super) fn take(&self, _: super::taken::Wanted) -> Result<super::taken::Taken> {
        Err("give --model-size-mm".into())
    }
}

pub(super) const ADVICE: &[Advise] = &[];

pub(super) fn run(command: Command, _: &mut dyn Write) -> CommandResult {
    match command {}
}

pub(super) use run as print;
pub(super) use run as print_on_model;
pub(super) use run as detectors;
pub(super) use run as session;

pub(super) fn download(manifest: &Manifest, _: &WeightFolders) -> Result<PathBuf> {
    let name = &manifest.name;
    Err(format!("the weights of {name} are not here; `./run detectors fetch` gets them").into())
}

pub(super) fn schemas() -> Vec<Named> {
    Vec::new()
}

pub(super) fn let_an_interruption_end_first() {}

/// Without a runtime that hears of Ctrl-C, programs hear of it themselves.
pub(super) fn end_programs_first() {
    scaleproof_detect::keep_programs_in_our_group();
}
