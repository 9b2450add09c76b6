//! The result of a run: what every photo showed, and the figures made of it.

use super::error::ScoreError;
use super::{
    BASE_VARIANT, Criteria, EvaluatedDetector, NotScored, PhotoOutcome, ScoredPhoto, Summary, caution, summary,
};
use crate::session::Session;

/// The result of a run.
#[derive(Debug)]
pub struct Scores {
    /// What was scored.
    pub sessions: Vec<Session>,
    /// By which detectors.
    pub detectors: Vec<EvaluatedDetector>,
    /// In the order of the sessions' lists.
    pub photos: Vec<ScoredPhoto>,
    /// Photos that were left out, and why.
    pub not_scored: Vec<NotScored>,
    /// Per detector and variant, detectors first.
    pub summaries: Vec<Summary>,
    /// What the figures depend on; see [`Scores::judged_by`].
    pub criteria: Criteria,
    /// What a reader must know before believing the figures, as sentences.
    pub cautions: Vec<String>,
    /// Version and build of the ONNX Runtime; `None` when every detector was played back.
    pub runtime: Option<String>,
}

impl Scores {
    /// Puts the figures together, by the default criteria.
    pub(super) fn new(
        sessions: Vec<Session>,
        detectors: Vec<EvaluatedDetector>,
        results: Vec<Result<ScoredPhoto, NotScored>>,
        runtime: Option<String>,
    ) -> Result<Scores, ScoreError> {
        let (mut photos, mut not_scored) = (Vec::new(), Vec::new());
        for result in results {
            match result {
                Ok(photo) => photos.push(photo),
                Err(reason) => not_scored.push(reason),
            }
        }
        if let (true, Some(first)) = (photos.is_empty(), not_scored.first()) {
            let (file, reason) = (first.file.clone(), first.reason.clone());
            return Err(ScoreError::NothingScored {
                photos: not_scored.len(),
                file,
                reason,
            });
        }
        let criteria = Criteria::default();
        Ok(Scores {
            cautions: caution::cautions(&photos, &not_scored, &sessions, &detectors),
            summaries: summary::summaries(&photos, &detectors, &sessions[0].scene.bins, criteria.ap),
            criteria,
            runtime,
            sessions,
            detectors,
            photos,
            not_scored,
        })
    }

    /// The same photos and detections under other criteria; nothing is detected again.
    pub fn judged_by(mut self, criteria: Criteria) -> Scores {
        for photo in &mut self.photos {
            let judged = self.detectors.iter().zip(&photo.detections);
            let confidence = criteria.hit_confidence;
            photo.outcomes = judged
                .map(|(c, found)| PhotoOutcome::of(found, &photo.truth, &c.counted, confidence))
                .collect();
        }
        let bins = &self.sessions[0].scene.bins;
        self.summaries = summary::summaries(&self.photos, &self.detectors, bins, criteria.ap);
        self.criteria = criteria;
        self
    }

    /// The same run, whose cautions speak of drops from `base`.
    pub fn against(mut self, base: &str) -> Scores {
        if base != BASE_VARIANT {
            let of_usual = caution::about_base(&self.photos, BASE_VARIANT);
            self.cautions.retain(|caution| !of_usual.contains(caution));
            self.cautions.splice(0..0, caution::about_base(&self.photos, base));
        }
        self
    }

    /// What people call a detector of this name.
    pub fn title<'a>(&'a self, detector: &'a str) -> &'a str {
        let found = self.detectors.iter().find(|d| d.manifest.name == detector);
        found.map_or(detector, |d| &d.manifest.title)
    }
}
