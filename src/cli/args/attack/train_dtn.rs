//! Arguments of `attack train-dtn`.

use std::path::PathBuf;

use crate::cli::choice::one_of;
use scaleproof_frames::surrogate::dtn::{Architecture, Encoder, LEAST_WIDTH_PX, Transformer};

/// Train DTN (or NTR) on frames in flat colours; a file that is there already is trained further
#[derive(clap::Args)]
pub struct TrainArgs {
    /// Folders of frames; with linear light in three flat colours a view, all colours are made of those
    #[arg(value_name = "FRAMES", required = true)]
    pub frames: Vec<PathBuf>,
    /// Frames to validate on; without, a place and every fourth azimuth are kept back
    #[arg(long, value_name = "FRAMES")]
    pub validation: Option<PathBuf>,
    #[arg(long, default_value = "resnet", value_parser = one_of(Encoder::ALL.map(|encoder| (encoder, encoder.name()))))]
    pub encoder: Encoder,
    /// k: how often the encoder halves the image
    #[arg(long, value_name = "K", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=Architecture::MAX_DEPTH as i64))]
    pub depth: u8,
    /// DTN's or, multiply-add, that of ACTIVE's NTR
    #[arg(long, default_value = "texture", value_parser = one_of(Transformer::ALL.map(|transformer| (transformer, transformer.name()))))]
    pub transformer: Transformer,
    /// Flat colours of the image it starts from, as hex; several: one of them at random
    #[arg(long, value_name = "HEX", num_args = 1..=16, default_values = ["808080"])]
    pub reference: Vec<String>,
    /// Reduce the frames to this width [default: the first folder's]
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(i64::from(LEAST_WIDTH_PX)..=4096))]
    pub width_px: Option<u32>,
    /// Times all training views, with those of earlier runs
    #[arg(long, value_name = "N", default_value_t = 25, conflicts_with = "seconds", value_parser = clap::value_parser!(u64).range(1..))]
    pub epochs: u64,
    /// Train for so long instead, with the time of earlier runs
    #[arg(long, value_name = "S")]
    pub seconds: Option<f64>,
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// The network, saved every half minute
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}
