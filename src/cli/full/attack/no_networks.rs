//! In place of `networks`, in a program without the feature `attack`: detectors that are programs serve all the same.

use std::error::Error;
use std::io::Write;

use clap::Subcommand;

use super::WhiteBoxes;
use crate::cli::answer::Named;
use crate::cli::detectors::Folder;
use crate::cli::{CommandResult, Result};
use scaleproof_attack::baseline::{BlackBox, SearchConfig};
use scaleproof_attack::run::Rgb;
use scaleproof_frames::surrogate::renderer::NeuralRenderer;
use scaleproof_gradients::device::DeviceKind;
use scaleproof_pose::scene::Classes;

#[derive(Subcommand)]
pub(in crate::cli) enum Command {}

pub(super) fn run(command: Command, _: &mut dyn Write) -> CommandResult {
    match command {}
}

/// None can be read.
#[derive(clap::Args)]
pub(super) struct Trained {}

impl Trained {
    pub(super) fn renderers(&self) -> Result<Vec<Box<dyn NeuralRenderer>>> {
        Ok(Vec::new())
    }
}

fn refused<T>() -> Result<T> {
    Err("this program was built without the attack's networks: use ./run attack …, or build with `cargo build --release --features attack`".into())
}

pub(super) fn white_boxes(_: &[String], _: &Folder, _: &Classes, _: DeviceKind) -> Result<WhiteBoxes> {
    refused()
}

pub(super) fn camou(_: DeviceKind, _: &mut BlackBox, _: &SearchConfig) -> Result<(u64, Vec<Rgb>)> {
    refused()
}

pub(super) fn advice(_: &(dyn Error + 'static)) -> Option<String> {
    None
}

pub(in crate::cli) fn keep_refusals_quiet() {}

pub(super) fn schemas() -> Vec<Named> {
    Vec::new()
}
