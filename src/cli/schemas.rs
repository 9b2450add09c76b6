//! `scaleproof schemas`: what the keys of every JSON output mean, as JSON Schema (draft 2020-12), from the types that are written.

use std::io::Write;
use std::path::PathBuf;

use schemars::schema_for;

use super::answer::{Named, Written};
use super::{
    CommandResult, Outcome, camera, colour, demo, detectors, full, locate, pattern, plan, print, scene, score, session,
};
use scaleproof_core::files;
use scaleproof_detect::Speeds;

/// Write the JSON Schemas of all outputs
#[derive(clap::Args)]
pub(super) struct Args {
    /// Folder for the schemas
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

fn all() -> Vec<Named> {
    let mut all = vec![
        ("camera-show", schema_for!(camera::Answer)),
        ("colour-read", schema_for!(colour::Answer)),
        ("demo", schema_for!(demo::Answer)),
        ("locate", schema_for!(locate::OutputLine)),
        ("pattern-check", schema_for!(pattern::Answer)),
        ("pattern-import", schema_for!(Written<pattern::Imported>)),
        ("pattern-random", schema_for!(Written<pattern::Random>)),
        ("plan", schema_for!(plan::PairsNeeded)),
        ("plan-scene", schema_for!(plan::PlacesNeeded)),
        ("plan-seal", schema_for!(plan::sealed::Sealed)),
        ("scene-new", schema_for!(Written<scene::Answer>)),
        ("score-shard", schema_for!(score::WrittenShard)),
        ("speed", schema_for!(Speeds)),
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
    files::replace_all_atomically(&new)?;
    writeln!(out, "{}: {} schemas", args.output.display(), new.len())?;
    Ok(Outcome::Done)
}
