//! Comparisons on photos that are corrupted or defended, to find out whether an effect survives: those of a run, again at every severity of some
//! corruptions, or under some defences.

mod changes;
mod condition;
mod defences;
mod defended;
mod joined;
mod look;
mod result;

pub use condition::Defending;
pub use defences::{DefenceCard, Defences, DefendedRow, UNDEFENDED};
pub use defended::under_defences;
pub use result::{BASE_LOST, CorruptedRow, Held, Robustness, Survival};

use changes::changes;
use condition::Condition;

use super::caution::is_control;
use super::compare::{compare_set, pairs};
use super::corrupt::{Corruption, SEVERITIES};
use super::error::ScoreError;
use super::evaluated::{DetectionSource, EvaluatedDetector, runtime};
use super::observe::{Observer, Options};
use super::{NotScoredReason, ScoredPhoto, ScoredSet, Scores};
use scaleproof_core::workers;
use scaleproof_plot::distinct;
use scaleproof_session::Session;

/// A photo under each condition, or the reason why it has no detections there.
type Seen = Vec<Result<ScoredPhoto, NotScoredReason>>;

/// Runs the detectors on every photo of a run again, at each severity of each of these corruptions, and compares the variants with the base, and with
/// the random control where there is one. `None` where no photos pair. `on_photo` is called after each photo.
pub fn under_corruption(
    scores: &Scores,
    corruptions: &[Corruption],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Option<Robustness>, ScoreError> {
    let kinds = distinct(corruptions.iter().copied());
    let worse = kinds
        .iter()
        .flat_map(|kind| (1..=SEVERITIES).map(|severity| Condition::Worse(*kind, severity)));
    let again = Again::of(scores, worse, options, on_photo)?;
    again
        .map(|again| {
            let cautions = again.left_out(scores, "made worse");
            let changes = changes(scores, &again.photos, again.conditions.len(), options)?;
            Ok(together(&kinds, again.held, changes, cautions))
        })
        .transpose()
}

/// Photos of a run under some conditions, and its comparisons there. The first condition is no more than reduced.
struct Again {
    conditions: Vec<Condition>,
    photos: Vec<Seen>,
    held: Vec<Vec<Held>>,
}

impl Again {
    /// Runs the detectors and compares the variants; `None` where no photos pair.
    fn of(
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
        let photos = looked(scores, &conditions, options, on_photo)?;
        let held = per_condition(options, conditions.len(), |at| held(scores, &compared, &photos, at))?;
        Ok(Some(Self {
            conditions,
            photos,
            held,
        }))
    }

    /// Returns a sentence on the number of images without detections, and the first of them; none where all have some.
    fn left_out(&self, scores: &Scores, changed: &str) -> Vec<String> {
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
fn looked(
    scores: &Scores,
    conditions: &[Condition],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Vec<Seen>, ScoreError> {
    let (detectors, cache) = (&scores.detectors, options.cache.as_ref());
    let runtime = runtime(detectors)?;
    workers::map_over(
        options.threads,
        &scores.photos,
        || Observer::new((&[], options.tags), detectors, runtime, cache, scores.photos.len()),
        |observer, photo| look::at(observer, scores, photo, conditions),
        on_photo,
    )
}

/// Computes a value for each condition, by its number, in parallel.
fn per_condition<T: Send>(
    options: &Options,
    count: usize,
    of: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, ScoreError> {
    let places: Vec<usize> = (0..count).collect();
    workers::map_over(options.threads, &places, || Ok(()), |(), at| Ok(of(*at)), || {})
}

/// Checks before a run that its drops can be followed on photos that are changed: made worse, or defended.
pub fn check_changeable(
    sessions: &[Session],
    detectors: &[EvaluatedDetector],
    changed: &'static str,
) -> Result<(), ScoreError> {
    let photos = sessions.iter().flat_map(|s| &s.photos);
    let mut variants = photos.map(|photo| &photo.variant);
    if let Some(first) = variants.next()
        && variants.all(|variant| variant == first)
    {
        let variant = first.clone();
        return Err(ScoreError::OneVariant { variant, changed });
    }
    let takes_pixels = |detector: &&EvaluatedDetector| match &detector.source {
        DetectionSource::Live(_) | DetectionSource::Called(_) => true,
        DetectionSource::Program(program) => program.takes_pixels(),
        DetectionSource::Recorded(_) | DetectionSource::Outside(_) | DetectionSource::Elsewhere(_) => false,
    };
    let other = detectors.iter().find(|detector| !takes_pixels(detector));
    let refused = |other: &EvaluatedDetector| {
        let detector = other.manifest.name.clone();
        Err(ScoreError::NotCorruptible { detector, changed })
    };
    other.map_or(Ok(()), refused)
}

/// Returns the comparisons of one condition.
fn held(scores: &Scores, compared: &[(&str, &str)], photos: &[Seen], at: usize) -> Vec<Held> {
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
            all.extend(comparison.results.into_iter().map(|compared| Held::new(base, compared)));
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

/// Joins the rows of each corruption, the reduced photo before its severities. `compared`, `changes`: those of the reduced photo, then those of each
/// corruption's severities.
fn together(
    corruptions: &[Corruption],
    compared: Vec<Vec<Held>>,
    changes: Vec<Vec<Held>>,
    cautions: Vec<String>,
) -> Robustness {
    let mut compared = compared.into_iter();
    let clean = compared.next().unwrap_or_default();
    let (mut rows, mut survival) = (Vec::new(), Vec::new());
    let row = |kind: Corruption, severity: u8, held: Held| CorruptedRow {
        corruption: kind.name(),
        severity,
        amount: kind.amount(severity),
        held,
    };
    let steps = corruptions
        .iter()
        .flat_map(|kind| (1..=SEVERITIES).map(|severity| (*kind, severity)));
    let changes = steps.zip(changes.into_iter().skip(1));
    let changes =
        changes.flat_map(|((kind, severity), own)| own.into_iter().map(move |held| row(kind, severity, held)));
    let changes = changes.collect();
    for kind in corruptions {
        let start = rows.len();
        let row = |severity, held| row(*kind, severity, held);
        rows.extend(clean.iter().cloned().map(|held| row(0, held)));
        for (severity, worse) in (1..=SEVERITIES).zip(compared.by_ref()) {
            rows.extend(worse.into_iter().map(|held| row(severity, held)));
        }
        let own: &[CorruptedRow] = &rows[start..];
        let same = |first: &CorruptedRow| Survival::of(first, own.iter().filter(|row| row.held.is_as(&first.held)));
        survival.extend(own[..clean.len()].iter().map(same));
    }
    Robustness {
        rows,
        changes,
        survival,
        cautions,
    }
}
