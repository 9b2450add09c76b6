//! `scaleproof attack run`: a pattern against detectors.

use std::io::Write;

use crate::cli::args::attack::on_frames::OnFrames;
use crate::cli::args::attack::run::RunArgs;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_attack::run::history::Entry;
use scaleproof_attack::run::{Attack, AttackConfig, Rgb};
use scaleproof_attack::setup::Setup;

/// Name of the attack in histories and cards.
pub const METHOD: &str = "dta";

pub fn run(args: &RunArgs, out: &mut dyn Write) -> CommandResult {
    let config = args.config()?;
    let setup = args.on.open(METHOD, true, &config.eot)?;
    let config = setup.named(config);
    let (cells, entries) = optimise(&args.on, &setup, &config)?;
    args.on.write(&setup, (METHOD, &cells, entries), Some(&config), out)
}

/// Runs the attack with a bar that shows where it stands.
pub fn optimise(on: &OnFrames, setup: &Setup, config: &AttackConfig) -> Result<(Vec<Rgb>, Vec<Entry>)> {
    let finished = progress::steps("attacking", config.steps as usize).during(|bar| {
        let attack = Attack::begin(&setup.view_set, &setup.detectors, config, &on.output)?;
        attack.run(&on.output, |done, entry| {
            bar.set_position(u64::from(done));
            if let Some(confidence) = entry.confidence {
                bar.set_message(format!("confidence {confidence:.2}"));
            }
        })
    });
    Ok(finished?)
}
