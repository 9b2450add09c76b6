//! `scaleproof compare`: is one texture harder to detect than another, and can these photos tell?

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::choice::one_of;
use super::criteria::{self, Reading};
use super::patterns::Patterns;
use super::{CommandResult, Outcome, Result, at_hand, score as score_command, sessions};
use scaleproof_core::files;
use scaleproof_score as score;
use scaleproof_score::report;
use scaleproof_score::{ClusteredBy, CompareError, Comparison, SealedPlan};
use scaleproof_session::Session;

/// Compare textures on photos paired by place and bin: drops with 95 % intervals, exact tests, and whether the photos can tell.
#[derive(clap::Args)]
#[command(
    mut_arg("detector", |a| a.help("Detector to compare with; once for each, or a list with commas; all whose weights are here when none is named")),
    mut_arg("recorded", |a| a.help("Compare the detections stored in the sessions instead of running the detectors: all that are stored when none is named")),
)]
pub(super) struct Args {
    #[command(flatten)]
    photos: sessions::Photos,
    /// The variant that the others are held against [default: normal, else the first that is listed]
    #[arg(long, value_name = "NAME")]
    base: Option<String>,
    /// The variant that is a second plain round, in no difference that is tested: a word for a detector is held back where it moves that detector by as much as
    /// the texture does
    #[arg(long, value_name = "NAME", conflicts_with_all = ["plan", "sequential"])]
    control: Option<String>,
    #[command(flatten)]
    detectors: at_hand::Detectors,
    #[command(flatten)]
    reading: Reading,
    /// The plan that was fixed before the photos (`plan --seal`): whatever differs from it is listed first.
    #[arg(long, value_name = "JSON")]
    plan: Option<PathBuf>,
    #[command(flatten)]
    patterns: Patterns,
    #[command(flatten)]
    looks: Looks,
    #[command(flatten)]
    effort: score_command::Effort,
    /// Folder for comparison.html, comparison.tex, comparison.csv, comparison.json and the drops as SVG and PDF.
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    telling: score_command::Telling,
}

/// Whether the photos are looked at while they are taken.
#[derive(clap::Args)]
struct Looks {
    /// Say what was shown when, looking after every pair or, with =places, after every place: tests and intervals that hold however often one looks.
    #[arg(long, value_name = "AFTER", num_args = 0..=1, require_equals = true, default_missing_value = "pairs",
          value_parser = one_of([(ClusteredBy::PlaceAndBin, "pairs"), (ClusteredBy::Place, "places")]))]
    sequential: Option<ClusteredBy>,
    /// With --sequential: the smallest drop that matters; also say when it is smaller. Between 0 and 1.
    #[arg(long, value_name = "DROP", requires = "sequential", allow_negative_numbers = true, value_parser = inside)]
    least: Option<f64>,
}

/// A number between 0 and 1, without both.
pub(super) fn inside(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number < 1.0 => Ok(number),
        _ => Err("give a number above 0 and below 1".into()),
    }
}

/// Photos without a partner that are said one by one.
const MOST_LISTED: usize = 20;

/// The variant that the others are held against, found out before any photo is looked at.
fn checked_base(named: Option<&str>, sessions: &[Session]) -> Result<String> {
    criteria::check_base(named, sessions)?;
    let (all, base) = (criteria::variants(sessions), criteria::base_of(named, sessions));
    let base = base.to_owned();
    match all.as_slice() {
        [only] if *only == base => Err(CompareError::NothingElse { base }.into()),
        all if !all.contains(&base.as_str()) => Err(CompareError::NoBase {
            base,
            variants: all.join(", "),
        }
        .into()),
        all => {
            let own = places(&base, sessions);
            match all.iter().find(|variant| places(variant, sessions).is_disjoint(&own)) {
                Some(variant) => {
                    let variant = (*variant).to_owned();
                    Err(CompareError::NoPair { base, variant }.into())
                }
                None => Ok(base),
            }
        }
    }
}

/// Returns the places at which photos of a variant were taken.
fn places<'a>(variant: &str, sessions: &'a [Session]) -> BTreeSet<&'a str> {
    let photos = sessions
        .iter()
        .flat_map(|s| &s.photos)
        .filter(|photo| photo.variant == variant);
    photos.map(|photo| photo.place.as_deref().unwrap_or_default()).collect()
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let opened = args.photos.open()?;
    opened.refuse_for_folders("--recorded", args.detectors.recorded)?;
    opened.check_output(&args.output)?;
    let plan = args.plan.as_deref().map(SealedPlan::read).transpose()?;
    let named = args.base.as_deref().or_else(|| Some(plan.as_ref()?.0.base.as_str()));
    let base = checked_base(named, &opened.sessions)?;
    criteria::check_control(args.control.as_deref(), &base, &opened.sessions)?;
    let detectors = args.detectors.evaluated(&opened.sessions)?;
    files::check_writable(&args.output)?;
    let criteria = args.reading.criteria()?;
    let patterns = args.patterns.of(&opened.sessions)?;
    let options = args.effort.options(&detectors)?;
    let scores = score_command::score_with_progress(opened.sessions, detectors, &options)?;
    let mut scores = scores
        .judged_by(criteria)
        .against(&base)
        .controlled_by(args.control.as_deref())?;
    scores.patterns = patterns;
    let mut comparison = score::compare(&scores, &base, criteria.ap)?;
    let looks = args.looks.sequential.map(|by| (by, args.looks.least));
    if let Some((by, least)) = looks.or_else(|| plan.as_ref()?.0.stopping.looks()) {
        let looks = score::sequential(&scores, &base, by, least)?;
        score::decide_by_looks(&mut comparison, looks);
    }
    if let Some((plan, mut kept)) = plan {
        plan.judge(&mut comparison);
        kept.deviations.extend(plan.deviations(&scores, &comparison)?);
        comparison.plan = Some(kept);
    }
    let page = report::write_comparison(&args.output, &scores, &comparison)?;
    say_unpaired(&comparison, &page);
    if args.telling.json {
        score_command::caution(&scores);
        write!(out, "{}", report::comparison_json(&scores, &comparison)?)?;
        return Ok(Outcome::Done);
    }
    writeln!(out, "{}", report::comparison_table(&scores, &comparison))?;
    if args.telling.all {
        writeln!(out, "\n{}", report::further_comparison(&scores, &comparison))?;
    }
    score_command::conclude(&scores, &page, &args.telling, out)
}

/// Says on standard error which photos have no partner.
fn say_unpaired(comparison: &Comparison, page: &Path) {
    for photo in comparison.unpaired.iter().take(MOST_LISTED) {
        say!("not compared: {}/{}: {}", photo.session, photo.file, photo.reason);
    }
    if let Some(more) = comparison.unpaired.len().checked_sub(MOST_LISTED + 1) {
        say!("not compared: {} more, which {} lists", more + 1, page.display());
    }
}
