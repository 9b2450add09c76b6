//! Whether an effect survives when photos get worse: the comparisons of a run, again at every severity of some corruptions.

mod look;
mod result;

pub(crate) use result::{CorruptedRow, Robustness, Survival};

use super::caution::is_control;
use super::compare::{Finding, compare_set};
use super::corrupt::{Corruption, SEVERITIES};
use super::error::ScoreError;
use super::evaluated::{DetectionSource, EvaluatedDetector, runtime};
use super::observe::{Observer, Options};
use super::{ScoredPhoto, ScoredSet, Scores};
use crate::session::Session;
use crate::workers;

/// A corruption at a severity; without one the photo as it is.
type Condition = Option<(Corruption, u8)>;

/// Looks at every photo of a run again, at each severity of each of these corruptions, and compares the variants with the base, and with the random
/// control where there is one. `on_photo` is called after each photo.
///
/// # Errors
/// Detections that were not made here, photos that have changed, detectors that fail.
pub(crate) fn under_corruption(
    scores: &Scores,
    corruptions: &[Corruption],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Robustness, ScoreError> {
    let mut asked: Vec<Corruption> = Vec::new();
    for kind in corruptions {
        if !asked.contains(kind) {
            asked.push(*kind);
        }
    }
    let worse = asked
        .iter()
        .flat_map(|kind| (1..=SEVERITIES).map(|severity| Some((*kind, severity))));
    let conditions: Vec<Condition> = std::iter::once(None).chain(worse).collect();
    let runtime = runtime(&scores.detectors)?;
    let photos = workers::map_over(
        options.threads,
        &scores.photos,
        || {
            Observer::new(
                &[],
                &scores.detectors,
                runtime,
                options.cache.as_ref(),
                scores.photos.len(),
            )
        },
        |observer, photo| look::at(observer, scores, photo, &conditions),
        on_photo,
    )?;
    let of_condition = |at: usize| {
        photos
            .iter()
            .map(|photo: &Vec<ScoredPhoto>| photo[at].clone())
            .collect()
    };
    let compared: Vec<Vec<CorruptedRow>> = conditions
        .iter()
        .enumerate()
        .map(|(at, condition)| rows(scores, of_condition(at), *condition))
        .collect();
    Ok(together(&asked, compared))
}

/// Finds out before a run whether its drops can be followed on photos that are made worse.
///
/// # Errors
/// One texture alone; a detector that does not look at pixels here: stored detections say nothing of other images.
pub(crate) fn check_corruptible(sessions: &[Session], detectors: &[EvaluatedDetector]) -> Result<(), ScoreError> {
    let mut variants = sessions
        .iter()
        .flat_map(|s| s.photos.iter().map(|photo| &photo.variant));
    if let Some(first) = variants.next()
        && variants.all(|variant| variant == first)
    {
        let variant = first.clone();
        return Err(ScoreError::OneVariant { variant });
    }
    let takes_pixels = |detector: &&EvaluatedDetector| match &detector.source {
        DetectionSource::Live(_) => true,
        DetectionSource::Program(program) => program.takes_pixels(),
        DetectionSource::Recorded(_) | DetectionSource::Outside(_) | DetectionSource::Elsewhere(_) => false,
    };
    match detectors.iter().find(|detector| !takes_pixels(detector)) {
        None => Ok(()),
        Some(other) => Err(ScoreError::NotCorruptible {
            detector: other.manifest.name.clone(),
        }),
    }
}

/// The comparisons of one condition; its corruption's name is filled in for the photo as it is by [`together`].
fn rows(scores: &Scores, photos: Vec<ScoredPhoto>, condition: Condition) -> Vec<CorruptedRow> {
    let set = ScoredSet {
        photos: &photos,
        ..scores.set()
    };
    let (corruption, severity, amount) = match condition {
        None => ("", 0, "0".to_owned()),
        Some((kind, severity)) => (kind.name(), severity, kind.amount(severity)),
    };
    let compared = comparisons(scores);
    let compared = compared.iter().filter_map(|(base, other)| {
        // What cannot be paired is said by the comparison of the run itself.
        let comparison = compare_set(set, base, &[other], scores.criteria.ap).ok()?;
        Some((comparison.base, comparison.results))
    });
    let row = |(base, results): (String, Vec<super::Compared>)| {
        let amount = amount.clone();
        results.into_iter().map(move |compared| CorruptedRow {
            corruption,
            severity,
            amount: amount.clone(),
            base: base.clone(),
            variant: compared.variant,
            detector: compared.detector,
            pairs: compared.pairs,
            ap50: compared.ap50,
            hit_rate: compared.hit_rate.rate,
            mean_confidence: compared.mean_confidence,
        })
    };
    compared.flat_map(row).collect()
}

/// (base, variant): every variant against the base, and every other pattern against the random ones.
fn comparisons(scores: &Scores) -> Vec<(String, String)> {
    let mut variants: Vec<&str> = Vec::new();
    for photo in &scores.photos {
        if photo.variant != scores.base && !variants.contains(&photo.variant.as_str()) {
            variants.push(&photo.variant);
        }
    }
    let (controls, others): (Vec<&str>, Vec<&str>) = variants.iter().partition(|variant| is_control(variant));
    let against_base = variants.iter().map(|variant| (scores.base.as_str(), *variant));
    let against_controls = controls
        .iter()
        .flat_map(|control| others.iter().map(|other| (*control, *other)));
    let all = against_base.chain(against_controls);
    all.map(|(base, other)| (base.to_owned(), other.to_owned())).collect()
}

/// Each corruption with the photo as it is before its severities. `compared`: those of the photo as it is, then those of each corruption's severities.
fn together(corruptions: &[Corruption], compared: Vec<Vec<CorruptedRow>>) -> Robustness {
    let mut compared = compared.into_iter();
    let clean = compared.next().unwrap_or_default();
    let mut rows = Vec::new();
    let mut survival = Vec::new();
    for kind in corruptions {
        let start = rows.len();
        let name = kind.name();
        rows.extend(clean.iter().map(|row| CorruptedRow {
            corruption: name,
            ..row.clone()
        }));
        rows.extend(compared.by_ref().take(usize::from(SEVERITIES)).flatten());
        let own: &[CorruptedRow] = &rows[start..];
        survival.extend(own[..clean.len()].iter().map(|first| survival_of(first, own)));
    }
    Robustness { rows, survival }
}

/// `own`: the rows of the corruption of `first`, in the order of severities.
fn survival_of(first: &CorruptedRow, own: &[CorruptedRow]) -> Survival {
    let is_same = |row: &&CorruptedRow| {
        (&row.base, &row.variant, &row.detector) == (&first.base, &first.variant, &first.detector)
    };
    let not_shown = own.iter().filter(is_same).find(|row| row.ap50.finding != Finding::Drop);
    Survival {
        corruption: first.corruption,
        base: first.base.clone(),
        variant: first.variant.clone(),
        detector: first.detector.clone(),
        not_shown_from: not_shown.map(|row| row.severity),
    }
}
