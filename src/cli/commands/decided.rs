//! `capture --until-decided`: after each photo the pairs are looked at, and the capture ends when they are enough.

use std::path::PathBuf;

use crate::cli::args::capture::DecidedArgs;
use crate::cli::results::Results;
use crate::cli::{Result, at_hand};
use scaleproof_capture::Guidance;
use scaleproof_capture::page::PairsSoFar;
use scaleproof_pose::scene::Bin;
use scaleproof_score as score;
use scaleproof_score::report;
use scaleproof_score::{ClusteredBy, CompareError, EvaluatedDetector, Options, SequentialFinding};
use scaleproof_session::Session;

impl DecidedArgs {
    /// Opens the session that the photos go into, which has the base's photos, and the detectors.
    ///
    /// # Errors
    /// A session without photos of the base at this place; detectors that cannot take part.
    pub fn question(&self, folder: PathBuf, variant: &str, place: &str) -> Result<Option<Question>> {
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

/// Sequential test of whether two textures differ, on a session that grows.
pub struct Question {
    folder: PathBuf,
    variant: String,
    place: String,
    base: String,
    least: Option<f64>,
    detectors: Vec<EvaluatedDetector>,
    options: Options,
}

impl Question {
    /// Looks at the pairs.
    ///
    /// # Errors
    /// The session cannot be read, a detector fails.
    pub fn ask(&self, guidance: &Guidance) -> Result<PairsSoFar> {
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
        Ok(PairsSoFar {
            sentence,
            is_decided,
            next,
        })
    }
}
