//! `scaleproof score`: how well do detectors see the model in these sessions?

use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::answer::told;
use super::choice::one_of;
use super::criteria::{Reading, Tables};
use super::defence;
use super::patterns::Patterns;
use super::{CommandResult, Outcome, Result, at_hand, own_file, progress, sessions};
use scaleproof_core::message::Message;
use scaleproof_core::{files, spelling, workers};
use scaleproof_detect::{Manifest, Runtime, Speeds, chosen_as};
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_score as score;
use scaleproof_score::report;
use scaleproof_score::shard::{Run, Shard, ShardId};
use scaleproof_score::{
    Cache, Corruption, Defences, Defending, EvaluatedDetector, Options, Ranking, Robustness, ScoreError, Scores,
    Settings,
};
use scaleproof_session::Session;

/// Score detectors on photos: AP@0.5, hit rate and confidence per texture and viewing direction, with a report.
///
/// A photo that cannot be read or located is listed with its reason, and the others are scored.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    photos: sessions::Photos,
    #[command(flatten)]
    detectors: at_hand::Detectors,
    #[command(flatten)]
    judging: Judging,
    #[command(flatten)]
    effort: Effort,
    /// Folder for report.html, table.tex, summary.json, photos.csv, figures.csv, the charts as SVG and PDF, and the COCO files.
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// Store the detections in each session's folder `recorded`, for later runs with --recorded.
    #[arg(long, conflicts_with_all = ["recorded", "results"])]
    record: bool,
    /// With --record: store detections in place of those that are stored already.
    #[arg(long, requires = "record")]
    replace: bool,
    /// Look at the photos again, made worse step by step, and tell at which severities each drop is still shown.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = one_of(Corruption::ALL.map(|kind| (kind, kind.name()))))]
    corrupt: Vec<Corruption>,
    #[command(flatten)]
    defences: defence::Defences,
    /// Say whether the order of the textures is the same in these sessions, which the same detectors look at: Kendall's τ with its interval, for each detector, and for each group of --group-by.
    #[arg(long, value_name = "SESSION", num_args = 1.., conflicts_with = "results")]
    ranking: Vec<PathBuf>,
    /// What `advise` found to be enough for these photos: a TOML file with the tag detector, the lens model's terms, the truth boxes and the definition of AP.
    #[arg(long, value_name = "TOML")]
    settings: Option<PathBuf>,
    /// Score one part of the photos and write a file for `merge` instead of the report: `2/3` is the second of three, `slurm`
    /// the task of an array job, `k8s/3` the pod of an indexed job of three.
    #[arg(long, value_name = "I/N", conflicts_with_all = ["record", "corrupt", "defence", "ranking", "settings", "ap", "confidence", "protocol", "base", "control", "group_by", "speed", "patterns"])]
    shard: Option<ShardId>,
    #[command(flatten)]
    telling: Telling,
}

/// How much of what is known is said, and in which form.
#[derive(clap::Args)]
pub(super) struct Telling {
    /// Print every table and note, and what may be written in a paper.
    #[arg(long, conflicts_with = "json")]
    pub(super) all: bool,
    /// Print JSON instead of text.
    #[arg(long)]
    pub(super) json: bool,
}

/// What is made of what was found: nothing of it needs the photos again.
#[derive(clap::Args)]
pub(super) struct Judging {
    #[command(flatten)]
    pub(super) reading: Reading,
    #[command(flatten)]
    pub(super) tables: Tables,
    #[command(flatten)]
    pub(super) patterns: Patterns,
    /// File of `scaleproof detectors speed`: the report then charts AP against milliseconds a photo.
    #[arg(long, value_name = "FILE")]
    speed: Option<PathBuf>,
}

impl Judging {
    pub(super) fn speeds(&self, detectors: &[EvaluatedDetector]) -> Result<Option<Speeds>, Message> {
        self.speed.as_deref().map(|path| speeds(path, detectors)).transpose()
    }
}

/// How hard a run works and what it keeps; no result depends on it.
#[derive(Default, clap::Args)]
pub(super) struct Effort {
    /// Threads to use; one a core when left out.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Folder that keeps what was found in each photo, by content, so that a later or interrupted run need not look again; the
    /// user's cache when left out. It may be deleted at any time.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

impl Effort {
    pub(super) fn options(&self, detectors: &[EvaluatedDetector]) -> Result<Options> {
        self.options_with(detectors, TagDetectorChoice::default())
    }

    pub(super) fn options_with(&self, detectors: &[EvaluatedDetector], tags: TagDetectorChoice) -> Result<Options> {
        let runtime = score::runtime(detectors)?.map(|runtime| runtime.provenance());
        let libraries = format!(
            "{}; {}{}",
            tags.provenance(),
            runtime.unwrap_or_default(),
            own_file::module()
        );
        let folder = self
            .cache
            .clone()
            .or_else(|| Some(dirs::cache_dir()?.join("scaleproof/photos")));
        let cache = match folder.map(|folder| Cache::open(&folder, &libraries)) {
            // Only what the user named must be there.
            Some(Err(e)) if self.cache.is_some() => return Err(e.into()),
            cache => cache.and_then(Result::ok),
        };
        Ok(Options {
            threads: self.threads.map_or_else(workers::thread_count, usize::from),
            cache,
            tags,
            ..Options::default()
        })
    }
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let applied = args.settings.as_deref().map(Settings::open).transpose()?;
    let settings = applied
        .as_ref()
        .map(|applied| applied.settings.clone())
        .unwrap_or_default();
    let criteria = args.judging.reading.criteria_or(settings.ap()?)?;
    let mut opened = args.photos.open()?;
    opened.sessions = opened
        .sessions
        .into_iter()
        .map(|session| settings.applied(session))
        .collect();
    for (option, is_given) in [
        ("--recorded", args.detectors.recorded),
        ("--record", args.record),
        ("--shard", args.shard.is_some()),
    ] {
        opened.refuse_for_folders(option, is_given)?;
    }
    let detectors = args.detectors.evaluated(&opened.sessions)?;
    opened.check_output(&args.output)?;
    if let (true, Some(program)) = (args.record, detectors.iter().find(|d| d.foreign().is_some())) {
        let name = &program.manifest.name;
        return Err(
            format!("--record stores the detections of networks, and {name} is a program: leave it out").into(),
        );
    }
    args.judging.tables.check(&opened.sessions)?;
    if !args.corrupt.is_empty() {
        score::check_changeable(&opened.sessions, &detectors, "made worse")?;
    }
    if args.defences.are_given() {
        score::check_changeable(&opened.sessions, &detectors, "defended")?;
    }
    let defences = args.defences.opened(&args.detectors.results.programs)?;
    let patterns = args.judging.patterns.of(&opened.sessions)?;
    if args.record {
        score::check_recordings(&opened.sessions, &detectors, args.replace)?;
    }
    let others = sessions::opened(&args.ranking)?;
    files::check_writable(&args.output)?;
    let speeds = args.judging.speeds(&detectors)?;
    let options = args.effort.options_with(&detectors, settings.tags()?)?;
    if let Some(shard) = args.shard {
        let path = write_shard(&args, shard, &opened.sessions, &detectors, &options)?;
        let words = format!("shard {shard}: {}", path.display());
        let shard = shard.to_string();
        return told(args.telling.json, WrittenShard { shard, file: path }, words, out);
    }
    let scores = score_with_progress(opened.sessions, detectors, &options)?;
    let mut scores = args.judging.tables.made(scores, criteria)?;
    scores.patterns = patterns;
    let mut scores = scores.made_by(applied);
    if !args.corrupt.is_empty() {
        scores.robustness = made_worse(&scores, &args.corrupt, &options)?;
    }
    if !defences.is_empty() {
        scores.defences = defended(&scores, &defences, &options)?;
    }
    if let Some(others) = others {
        scores.ranking = Some(against(&scores, others, &args, &options)?);
    }
    let page = report::write(&args.output, &scores, speeds.as_ref())?;
    if args.record {
        score::record(&scores)?;
    }
    show(&scores, speeds.as_ref(), &page, &args.telling, out)
}

/// Prints the results of a scoring run whose report is written.
pub(super) fn show(
    scores: &Scores,
    speeds: Option<&Speeds>,
    page: &Path,
    telling: &Telling,
    out: &mut dyn Write,
) -> CommandResult {
    if telling.json {
        caution(scores);
        write!(out, "{}", report::summary_json(scores, speeds)?)?;
        return Ok(Outcome::Done);
    }
    writeln!(out, "{}", report::summary_table(scores))?;
    if telling.all {
        writeln!(out, "\n{}", report::further_tables(scores))?;
    }
    conclude(scores, page, telling, out)
}

/// Prints what follows a table: the notes on it, and the path of the report's page.
pub(super) fn conclude(scores: &Scores, page: &Path, telling: &Telling, out: &mut dyn Write) -> CommandResult {
    out.flush()?;
    if telling.all {
        caution(scores);
    } else {
        caution_briefly(scores);
    }
    writeln!(out, "report: {}", page.display())?;
    Ok(Outcome::Done)
}

pub(super) fn speeds(path: &Path, detectors: &[EvaluatedDetector]) -> Result<Speeds, Message> {
    let manifests: Vec<&Manifest> = detectors.iter().map(|c| &c.manifest).collect();
    Speeds::open(path, &manifests)
}

pub(super) fn score_with_progress(
    sessions: Vec<Session>,
    detectors: Vec<EvaluatedDetector>,
    options: &Options,
) -> Result<Scores, ScoreError> {
    let bar = progress::photos("scoring", sessions.iter().map(|s| s.photos.len()).sum());
    let sets: Vec<_> = sessions.iter().filter_map(score::SessionFiles::new).collect();
    let scores = score::score(sessions, detectors, options, || bar.inc(1));
    bar.finish_and_clear();
    let scores = score::explained(scores, &sets, options.cache.as_ref());
    complain(options);
    scores
}

/// Looks at the photos of other sessions, and holds the order of the variants against theirs.
fn against(scores: &Scores, others: Vec<Session>, args: &Args, options: &Options) -> Result<Ranking> {
    let detectors = args.detectors.evaluated(&others)?;
    let others = score_with_progress(others, detectors, options)?.judged_by(scores.criteria);
    say_not_scored(&others);
    Ok(score::ranking(scores, &others))
}

/// Looks at the photos again and shows how far it has come.
fn made_worse(
    scores: &Scores,
    corruptions: &[Corruption],
    options: &Options,
) -> Result<Option<Robustness>, ScoreError> {
    let bar = progress::photos("made worse", scores.photos.len());
    let robustness = score::under_corruption(scores, corruptions, options, || bar.inc(1));
    bar.finish_and_clear();
    complain(options);
    if let Ok(found) = &robustness {
        say_cautions(found.as_ref().map(|found| found.cautions.as_slice()), "made worse");
    }
    robustness
}

/// Looks at the photos again and shows how far it has come.
fn defended(scores: &Scores, defences: &[Defending], options: &Options) -> Result<Option<Defences>, ScoreError> {
    let bar = progress::photos("defended", scores.photos.len());
    let defended = score::under_defences(scores, defences, options, || bar.inc(1));
    bar.finish_and_clear();
    complain(options);
    if let Ok(found) = &defended {
        say_cautions(found.as_ref().map(|found| found.cautions.as_slice()), "defended");
    }
    defended
}

/// Prints the cautions about photos that were changed; `None` where no drop could be followed on them.
fn say_cautions(cautions: Option<&[String]>, changed: &str) {
    match cautions {
        None => say!("note: no photos pair, so that there is no drop to follow on photos that are {changed}"),
        Some(cautions) => cautions.iter().for_each(|caution| say!("note: {caution}")),
    }
}

fn complain(options: &Options) {
    for complaint in options.cache.iter().flat_map(Cache::complaints) {
        say!("note: {complaint}");
    }
}

/// Looks at one part of the photos and writes what `merge` needs.
fn write_shard(
    args: &Args,
    id: ShardId,
    sessions: &[Session],
    detectors: &[EvaluatedDetector],
    options: &Options,
) -> Result<PathBuf> {
    let photos = (1..=sessions.iter().map(|s| s.photos.len() as u64).sum()).filter(|photo| id.holds(*photo));
    let bar = progress::photos(&format!("scoring {id}"), photos.count());
    let observed = score::observe(sessions, detectors, options, id, || bar.inc(1));
    bar.finish_and_clear();
    complain(options);
    let runtime = score::runtime(detectors)?.map(Runtime::provenance);
    let chosen_as = detectors.iter().map(|d| chosen_as(&d.manifest, &args.detectors.names));
    let chosen_as = chosen_as.collect::<Result<_, _>>()?;
    let shard = Shard {
        run: Run::of(sessions, detectors, chosen_as, runtime)?,
        id,
        observed: observed?,
    };
    Ok(shard.write(&args.output)?)
}

pub(super) fn say_not_scored(scores: &Scores) {
    score::not_scored(scores)
        .iter()
        .for_each(|line| say!("not scored: {line}"));
}

/// Says on standard error which photos were left out, and all that is to be known before believing the figures.
pub(super) fn caution(scores: &Scores) {
    say_not_scored(scores);
    for caution in &scores.cautions {
        say!("note: {caution}");
    }
}

/// Notes that a screen has room for.
const MOST_NOTES: usize = 3;

/// As [`caution`], but the weightiest notes alone.
fn caution_briefly(scores: &Scores) {
    say_not_scored(scores);
    for caution in scores.cautions.iter().take(MOST_NOTES) {
        say!("note: {caution}");
    }
    if let Some(more @ 1..) = scores.cautions.len().checked_sub(MOST_NOTES) {
        say!(
            "{} in the report and with --all",
            spelling::choose(more, "1 more note is", &format!("{more} more notes are"))
        );
    }
}

/// `score --shard --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct WrittenShard {
    /// Which of how many, as in `2/3`.
    shard: String,
    /// The path of what it saw.
    file: PathBuf,
}
