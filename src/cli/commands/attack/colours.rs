//! `scaleproof attack colours`: further flat colours of rendered views, without rendering.

use crate::cli::print::attack::frames::say_frames;
use crate::cli::resolve::attack::frames::new_list;
use std::collections::BTreeSet;
use std::io::Write;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::cli::args::attack::colours::ColoursArgs;
use crate::cli::resolve::attack::render::hexes;
use crate::cli::{CommandResult, Result};
use scaleproof_core::files;
use scaleproof_frames::surrogate::additive::recoloured;
use scaleproof_frames::{FrameSet, light};

pub fn run(args: &ColoursArgs, out: &mut dyn Write) -> CommandResult {
    let set = FrameSet::open(&args.frames)?;
    let list = new_list(&args.output)?;
    let colours = colours(args)?;
    let (new, frames) = recoloured(&set, &colours, &args.output)?;
    files::replace_all_atomically(&args.output, &new)?;
    say_frames(&list, frames, args.json, out)
}

pub fn colours(args: &ColoursArgs) -> Result<Vec<[u8; 3]>> {
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
