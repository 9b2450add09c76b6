//! Arguments of `attack run`.

use std::path::PathBuf;

use clap::builder::StringValueParser;

use crate::cli::args::attack::on_frames::OnFrames;
use crate::cli::choice::{completing, one_of};
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::weights::Against;
use scaleproof_gradients::Boxes;
use scaleproof_photo::defence::Defence;

/// Make a pattern that detectors do not see a model in (DTA), from frames in flat colours
#[derive(clap::Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub on: OnFrames,
    /// Steps of Adam
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub steps: u32,
    /// Views a step
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub batch: u32,
    /// Step size of Adam, in sRGB of 0 to 1
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    pub rate: f64,
    /// Confidence below which the loss stops penalising a box: 0.5 is DTA's own loss, which stops at a miss; AP counts boxes down to 0.001
    #[arg(
        long,
        value_name = "CONFIDENCE",
        default_value_t = 0.0003,
        allow_negative_numbers = true
    )]
    pub floor: f64,
    /// Which boxes on the model count: the most confident one (DTA), all by the sum of their odds, or all weighted with their overlap
    #[arg(long, default_value = "strongest", value_parser = one_of(Boxes::ALL.map(|boxes| (boxes, boxes.name()))))]
    pub loss: Boxes,
    /// Of several detectors: what is made small, their mean loss or that of the one that still sees the model best
    #[arg(long, default_value = "mean", value_parser = one_of(Against::ALL.map(|against| (against, against.name()))))]
    pub against: Against,
    /// Share of a step's views that are drawn for how well the model is still seen in them
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, allow_negative_numbers = true)]
    pub hard: f64,
    /// What happens to images at random besides the usual (a little brightness, contrast, size, place and noise): several as in blur,shift, or one of the
    /// defences of `score --defence` as in median=3; `none` for nothing at all
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = completing(StringValueParser::new(), augmentations()))]
    pub augment: Vec<String>,
    /// Weight of the differences between neighbouring cells
    #[arg(long, value_name = "WEIGHT", default_value_t = 0.0, allow_negative_numbers = true)]
    pub smooth: f64,
    /// Optimise the pattern as this printer prints it: the file that `colour read` put the printer's colours in
    #[arg(long, value_name = "TOML", conflicts_with = "palette")]
    pub printer: Option<PathBuf>,
    /// Keep the pattern near this one: a PNG file of as many cells, or of a half, a third, …: a coarse pattern to be refined
    #[arg(long, value_name = "PNG", requires = "near_weight")]
    pub near: Option<PathBuf>,
    /// How strongly: the weight of the mean squared distance
    #[arg(long, value_name = "WEIGHT", requires = "near", allow_negative_numbers = true)]
    pub near_weight: Option<f64>,
    /// The pattern has the colours of this palette alone: a TOML file of [[paint]] tables
    #[arg(long, value_name = "TOML")]
    pub palette: Option<PathBuf>,
    /// The pattern has at most so many colours of its own choice, 2 to 24
    #[arg(long, value_name = "N", conflicts_with_all = ["palette", "printer"], allow_negative_numbers = true)]
    pub paints: Option<i64>,
    /// Darkest and lightest value of a cell, 8-bit sRGB
    #[arg(long, num_args = 2, value_names = ["DARKEST", "LIGHTEST"], default_values = ["0", "255"])]
    pub range: Vec<u8>,
}

/// Returns the names that `--augment` takes, without the amounts of defences.
fn augmentations() -> Vec<&'static str> {
    let kinds = Eot::KINDS.iter().map(|(name, _)| *name);
    let mut names: Vec<&str> = kinds.chain(["none"]).collect();
    // The kind `jpeg` is of any quality; the defence is written with its own.
    names.extend(Defence::NAMES.iter().filter(|name| **name != "jpeg"));
    names
}

/// Why something is no augmentation; `fault`: why it is no defence.
pub fn no_augmentation(asked: &str, fault: String) -> String {
    let name = asked.split('=').next().unwrap_or_default();
    if asked.starts_with("exec:") {
        return format!(
            "--augment {asked}: a program gives no derivative, so only the defences with a name can be attacked through: take one of {}",
            Defence::NAMES.join(", ")
        );
    }
    if Defence::NAMES.contains(&name) {
        return fault;
    }
    format!(
        "there is no augmentation “{asked}”: take some of {}",
        augmentations().join(", ")
    )
}
