//! Detectors that a run evaluates: those that are named, else those at hand. A note names the others.

use std::collections::BTreeSet;
use std::path::Path;

use super::Result;
use super::detectors;
use super::results::Results;
use scaleproof_core::spelling::quoted;
use scaleproof_detect::{Manifest, Recording, WeightFolders};
use scaleproof_score::{EvaluatedDetector, evaluated_detectors};
use scaleproof_session::Session;

/// Detectors, and where their detections come from.
#[derive(clap::Args)]
pub(super) struct Detectors {
    /// Detector to score, see `scaleproof detectors list`; once for each, or a list with commas; all whose weights are here when none
    /// is named. A program of your own is `exec:PROGRAM` or `'exec:PROGRAM ARGUMENT …'`.
    #[arg(id = "detector", long = "detector", value_name = "NAME", value_delimiter = ',')]
    pub names: Vec<String>,
    #[command(flatten)]
    pub folder: detectors::Folder,
    #[command(flatten)]
    pub results: Results,
    /// Score the detections stored in the sessions instead of running the detectors: all that are stored when none is named.
    #[arg(long)]
    pub recorded: bool,
}

impl Detectors {
    /// Those that look at some sessions, as [`evaluated`].
    pub(super) fn evaluated(&self, sessions: &[Session]) -> Result<Vec<EvaluatedDetector>> {
        evaluated(sessions, &self.names, self.recorded, &self.folder, &self.results)
    }
}

/// Detectors that run, with the weights in some folders, or are played back from what the sessions store.
pub(super) fn evaluated(
    sessions: &[Session],
    names: &[String],
    is_recorded: bool,
    folder: &detectors::Folder,
    results: &Results,
) -> Result<Vec<EvaluatedDetector>> {
    let (names, programs) = results.programs(names)?;
    let stand_alone = (!programs.is_empty() || results.are_given()) && names.is_empty() && !is_recorded;
    let mut evaluated = if stand_alone {
        Vec::new()
    } else {
        networks(sessions, &names, is_recorded, folder)?
    };
    evaluated.extend(results.start(programs, sessions)?);
    evaluated.extend(results.open(sessions)?);
    check_names(evaluated.iter().map(|d| d.manifest.name.as_str()))?;
    Ok(evaluated)
}

/// Refuses two detectors of one name.
pub(super) fn check_names<'a>(names: impl Iterator<Item = &'a str>) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(format!(
                "two detectors are called {name}: give one of them another name"
            ));
        }
    }
    Ok(())
}

fn networks(
    sessions: &[Session],
    names: &[String],
    is_recorded: bool,
    folder: &detectors::Folder,
) -> Result<Vec<EvaluatedDetector>> {
    let folders = (!is_recorded).then(|| folder.folders()).transpose()?;
    let manifests = match (names, &folders) {
        ([], Some(folders)) => with_weights(sessions, folders)?,
        ([], None) => with_recordings(sessions)?,
        (names, _) => detectors::chosen(names)?,
    };
    Ok(evaluated_detectors(sessions, manifests, folders.as_ref())?)
}

fn with_weights(sessions: &[Session], folders: &WeightFolders) -> Result<Vec<Manifest>> {
    let (here, missing): (Vec<_>, Vec<_>) = Manifest::all()?.into_iter().partition(|m| folders.find(m).is_some());
    if here.is_empty() {
        let is_stored = |s: &Session| !Recording::names_in(&EvaluatedDetector::recordings_of(&s.folder)).is_empty();
        let stored = ", or score what the session stores with --recorded";
        let or = if sessions.iter().all(is_stored) { stored } else { "" };
        return Err(format!("no detector's weights are here: get them with `scaleproof detectors fetch`{or}").into());
    }
    if !missing.is_empty() {
        let names = listed(&missing);
        say!(
            "note: not scored, because their weights are not here: {names} (get them with `scaleproof detectors fetch`)"
        );
    }
    Ok(here)
}

fn with_recordings(sessions: &[Session]) -> Result<Vec<Manifest>> {
    let lacks = |m: &Manifest| {
        let mut folders = sessions.iter().map(|s| s.folder.as_path());
        folders.find(|folder| !Recording::is_in(&EvaluatedDetector::recordings_of(folder), &m.name))
    };
    let (stored, missing): (Vec<_>, Vec<_>) = Manifest::all()?.into_iter().partition(|m| lacks(m).is_none());
    let Some(without) = missing.first().and_then(lacks) else {
        return Ok(stored);
    };
    if stored.is_empty() {
        return Err(no_recordings(without).into());
    }
    say!(
        "note: not scored, because {} has no recordings of them: {} (run without --recorded, or store them with --record)",
        without.display(),
        listed(&missing)
    );
    Ok(stored)
}

fn no_recordings(session: &Path) -> String {
    let place = EvaluatedDetector::recordings_of(session);
    let folder = session.display();
    match Recording::names_in(&place).first() {
        Some(known) if Manifest::named(known).is_ok() => {
            "the sessions have no recordings of one detector in common: name one session, or run without --recorded"
                .into()
        }
        Some(own) => format!(
            "the recordings in {} are of detectors that do not ship with scaleproof: name their manifests, as in --detector {own}.toml",
            place.display()
        ),
        None => format!(
            "{folder} has no recordings: run without --recorded, or store them with `scaleproof score {} --record -o DIR`",
            quoted(&folder.to_string())
        ),
    }
}

fn listed(manifests: &[Manifest]) -> String {
    let names: Vec<&str> = manifests.iter().map(|m| m.name.as_str()).collect();
    names.join(", ")
}
