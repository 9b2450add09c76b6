//! `scaleproof attack colours`: further flat colours of rendered views, without rendering.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::render::hexes;
use crate::cli::{CommandResult, Result};
use scaleproof_core::files;
use scaleproof_frames::surrogate::additive::recoloured;
use scaleproof_frames::{FrameSet, light};

/// Make further flat colours of rendered views, without rendering: light adds up
#[derive(clap::Args)]
pub(in crate::cli) struct ColoursArgs {
    /// Frames with linear light, in three flat colours or more per view
    #[arg(value_name = "FRAMES")]
    frames: PathBuf,
    /// Flat colours as hex sRGB, as in c83214
    #[arg(long, value_name = "HEX", num_args = 1..)]
    flat: Vec<String>,
    /// And so many random ones
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000))]
    random: u32,
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the new frames
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ColoursArgs, out: &mut dyn Write) -> CommandResult {
    let set = FrameSet::open(&args.frames)?;
    let list = super::new_list(&args.output)?;
    let colours = colours(args)?;
    let (new, frames) = recoloured(&set, &colours, &args.output)?;
    files::replace_all_atomically(&args.output, &new)?;
    super::say_frames(&list, frames, args.json, out)
}

fn colours(args: &ColoursArgs) -> Result<Vec<[u8; 3]>> {
    let mut colours = hexes(&args.flat)?;
    let mut seen = BTreeSet::new();
    if let Some(twice) = colours.iter().find(|rgb| !seen.insert(**rgb)) {
        return Err(format!("the colour {} is given twice; give each once", light::to_hex(*twice)).into());
    }
    let mut rng = Pcg32::seed_from_u64(args.seed);
    while colours.len() < args.flat.len() + args.random as usize {
        let rgb: [u8; 3] = std::array::from_fn(|_| rng.random());
        if seen.insert(rgb) {
            colours.push(rgb);
        }
    }
    if colours.is_empty() {
        Err("no colours were given: give --flat, --random, or both".into())
    } else {
        Ok(colours)
    }
}
