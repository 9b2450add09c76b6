//! `scaleproof merge`: the shards of a run become its report.

use std::io::Write;
use std::path::PathBuf;

use super::{CommandResult, detectors, score as score_command};
use crate::files;
use crate::report;
use crate::score::shard::{self, DetectorUsed, Run, SessionSeen};
use crate::score::{self, Contestant};
use crate::session::Session;

/// Put the shards of `score --shard` together: the same files as one run over all photos writes, byte for byte.
///
/// The sessions must lie where they lay when the shards were scored; photos and weights are not needed any more.
#[derive(clap::Args)]
pub struct Args {
    /// The shard files, all of one run.
    #[arg(required = true)]
    shards: Vec<PathBuf>,
    #[command(flatten)]
    judging: score_command::Judging,
    /// Folder for the report, as of `score`.
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// Print summary.json instead of the table.
    #[arg(long)]
    json: bool,
}

pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let criteria = args.judging.criteria()?;
    let (run, observed) = shard::whole_run(&args.shards)?;
    if run.libraries != score::libraries() {
        let (theirs, own) = (run.libraries, score::libraries());
        return Err(
            format!("the shards were scored with {theirs}, and here is {own}: merge where they were scored").into(),
        );
    }
    let sessions = run.sessions.iter().map(opened).collect::<Result<Vec<_>, _>>()?;
    let contestants = contestants(&run, &sessions)?;
    files::check_writable(&args.output)?;
    let speeds = args.judging.speeds(&contestants)?;
    let scores = score::merge(sessions, contestants, observed, run.runtime)?.judged_by(criteria);
    let page = report::write(&args.output, &scores, speeds.as_ref())?;
    score_command::show(&scores, speeds.as_ref(), &page, args.json, out)
}

/// The session as it was when the shards were scored.
fn opened(seen: &SessionSeen) -> Result<Session, Box<dyn std::error::Error>> {
    let session = Session::open(&seen.folder)?;
    match session.hashes == seen.hashes {
        true => Ok(session),
        false => Err(format!(
            "{} has changed since the shards were scored: score them again",
            seen.folder.display()
        )
        .into()),
    }
}

/// The detectors as they were.
fn contestants(run: &Run, sessions: &[Session]) -> Result<Vec<Contestant>, Box<dyn std::error::Error>> {
    let chosen: Vec<String> = run.detectors.iter().map(|used| used.chosen_as.clone()).collect();
    let manifests = detectors::chosen(&chosen)?;
    let contestants = match run.is_recorded {
        true => score_command::contestants(sessions, manifests, None)?,
        false => {
            let class = sessions.first().map(|s| &s.scene.model.class);
            let elsewhere = manifests.into_iter().zip(class.into_iter().cycle());
            let elsewhere = elsewhere.map(|(m, class)| Contestant::ran_elsewhere(m, class));
            elsewhere.collect::<Result<_, _>>()?
        }
    };
    let is_same = |(c, used): (&Contestant, &DetectorUsed)| score_command::fingerprint(c) == used.fingerprint;
    match contestants.len() == run.detectors.len() && contestants.iter().zip(&run.detectors).all(is_same) {
        true => Ok(contestants),
        false => Err("a manifest or a recording has changed since the shards were scored: score them again".into()),
    }
}
