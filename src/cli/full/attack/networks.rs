//! What the attack does with networks of its own (the feature `attack`). Without it, `no_networks.rs` stands here.

mod train_dtn;

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;

use super::WhiteBoxes;
use super::device::OnDevice;
use crate::cli::answer::{Named, named};
use crate::cli::detectors::{self, Folder};
use crate::cli::{CommandResult, Result};
use scaleproof_attack::baseline::{BlackBox, SearchConfig, camou};
use scaleproof_attack::run::Rgb;
use scaleproof_frames::surrogate::dtn::{DtnError, file};
use scaleproof_frames::surrogate::renderer::NeuralRenderer;
use scaleproof_gradients::device::DeviceKind;
use scaleproof_gradients::network::detector::OnnxDetector;
use scaleproof_pose::scene::Classes;

/// More of `scaleproof attack …`.
#[derive(Subcommand)]
pub(in crate::cli) enum Command {
    TrainDtn(train_dtn::TrainArgs),
}

pub(super) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    let Command::TrainDtn(args) = command;
    train_dtn::run(&args, out)
}

/// Networks that predict images of the model.
#[derive(clap::Args)]
pub(super) struct Trained {
    /// Trained networks to put beside them (attack train-dtn)
    #[arg(long, value_name = "FILE", num_args = 1..)]
    network: Vec<PathBuf>,
    #[command(flatten)]
    on: OnDevice,
}

impl Trained {
    pub(super) fn renderers(&self) -> Result<Vec<Box<dyn NeuralRenderer>>> {
        self.on.device.open()?;
        let open = |path: &PathBuf| {
            let network = file::load(path)?.network();
            Ok(Box::new(network) as Box<dyn NeuralRenderer>)
        };
        self.network.iter().map(open).collect()
    }
}

/// The detectors that are networks, and the name and hash of each.
pub(super) fn white_boxes(
    names: &[String],
    folder: &Folder,
    class: &Classes,
    device: DeviceKind,
) -> Result<WhiteBoxes> {
    device.open()?; // Its own sentence, before any detector is read.
    let folders = folder.folders()?;
    let (mut all, mut named): WhiteBoxes = Default::default();
    for manifest in detectors::chosen(names)? {
        let labels = manifest.counted(class.labels())?;
        let path = folders.checked(&manifest)?;
        named.push(format!("{} {:.12}", manifest.name, manifest.weights.sha256));
        all.push(Box::new(OnnxDetector::open(&manifest, &path, &labels, device)?));
    }
    Ok((all, named))
}

/// CAMOU's search: the images of its first round, and the cells it found.
pub(super) fn camou(device: DeviceKind, oracle: &mut BlackBox, config: &SearchConfig) -> Result<(u64, Vec<Rgb>)> {
    device.open()?;
    Ok((camou::FIRST_ROUND, camou::search(oracle, config)?))
}

pub(super) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        DtnError::Additive(error) => super::advice::advice(error)?,
        DtnError::NoViews { .. } => " (attack render --flat, --reference)",
        DtnError::Width { .. } => " (--width-px)",
        DtnError::NotFinite { .. } => " (--seed)",
    }
}

/// Libraries that panic on a damaged network are caught where they are called; nobody needs to read of it.
pub(in crate::cli) fn keep_refusals_quiet() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |about| {
        if !scaleproof_gradients::network::is_refusing() {
            usual(about);
        }
    }));
}

pub(super) fn schemas() -> Vec<Named> {
    vec![named::<train_dtn::TrainedNetwork>("attack-train-dtn")]
}
