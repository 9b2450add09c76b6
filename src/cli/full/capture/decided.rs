//! `capture --until-decided`: after each photo the pairs are looked at, and the capture ends when they are enough.

use std::path::PathBuf;

use super::terminal::TerminalLog;
use crate::cli::compare::inside;
use crate::cli::results::{Programs, Results};
use crate::cli::{Result, at_hand, detectors, score as score_command};
use scaleproof_capture::Guidance;
use scaleproof_capture::page::PairsSoFar;
use scaleproof_pose::scene::Bin;
use scaleproof_score as score;
use scaleproof_score::report;
use scaleproof_score::{ClusteredBy, CompareError, EvaluatedDetector, Options, SequentialFinding};
use scaleproof_session::Session;

/// When a capture may end before every view is there.
#[derive(clap::Args)]
pub(super) struct Args {
    /// End as soon as the mean confidence is shown to change, or a drop of --least is excluded, for every detector; the session has the photos of --base already. The test holds however often
    /// it is looked at (`compare --sequential`).
    #[arg(long, requires_all = ["detectors", "source"])]
    pub(super) until_decided: bool,
    /// With --until-decided: a detector that looks at each pair; once for each, or a list with commas.
    #[arg(
        long = "detector",
        value_name = "NAME",
        value_delimiter = ',',
        requires = "until_decided"
    )]
    detectors: Vec<String>,
    #[command(flatten)]
    folder: detectors::Folder,
    #[command(flatten)]
    programs: Programs,
    /// With --until-decided: the texture that the photos are held against.
    #[arg(long, value_name = "NAME", default_value = score::BASE_VARIANT)]
    base: String,
    /// With --until-decided: the smallest drop of the mean confidence that matters. Between 0 and 1.
    #[arg(long, value_name = "DROP", requires = "until_decided", allow_negative_numbers = true, value_parser = inside)]
    least: Option<f64>,
    #[command(flatten)]
    effort: score_command::Effort,
}

impl Args {
    /// Opens the session that the photos go into, which has the base's photos, and the detectors.
    ///
    /// # Errors
    /// A session without photos of the base at this place; detectors that cannot take part.
    pub(super) fn question(&self, folder: PathBuf, variant: &str, place: &str) -> Result<Option<Question>> {
        if !self.until_decided {
            return Ok(None);
        }
        if variant == self.base {
            return Err(format!(
                "`{variant}` is the texture that the others are held against: all of its views are needed, and nothing is decided by it"
            )
            .into());
        }
        let is_base = |photo: &scaleproof_session::PhotoEntry| {
            photo.variant == self.base && photo.place.as_deref() == Some(place)
        };
        let session = if folder.join("session.json").exists() {
            Some(Session::open(&folder)?).filter(|session| session.photos.iter().any(is_base))
        } else {
            None
        };
        let Some(session) = session else {
            return Err(format!(
                "{} has no photos of `{}` at {place} that photos of `{variant}` could be held against: capture those first",
                folder.display(),
                self.base
            )
            .into());
        };
        let results = Results {
            programs: self.programs.clone(),
            ..Results::default()
        };
        let detectors = at_hand::evaluated(&[session], &self.detectors, false, &self.folder, &results)?;
        Ok(Some(Question {
            options: self.effort.options(&detectors)?,
            folder,
            variant: variant.to_owned(),
            place: place.to_owned(),
            base: self.base.clone(),
            least: self.least,
            detectors,
        }))
    }
}

/// Whether two textures differ, asked of a session that grows.
pub(super) struct Question {
    folder: PathBuf,
    variant: String,
    place: String,
    base: String,
    least: Option<f64>,
    detectors: Vec<EvaluatedDetector>,
    options: Options,
}

impl Question {
    /// Looks at the pairs, and says what they say.
    ///
    /// # Errors
    /// The session cannot be read, a detector fails.
    pub(super) fn ask(&self, guidance: &Guidance, terminal: &mut TerminalLog) -> Result<PairsSoFar> {
        let mut session = Session::open(&self.folder)?;
        session
            .photos
            .retain(|photo| [&self.base, &self.variant].contains(&&photo.variant));
        let scores = score::score(vec![session], self.detectors.clone(), &self.options, || {})?;
        let targets = guidance.targets().iter().enumerate();
        let open = targets.filter(|(_, target)| target.photo.is_none());
        let (open, bins): (Vec<usize>, Vec<Bin>) = open.map(|(i, target)| (i, target.bin)).unzip();
        let pairs = [self.base.as_str(), &self.variant];
        let next = score::most_telling(&scores, pairs, &self.place, &bins).map(|next| open[next]);
        let (sentence, is_decided) = match score::sequential(&scores, &self.base, ClusteredBy::PlaceAndBin, self.least)
        {
            Ok(looked) => {
                let mut findings = looked.results.iter().map(|course| &course.mean_confidence.finding);
                let is_decided = findings.all(|finding| *finding != SequentialFinding::Undecided);
                (report::standing(&looked), is_decided)
            }
            Err(CompareError::NoPair { .. } | CompareError::NothingElse { .. }) => ("no pair yet".into(), false),
            Err(e) => return Err(e.into()),
        };
        let pairs = PairsSoFar {
            sentence,
            is_decided,
            next,
        };
        terminal.standing(&pairs, guidance)?;
        Ok(pairs)
    }
}
