//! `scaleproof merge`: the shards of a run become its report.

use std::io::Write;
use std::path::PathBuf;

use super::{CommandResult, detectors, score as score_command};
use scaleproof_core::files;
use scaleproof_score as score;
use scaleproof_score::report;
use scaleproof_score::shard;

/// Put the shards of `score --shard` together: the same files as one run over all photos writes, byte for byte.
///
/// The sessions must lie where they lay when the shards were scored; photos and weights are not needed any more.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The shard files, all of one run.
    #[arg(required = true)]
    shards: Vec<PathBuf>,
    #[command(flatten)]
    judging: score_command::Judging,
    /// Folder for the report, as of `score`.
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    telling: score_command::Telling,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let criteria = args.judging.reading.criteria()?;
    let (run, observed) = shard::whole_run(&args.shards)?;
    let sessions = run.sessions()?;
    let networks = match run.chosen() {
        chosen if chosen.is_empty() => Vec::new(),
        chosen => detectors::chosen(&chosen)?,
    };
    let detectors = run.detectors(networks, &sessions)?;
    files::check_writable(&args.output)?;
    args.judging.tables.check(&sessions)?;
    let patterns = args.judging.patterns.of(&sessions)?;
    let speeds = args.judging.speeds(&detectors)?;
    let scores = score::merge(sessions, detectors, observed, run.runtime)?;
    let mut scores = args.judging.tables.made(scores, criteria)?;
    scores.patterns = patterns;
    let page = report::write(&args.output, &scores, speeds.as_ref())?;
    score_command::show(&scores, speeds.as_ref(), &page, &args.telling, out)
}
