//! Whether an effect survives when photos get worse: the comparisons of a run, again at every severity of some corruptions.

mod look;
mod result;

pub use result::{BASE_LOST, CorruptedRow, Robustness, Survival};

use super::caution::is_control;
use super::compare::{compare_set, decide, pairs};
use super::corrupt::{Corruption, SEVERITIES};
use super::error::ScoreError;
use super::evaluated::{DetectionSource, EvaluatedDetector, runtime};
use super::observe::{Observer, Options};
use super::{NotScoredReason, ScoredPhoto, ScoredSet, Scores};
use scaleproof_core::workers;
use scaleproof_plot::distinct;
use scaleproof_session::session::Session;

/// A corruption at a severity; without one the photo no worse than reduced.
type Condition = Option<(Corruption, u8)>;

/// A photo under each condition, or why a detector says nothing of it there.
type Seen = Vec<Result<ScoredPhoto, NotScoredReason>>;

/// Looks at every photo of a run again, at each severity of each of these corruptions, and compares the variants with the base, and with the random
/// control where there is one. `None` where no photos pair. `on_photo` is called after each photo.
pub fn under_corruption(
    scores: &Scores,
    corruptions: &[Corruption],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Option<Robustness>, ScoreError> {
    let compared = comparisons(scores);
    if compared.is_empty() {
        return Ok(None);
    }
    let kinds = distinct(corruptions.iter().copied());
    let worse = kinds
        .iter()
        .flat_map(|kind| (1..=SEVERITIES).map(|severity| Some((*kind, severity))));
    let conditions: Vec<Condition> = std::iter::once(None).chain(worse).collect();
    let (detectors, cache) = (&scores.detectors, options.cache.as_ref());
    let runtime = runtime(detectors)?;
    let photos: Vec<Seen> = workers::map_over(
        options.threads,
        &scores.photos,
        || Observer::new((&[], options.tags), detectors, runtime, cache, scores.photos.len()),
        |observer, photo| look::at(observer, scores, photo, &conditions),
        on_photo,
    )?;
    let places: Vec<usize> = (0..conditions.len()).collect();
    let of_each = workers::map_over(
        options.threads,
        &places,
        || Ok(()),
        |(), at| -> Result<_, ScoreError> {
            let own = photos.iter().filter_map(|photo| photo[*at].as_ref().ok().cloned());
            Ok(rows(scores, &compared, own.collect(), conditions[*at]))
        },
        || {},
    )?;
    let cautions = left_out(scores, &photos, &conditions);
    Ok(Some(together(&kinds, of_each, cautions)))
}

/// Finds out before a run whether its drops can be followed on photos that are made worse.
pub fn check_corruptible(sessions: &[Session], detectors: &[EvaluatedDetector]) -> Result<(), ScoreError> {
    let photos = sessions.iter().flat_map(|s| &s.photos);
    let mut variants = photos.map(|photo| &photo.variant);
    if let Some(first) = variants.next()
        && variants.all(|variant| variant == first)
    {
        let variant = first.clone();
        return Err(ScoreError::OneVariant { variant });
    }
    let takes_pixels = |detector: &&EvaluatedDetector| match &detector.source {
        DetectionSource::Live(_) | DetectionSource::Called(_) => true,
        DetectionSource::Program(program) => program.takes_pixels(),
        DetectionSource::Recorded(_) | DetectionSource::Outside(_) | DetectionSource::Elsewhere(_) => false,
    };
    let other = detectors.iter().find(|detector| !takes_pixels(detector));
    let refused = |other: &EvaluatedDetector| {
        let detector = other.manifest.name.clone();
        Err(ScoreError::NotCorruptible { detector })
    };
    other.map_or(Ok(()), refused)
}

/// The comparisons of one condition; the corruption of the reduced photo is filled in by [`together`].
fn rows(
    scores: &Scores,
    compared: &[(&str, &str)],
    photos: Vec<ScoredPhoto>,
    condition: Condition,
) -> Vec<CorruptedRow> {
    let set = ScoredSet {
        photos: &photos,
        ..scores.set()
    };
    let (corruption, severity, amount) = match condition {
        None => ("", 0, String::new()),
        Some((kind, severity)) => (kind.name(), severity, kind.amount(severity)),
    };
    let row = |(base, compared): (&str, super::Compared)| CorruptedRow {
        corruption,
        severity,
        amount: amount.clone(),
        base: base.to_owned(),
        variant: compared.variant,
        detector: compared.detector,
        pairs: compared.pairs,
        ap50: compared.ap50,
        hit_rate: compared.hit_rate.rate,
        mean_confidence: compared.mean_confidence,
    };
    let mut all = Vec::new();
    for (base, other) in compared {
        // Without pairs, because detectors said nothing of so many photos, the severity has no row.
        if let Ok(comparison) = compare_set(set, base, &[other], scores.criteria.ap, None) {
            all.extend(comparison.results.into_iter().map(|compared| (*base, compared)));
        }
    }
    decide(&mut all.iter_mut().map(|(_, compared)| compared).collect::<Vec<_>>());
    all.into_iter().map(row).collect()
}

/// (base, variant) with pairs: every variant against the base, and every other pattern against the random ones.
fn comparisons<'a>(scores: &'a Scores) -> Vec<(&'a str, &'a str)> {
    let all = scores.photos.iter().map(|photo| photo.variant.as_str());
    let variants = distinct(all.filter(|variant| *variant != scores.base));
    let (controls, others): (Vec<&str>, Vec<&str>) = variants.iter().partition(|variant| is_control(variant));
    let against_base = variants.iter().map(|variant| (scores.base.as_str(), *variant));
    let with_others = |control: &'a str| others.iter().map(move |other| (control, *other));
    let all = against_base.chain(controls.iter().copied().flat_map(with_others));
    all.filter(|(base, other)| pairs(scores.set(), base, other)).collect()
}

/// How many images a detector said nothing of, and the first.
fn left_out(scores: &Scores, photos: &[Seen], conditions: &[Condition]) -> Vec<String> {
    let all = scores.photos.iter().zip(photos).flat_map(|(photo, seen)| {
        let seen = seen.iter().zip(conditions);
        seen.filter_map(move |(seen, condition)| Some((photo, condition, seen.as_ref().err()?)))
    });
    let all: Vec<_> = all.collect();
    let first = all.first().map(|(photo, condition, reason)| {
        let name = condition.map_or("no corruption".to_owned(), |(kind, s)| format!("{} {s}", kind.name()));
        format!(
            "{} of {} images made worse are in no comparison; the first, {} at {name}: {reason}",
            all.len(),
            photos.len() * conditions.len(),
            photo.file
        )
    });
    first.into_iter().collect()
}

/// Each corruption with the reduced photo before its severities. `compared`: those of the reduced photo, then those of each corruption's severities.
fn together(corruptions: &[Corruption], compared: Vec<Vec<CorruptedRow>>, cautions: Vec<String>) -> Robustness {
    let mut compared = compared.into_iter();
    let clean = compared.next().unwrap_or_default();
    let (mut rows, mut survival) = (Vec::new(), Vec::new());
    for kind in corruptions {
        let start = rows.len();
        let corruption = kind.name();
        rows.extend(clean.iter().map(|row| CorruptedRow {
            corruption,
            ..row.clone()
        }));
        rows.extend(compared.by_ref().take(usize::from(SEVERITIES)).flatten());
        let of = |row: &CorruptedRow| (row.base.clone(), row.variant.clone(), row.detector.clone());
        // What is not shown of the photos as they are is not asked of worse ones, which are many.
        for row in &mut rows[start + clean.len()..] {
            let is_clean = |other: &&CorruptedRow| of(other) == of(row) && other.ap50.finding.is_shown();
            if !clean.iter().any(|other| is_clean(&other)) {
                let figures = [&mut row.ap50, &mut row.hit_rate, &mut row.mean_confidence];
                figures.into_iter().for_each(|d| d.finding = d.finding.undone());
            }
        }
        let own: &[CorruptedRow] = &rows[start..];
        let same = |first: &CorruptedRow| Survival::of(first, own.iter().filter(|row| of(row) == of(first)));
        survival.extend(own[..clean.len()].iter().map(same));
    }
    Robustness {
        rows,
        survival,
        cautions,
    }
}
