//! Result of a run: the values of every photo, and the figures made of them.

use std::sync::OnceLock;

use crate::error::ScoreError;
use crate::evaluated::EvaluatedDetector;
use crate::figures::near_copies::{counted_once, mark_repeats};
use crate::figures::{
    AppliedSettings, BASE_VARIANT, Comparison, Criteria, Defences, GroupBy, NotScored, PhotoOutcome, Ranking,
    Robustness, ScoredPhoto, Summary, TexturePattern, caution, nothing_scored, summary,
};
use scaleproof_core::message::Message;
use scaleproof_plot::distinct;
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_session::Session;

/// Photos, the sessions they are from, and the detectors that were run on them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScoredSet<'a> {
    pub photos: &'a [ScoredPhoto],
    pub sessions: &'a [Session],
    pub detectors: &'a [EvaluatedDetector],
}

/// The result of a run.
#[derive(Debug)]
pub struct Scores {
    /// Sessions whose photos were scored.
    pub sessions: Vec<Session>,
    /// Detectors that were evaluated.
    pub detectors: Vec<EvaluatedDetector>,
    /// Scored photos, in the order of the sessions' lists.
    pub photos: Vec<ScoredPhoto>,
    /// Near-copies, which count with another photo.
    copies: Vec<ScoredPhoto>,
    /// Photos that were left out, and why.
    pub not_scored: Vec<NotScored>,
    /// Figures per detector and variant, detectors first.
    pub summaries: Vec<Summary>,
    /// The variant that drops are measured from.
    pub base: String,
    /// Variant that is a second round of the base, and no texture (`Scores::controlled_by`).
    pub control: Option<String>,
    /// Criteria of the figures; see [`Scores::judged_by`].
    pub criteria: Criteria,
    /// Cautions about the figures, as sentences.
    pub cautions: Vec<String>,
    /// Reasons why most photos of a session were left out, found by whoever opened its files; among the cautions.
    pub causes: Vec<String>,
    /// Version and build of the ONNX Runtime; `None` when every detector was played back.
    pub runtime: Option<String>,
    /// Tag detector.
    pub tags: TagDetectorChoice,
    /// The file that changed how photos are located or figures computed, if any.
    pub settings: Option<AppliedSettings>,
    /// Differences between variants on corrupted photos, on request.
    pub robustness: Option<Robustness>,
    /// Differences between variants on defended photos, on request.
    pub defences: Option<Defences>,
    /// Order of the variants against that in other sessions, on request.
    pub ranking: Option<Ranking>,
    /// Patterns of the textures, as far as they are known.
    pub patterns: Vec<TexturePattern>,
    /// Conditions that the summaries group photos by, besides directions and places.
    groups: Vec<GroupBy>,
    /// Each variant against the base, computed on first use; none where it cannot be.
    pub(crate) paired: OnceLock<Option<Comparison>>,
}

impl Scores {
    /// Computes the figures, by the default criteria.
    pub(crate) fn new(
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
        if photos.is_empty() {
            nothing_scored(not_scored.len(), not_scored.first())?;
        }
        let (mut photos, copies) = counted_once(photos);
        mark_repeats(&mut photos);
        not_scored.extend(copies.iter().map(|(copy, first)| NotScored {
            session: sessions[copy.session].name.clone(),
            file: copy.file.clone(),
            variant: copy.variant.clone(),
            reason: format!("it is a near-copy of {first} (same view and image), and counts with it, once"),
            near_copy_of: Some(first.clone()),
        }));
        let copies = copies.into_iter().map(|(copy, _)| copy).collect();
        let mut scores = Scores {
            cautions: Vec::new(),
            causes: Vec::new(),
            summaries: Vec::new(),
            base: BASE_VARIANT.to_owned(),
            control: None,
            criteria: Criteria::default(),
            runtime,
            sessions,
            detectors,
            photos,
            copies,
            not_scored,
            tags: TagDetectorChoice::default(),
            settings: None,
            robustness: None,
            defences: None,
            ranking: None,
            patterns: Vec::new(),
            groups: Vec::new(),
            paired: OnceLock::new(),
        };
        scores.sum_up();
        Ok(scores)
    }

    pub(crate) fn set(&self) -> ScoredSet<'_> {
        ScoredSet {
            photos: &self.photos,
            sessions: &self.sessions,
            detectors: &self.detectors,
        }
    }

    /// Returns every photo that was observed, near-copies too, in the order of the sessions' lists.
    pub(crate) fn all_photos(&self) -> Vec<&ScoredPhoto> {
        let mut all: Vec<&ScoredPhoto> = self.photos.iter().chain(&self.copies).collect();
        all.sort_by_key(|photo| photo.id);
        all
    }

    /// Lists near-copies among the photos again, for other programs that take all of them.
    pub fn with_copies(mut self) -> Scores {
        self.photos.append(&mut self.copies);
        self.photos.sort_by_key(|photo| photo.id);
        self.not_scored.retain(|photo| photo.near_copy_of.is_none());
        self.sum_up();
        self
    }

    pub(crate) fn sum_up(&mut self) {
        let basis = summary::Basis {
            bins: &self.sessions[0].scene.bins,
            ap: self.criteria.ap,
            base: &self.base,
            groups: &self.groups,
        };
        self.summaries = summary::summaries(&self.photos, &self.detectors, basis);
        // Causes for which most photos of a session were left out come first.
        self.cautions = self.causes.clone();
        self.cautions
            .extend(self.settings.iter().flat_map(AppliedSettings::cautions));
        self.cautions.extend(caution::cautions(
            &self.photos,
            &self.not_scored,
            &self.sessions,
            &self.detectors,
            &self.base,
            self.control.as_deref(),
            &self.summaries,
        ));
        self.paired = OnceLock::new();
    }

    /// Sets the file of settings that the run was made by; its cautions join the run's.
    pub fn made_by(mut self, settings: Option<AppliedSettings>) -> Scores {
        self.settings = settings;
        self.sum_up();
        self
    }

    /// Sets the causes for which most photos of a session were left out; they join the run's cautions.
    pub fn with_causes(mut self, causes: Vec<String>) -> Scores {
        self.causes = causes;
        self.sum_up();
        self
    }

    /// Judges the run's photos and detections by other criteria; nothing is detected again.
    pub fn judged_by(mut self, criteria: Criteria) -> Scores {
        let least = criteria.thresholds();
        for photo in &mut self.photos {
            photo.outcomes = PhotoOutcome::of_each(&self.detectors, &photo.detections, &photo.truth, least);
        }
        self.criteria = criteria;
        self.sum_up();
        self
    }

    /// Makes `base` the variant that the run's drops and cautions are measured from.
    pub fn against(mut self, base: &str) -> Scores {
        base.clone_into(&mut self.base);
        self.sum_up();
        self
    }

    /// Sets the conditions that photos are grouped by, and adds the figures of these groups to the run.
    ///
    /// # Errors
    /// A condition that no photo has, or that makes no table.
    pub fn grouped_by(mut self, groups: &[GroupBy]) -> Result<Scores, Message> {
        groups.iter().try_for_each(|group| group.check(&self.photos))?;
        self.groups = groups.to_vec();
        self.sum_up();
        Ok(self)
    }

    /// Returns the conditions that photos are grouped by.
    pub(crate) fn groups(&self) -> &[GroupBy] {
        &self.groups
    }

    /// Returns the variants in the order of the summaries: the base first.
    pub fn variants(&self) -> Vec<&str> {
        distinct(self.summaries.iter().map(|s| s.variant.as_str()))
    }

    /// Returns the figures of a detector on a variant.
    pub fn summary(&self, detector: &str, variant: &str) -> Option<&Summary> {
        let mut summaries = self.summaries.iter();
        summaries.find(|s| s.detector == detector && s.variant == variant)
    }

    /// Returns the title of the detector of this name.
    pub fn title<'a>(&'a self, detector: &'a str) -> &'a str {
        let found = self.detectors.iter().find(|d| d.manifest.name == detector);
        found.map_or(detector, |d| &d.manifest.title)
    }
}
