//! Detectors that are other programs: `--results NAME=FILE`, whose detections lie in files, and `--detector exec:PROGRAM`, which run.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{Result, full, own_file};
use scaleproof_core::message::Message;
use scaleproof_detect::{
    Manifest, OutsideResults, PhotoName, ProgramDefence, ProgramDetector, ProgramError, ProgramSpec, ResultsRequest,
};
use scaleproof_score::EvaluatedDetector;
use scaleproof_session::Session;

/// Detections from outside.
#[derive(Default, clap::Args)]
pub(super) struct Results {
    /// Detections of another program, under a name of your choice: a COCO results list (.json), or a folder with YOLO's text files, one a
    /// photo; see `scaleproof session export` for what to run it on. Once for each detector.
    #[arg(long = "results", value_name = "NAME=FILE")]
    pub(super) results: Vec<String>,
    /// With --results: the COCO file whose images the results number.
    #[arg(long, value_name = "JSON", requires = "results")]
    pub(super) images: Option<PathBuf>,
    /// With --results: what the numbers of its classes mean: a COCO file with `categories`, the `names` of a YOLO data set's YAML file, or a text file of names, one a line; COCO's own
    /// when left out.
    #[arg(long, value_name = "FILE", requires = "results")]
    pub(super) categories: Option<PathBuf>,
    /// With --results: the number of the first class, where classes are counted: 0 for a COCO results list whose classes are 0 to 79, or by --categories a
    /// list of names from 0.
    #[arg(long, value_name = "NUMBER", requires = "results")]
    pub(super) first_label: Option<u64>,
    #[command(flatten)]
    pub(super) programs: Programs,
}

/// Detectors that are programs.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct Programs {
    /// With exec:PROGRAM, or the manifest of a program: the seconds it gets to start, and for each answer.
    #[arg(long, value_name = "SECONDS", default_value_t = DETECTOR_TIMEOUT_S, value_parser = clap::value_parser!(u64).range(1..=604_800))]
    detector_timeout: u64,
}

const DETECTOR_TIMEOUT_S: u64 = 600;

impl Default for Programs {
    fn default() -> Programs {
        Programs {
            detector_timeout: DETECTOR_TIMEOUT_S,
        }
    }
}

/// Names of networks, and the programs among the names.
type NetworksAndPrograms = (Vec<String>, Vec<ProgramSpec>);

impl Programs {
    /// Parts the names of detectors from programs.
    pub(super) fn among(&self, names: &[String]) -> Result<NetworksAndPrograms, Message> {
        let (mut networks, mut programs) = (Vec::new(), Vec::new());
        for name in names.iter().map(|name| name.trim()) {
            match ProgramSpec::named(name)? {
                Some(program) => programs.push(program),
                None => networks.push(name.to_owned()),
            }
        }
        Ok((networks, programs))
    }

    /// Starts them.
    pub(super) fn started(&self, programs: Vec<ProgramSpec>) -> Result<Vec<ProgramDetector>, ProgramError> {
        if !programs.is_empty() {
            end_with_an_interruption();
        }
        programs
            .into_iter()
            .map(|spec| ProgramDetector::open(spec, self.limit()))
            .collect()
    }

    /// Starts a program that changes photos.
    pub(super) fn started_as_defence(&self, program: ProgramSpec) -> Result<ProgramDefence, ProgramError> {
        end_with_an_interruption();
        ProgramDefence::open(program, self.limit())
    }

    fn limit(&self) -> Duration {
        Duration::from_secs(self.detector_timeout)
    }
}

/// From here on an interruption ends programs that run before it ends this one. Another program, as Python, goes on, and ends them itself.
fn end_with_an_interruption() {
    if !own_file::is_in_another_program() {
        full::end_programs_first();
    }
}

impl Results {
    pub(super) fn are_given(&self) -> bool {
        !self.results.is_empty()
    }

    pub(super) fn programs(&self, names: &[String]) -> Result<NetworksAndPrograms, Message> {
        self.programs.among(names)
    }

    pub(super) fn start(&self, programs: Vec<ProgramSpec>, sessions: &[Session]) -> Result<Vec<EvaluatedDetector>> {
        let Some(class) = sessions.first().map(|s| &s.scene.model.class) else {
            return Ok(Vec::new());
        };
        let started = self.programs.started(programs)?.into_iter();
        started
            .map(|program| Ok(EvaluatedDetector::program(program, class)?))
            .collect()
    }

    /// Reads all of them, for the photos of some sessions.
    pub(super) fn open(&self, sessions: &[Session]) -> Result<Vec<EvaluatedDetector>> {
        let (Some(class), true) = (sessions.first().map(|s| &s.scene.model.class), self.are_given()) else {
            return Ok(Vec::new());
        };
        let names = |s: &Session| -> Vec<PhotoName> {
            let folder = s.folder.canonicalize().unwrap_or_else(|_| s.folder.clone());
            s.photos
                .iter()
                .map(|photo| PhotoName::new(&folder, &photo.file))
                .collect()
        };
        let photos: Vec<PhotoName> = sessions.iter().flat_map(names).collect();
        let mut evaluated = Vec::new();
        for given in &self.results {
            let (name, path) = name_and_path(given)?;
            let results = OutsideResults::open(&ResultsRequest {
                name,
                path,
                images: self.images.as_deref(),
                categories: self.categories.as_deref(),
                first_label: self.first_label,
                photos: &photos,
            })?;
            evaluated.push(EvaluatedDetector::outside(results, class)?);
        }
        Ok(evaluated)
    }
}

fn name_and_path(given: &str) -> Result<(&str, &Path), String> {
    let wrong = |what: &str| format!("--results {given} {what}: write NAME=FILE, as in mine=results.json");
    let (name, path) = given.split_once('=').ok_or_else(|| wrong("names no detector"))?;
    match (Manifest::is_name(name), path) {
        (_, "") => Err(wrong("names no file")),
        (false, _) => Err(wrong("has a name that is not of letters, digits, `_`, `-` and `.`")),
        (true, path) => Ok((name, Path::new(path))),
    }
}
