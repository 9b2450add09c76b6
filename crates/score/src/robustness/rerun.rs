//! The detectors of a run once more, on its photos under some conditions.

use crate::compare::{compare_set, pairs};
use crate::error::ScoreError;
use crate::evaluated::runtime;
use crate::figures::{PairedDifference, ScoredPhoto, ScoredSet, Scores, is_control};
use crate::observe::{Observer, Options};
use crate::robustness::changed_photo::detect_under;
use crate::robustness::{Condition, PhotoUnderConditions, per_condition};
use scaleproof_core::workers;
use scaleproof_plot::distinct;

/// Photos of a run under some conditions, and its comparisons there. The first condition is no more than reduced.
pub(crate) struct Rerun {
    pub conditions: Vec<Condition>,
    pub photos: Vec<PhotoUnderConditions>,
    pub differences: Vec<Vec<PairedDifference>>,
}

impl Rerun {
    /// Runs the detectors and compares the variants; `None` where no photos pair.
    pub fn of(
        scores: &Scores,
        changed: impl Iterator<Item = Condition>,
        options: &Options,
        on_photo: impl Fn() + Sync,
    ) -> Result<Option<Self>, ScoreError> {
        let compared = comparisons(scores);
        if compared.is_empty() {
            return Ok(None);
        }
        let conditions: Vec<Condition> = std::iter::once(Condition::Reduced).chain(changed).collect();
        let photos = detect_all(scores, &conditions, options, on_photo)?;
        let differences = per_condition(options, conditions.len(), |at| {
            differences(scores, &compared, &photos, at)
        })?;
        Ok(Some(Self {
            conditions,
            photos,
            differences,
        }))
    }

    /// Returns a sentence on the number of images without detections, and the first of them; none where all have some.
    pub fn left_out(&self, scores: &Scores, changed: &str) -> Vec<String> {
        let all = scores.photos.iter().zip(&self.photos).flat_map(|(photo, seen)| {
            let seen = seen.iter().zip(&self.conditions);
            seen.filter_map(move |(seen, condition)| Some((photo, condition, seen.as_ref().err()?)))
        });
        let all: Vec<_> = all.collect();
        let first = all.first().map(|(photo, condition, reason)| {
            format!(
                "{} of {} images {changed} are in no comparison; the first, {} at {}: {reason}",
                all.len(),
                self.photos.len() * self.conditions.len(),
                photo.file,
                condition.name()
            )
        });
        first.into_iter().collect()
    }
}

/// Runs the detectors on every photo of a run under every condition.
fn detect_all(
    scores: &Scores,
    conditions: &[Condition],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Vec<PhotoUnderConditions>, ScoreError> {
    let (detectors, cache) = (&scores.detectors, options.cache.as_ref());
    let runtime = runtime(detectors)?;
    workers::map_over(
        options.threads,
        &scores.photos,
        || Observer::new(&[], options.tags, detectors, runtime, cache, scores.photos.len()),
        |observer, photo| detect_under(observer, scores, photo, conditions),
        on_photo,
    )
}

/// Returns the comparisons of one condition.
pub(crate) fn differences(
    scores: &Scores,
    compared: &[(&str, &str)],
    photos: &[PhotoUnderConditions],
    at: usize,
) -> Vec<PairedDifference> {
    let own = photos.iter().filter_map(|photo| photo[at].as_ref().ok().cloned());
    let photos: Vec<ScoredPhoto> = own.collect();
    let set = ScoredSet {
        photos: &photos,
        ..scores.set()
    };
    let mut all = Vec::new();
    for (base, other) in compared {
        // Without pairs, because too many photos have no detections, the condition has no row.
        if let Ok(comparison) = compare_set(set, base, &[other], scores.criteria.ap) {
            all.extend(
                comparison
                    .results
                    .into_iter()
                    .map(|compared| PairedDifference::new(base, compared)),
            );
        }
    }
    all
}

/// Returns (base, variant) with pairs: every variant against the base, and every other pattern against the random ones.
fn comparisons<'a>(scores: &'a Scores) -> Vec<(&'a str, &'a str)> {
    let all = scores.photos.iter().map(|photo| photo.variant.as_str());
    let variants = distinct(all.filter(|variant| *variant != scores.base));
    let (controls, others): (Vec<&str>, Vec<&str>) = variants.iter().partition(|variant| is_control(variant));
    let against_base = variants.iter().map(|variant| (scores.base.as_str(), *variant));
    let with_others = |control: &'a str| others.iter().map(move |other| (control, *other));
    let all = against_base.chain(controls.iter().copied().flat_map(with_others));
    all.filter(|(base, other)| pairs(scores.set(), base, other)).collect()
}
