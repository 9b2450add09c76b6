//! `scaleproof schemas`: what the keys of every JSON output mean, as JSON Schema (draft 2020-12), from the types that are written.

use std::io::Write;
use std::path::PathBuf;

use super::answer::{Named, Written, named};
use super::{
    CommandResult, Outcome, camera, colour, demo, detectors, full, locate, pattern, plan, print, scene, score, session,
};
use scaleproof_core::files;
use scaleproof_detect::Speeds;
use scaleproof_score::SealedFile;
use scaleproof_score::report::{ComparisonPage, SummaryPage};

/// Write the JSON Schemas of all outputs
#[derive(clap::Args)]
pub(super) struct Args {
    /// Folder for the schemas
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

fn all() -> Vec<Named> {
    let mut all = vec![
        named::<camera::Answer>("camera-show"),
        named::<ComparisonPage>("comparison"),
        named::<colour::Answer>("colour-read"),
        named::<demo::Answer>("demo"),
        named::<locate::OutputLine>("locate"),
        named::<pattern::Answer>("pattern-check"),
        named::<Written<pattern::Imported>>("pattern-import"),
        named::<Written<pattern::Random>>("pattern-random"),
        named::<plan::Planned>("plan"),
        named::<plan::sealed::Sealed>("plan-seal"),
        named::<SealedFile>("plan-sealed-file"),
        named::<Written<scene::Answer>>("scene-new"),
        named::<scene::Shown>("scene-show"),
        named::<score::WrittenShard>("score-shard"),
        named::<Speeds>("speed"),
        named::<SummaryPage>("summary"),
    ];
    all.extend(detectors::schemas());
    all.extend(print::schemas());
    all.extend(session::schemas());
    all.extend(full::schemas());
    all
}

pub(super) fn run(args: &Args, out: &mut dyn Write) -> CommandResult {
    let mut new = Vec::new();
    for (name, schema) in all() {
        let text = serde_json::to_string_pretty(&schema)? + "\n";
        new.push((args.output.join(format!("{name}.json")), text.into_bytes()));
    }
    files::replace_all_atomically(&args.output, &new)?;
    writeln!(out, "{}: {} schemas", args.output.display(), new.len())?;
    Ok(Outcome::Done)
}
