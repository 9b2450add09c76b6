//! The program inside another process, for its Python module: commands whose output is returned, one photo located, and scoring with functions
//! among the detectors.

use std::ffi::OsString;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::{FromArgMatches, Parser};

pub use super::own_file::begin;
use super::{
    Outcome, Result, advice, at_hand, command, done, is_mistake, locate, mistakes, score as score_command, sessions,
};
use scaleproof_detect::CalledDetector;
use scaleproof_photo::PhotoError;
use scaleproof_pose::locate::LocatedPhoto;
use scaleproof_score as score;
use scaleproof_score::{EvaluatedDetector, Scores};

/// Output of a command, and how it ended.
#[derive(Debug)]
pub struct Ran {
    /// Bytes for standard output.
    pub printed: Vec<u8>,
    /// The sentence on what was wrong.
    pub error: Option<String>,
    /// True if some input was bad while other answers could be given.
    pub is_some_input_bad: bool,
}

/// Runs a command, given its arguments without the program's name. What it says beside its results goes to standard error.
pub fn run(arguments: &[String]) -> Ran {
    let mut printed = Vec::new();
    let ended = words(arguments).and_then(|words| {
        let mut whole = command();
        let matches = whole.try_get_matches_from_mut(&words);
        let parsed = matches.and_then(|matches| super::Cli::from_arg_matches(&matches));
        match parsed {
            Ok(cli) => {
                if cli.quiet {
                    scaleproof_terminal::be_quiet();
                }
                done(cli.command, &mut printed).map_err(|e| advice::sentence(e.as_ref()))
            }
            Err(e) if is_mistake(&e) => Err(mistakes::sentence(&e, &whole, &words)),
            Err(help_or_version) => {
                printed.extend(help_or_version.to_string().into_bytes());
                Ok(Outcome::Done)
            }
        }
    });
    let is_some_input_bad = matches!(ended, Ok(Outcome::SomeInputBad));
    Ran {
        error: ended.err(),
        printed,
        is_some_input_bad,
    }
}

/// Arguments behind the program's name.
fn words(arguments: &[String]) -> std::result::Result<Vec<OsString>, String> {
    let words = ["scaleproof"].into_iter().chain(arguments.iter().map(String::as_str));
    let words: Vec<OsString> = words.map(OsString::from).collect();
    match arguments.iter().find(|argument| argument.contains('\0')) {
        Some(argument) => Err(format!("{argument:?} has a byte 0 in it: no name has one")),
        None => Ok(words),
    }
}

/// Returns the line of `locate --json` about a photo that a path or another name stands for.
///
/// # Errors
/// Figures that JSON has no words for.
pub fn located(
    name: &Path,
    answer: std::result::Result<LocatedPhoto, PhotoError>,
) -> std::result::Result<String, String> {
    serde_json::to_string(&locate::line(name, &answer)).map_err(|e| e.to_string())
}

/// The arguments of a scoring run in the process: those of `score` on photos, detectors and criteria.
#[derive(Parser)]
#[command(name = "score", no_binary_name = true)]
struct Scoring {
    #[command(flatten)]
    photos: sessions::Photos,
    #[command(flatten)]
    detectors: at_hand::Detectors,
    #[command(flatten)]
    judging: score_command::Judging,
    #[command(flatten)]
    effort: score_command::Effort,
}

/// Callbacks of a scoring run, and the flag that ends it.
pub struct Watch<'a> {
    /// Told how many photos there are, before the first is looked at.
    pub begins: &'a (dyn Fn(usize) + Sync),
    /// Called after each photo.
    pub on_photo: &'a (dyn Fn() + Sync),
    /// Ends the run once it is set.
    pub stop: Arc<AtomicBool>,
}

/// Scores photos as `score` does with these arguments, with some functions among the detectors. Where functions are given, no detectors at hand
/// are taken that are not named.
///
/// # Errors
/// The sentence that the program would print.
pub fn scored(
    arguments: &[String],
    functions: Vec<CalledDetector>,
    watch: &Watch,
) -> std::result::Result<Scores, String> {
    let mut as_given = words(arguments)?;
    as_given.insert(1, "score".into());
    let args = Scoring::try_parse_from(arguments).map_err(|e| mistakes::sentence(&e, &command(), &as_given))?;
    score_with(args, functions, watch).map_err(|e| advice::sentence(e.as_ref()))
}

fn score_with(args: Scoring, functions: Vec<CalledDetector>, watch: &Watch) -> Result<Scores> {
    let criteria = args.judging.reading.criteria()?;
    let opened = args.photos.open()?;
    opened.refuse_for_folders("--recorded", args.detectors.recorded)?;
    let has_functions = !functions.is_empty();
    let named = &args.detectors;
    let are_all_given = named.names.is_empty() && !named.recorded && !named.results.are_given();
    let mut detectors = if are_all_given && has_functions {
        Vec::new()
    } else {
        named.evaluated(&opened.sessions)?
    };
    let class = opened.sessions.first().map(|session| session.scene.model.class.clone());
    for (function, class) in functions.into_iter().zip(class.iter().cycle()) {
        detectors.push(EvaluatedDetector::called(function, class)?);
    }
    at_hand::check_names(detectors.iter().map(|d| d.manifest.name.as_str()))?;
    args.judging.tables.check(&opened.sessions)?;
    let patterns = args.judging.patterns.of(&opened.sessions)?;
    let mut options = score::Options {
        stop: Arc::clone(&watch.stop),
        ..args.effort.options(&detectors)?
    };
    // A photo that waits for its function holds a thread. One thread alone takes photos in their order, and stays one.
    if has_functions && options.threads > 1 {
        options.threads += 1;
    }
    (watch.begins)(opened.sessions.iter().map(|session| session.photos.len()).sum());
    let sets: Vec<_> = opened.sessions.iter().filter_map(score::SessionFiles::new).collect();
    let scores = score::score(opened.sessions, detectors, &options, watch.on_photo);
    let scores = score::explained(scores, &sets, options.cache.as_ref())?;
    let mut scores = args.judging.tables.made(scores, criteria)?;
    scores.patterns = patterns;
    Ok(scores)
}

/// An error's sentence with the program's advice.
pub fn sentence(error: &(dyn std::error::Error + 'static)) -> String {
    advice::sentence(error)
}
