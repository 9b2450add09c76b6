//! How sure a comparison is as a whole: how many findings were tested, and what a rate without an interval leaves open.

use serde::Serialize;

use super::paired as shown;
use crate::score::{Compared, Difference, Scores};
use scaleproof_core::spelling::{self, digits};
use scaleproof_core::statistics::{FEWEST_CLUSTERS, holm, wilson_95};

/// Hit rate, mean confidence and AP of each detector and texture have a finding each.
pub(super) const FIGURES: usize = 3;

/// McNemar's p of the hit rate of one detector and texture, corrected by Holm over the detectors.
#[derive(Serialize, schemars::JsonSchema)]
pub(super) struct Corrected<'a> {
    pub detector: &'a str,
    pub variant: &'a str,
    pub holm_p: f64,
}

/// Of each result, in their order; the detectors of a texture are corrected together.
pub(super) fn over_detectors(results: &[Compared]) -> Vec<Corrected<'_>> {
    let textures = results.chunk_by(|a, b| a.variant == b.variant);
    let corrected = textures.flat_map(|own| {
        let p: Vec<f64> = own.iter().map(|r| r.hit_rate.mcnemar_p).collect();
        own.iter().zip(holm(&p)).map(|(r, holm_p)| Corrected {
            detector: &r.detector,
            variant: &r.variant,
            holm_p,
        })
    });
    corrected.collect()
}

/// Sentences: how many findings stand beside each other, and what of the hit rates is left when their number is corrected for.
pub(super) fn tested(scores: &Scores, results: &[Compared]) -> Option<String> {
    let corrected = over_detectors(results);
    let detectors = scores.detectors.len();
    if results.is_empty() {
        return None;
    }
    let each = |(c, r): (&Corrected, &Compared)| {
        let is_only = results.iter().all(|other| other.variant == c.variant);
        let texture = if is_only {
            String::new()
        } else {
            format!(" on {}", c.variant)
        };
        let p = digits(r.hit_rate.mcnemar_p, 3);
        format!("{}{texture} {p} → {}", scores.title(c.detector), digits(c.holm_p, 3))
    };
    let all: Vec<String> = corrected.iter().zip(results).map(each).collect();
    Some(format!(
        "{} are tested here at 5 % each, hit rate, mean confidence and AP@0.5 of each detector and texture, without correction for their number: where \
         nothing differs, up to one in twenty is still shown. McNemar's p of the hit rate, and corrected over {} (Holm): {}",
        spelling::count(FIGURES * results.len(), "finding"),
        spelling::count(detectors, "detector"),
        all.join("; ")
    ))
}

/// `0.33` and `[−0.10, 0.60]`: the attack success rate, and its interval or why it has none; `–` alone where the base's figure is 0.
pub(super) fn asr(r: &Compared, d: &Difference, number: impl Fn(f64) -> String) -> (String, Option<String>) {
    let rate = shown::asr(d, number);
    match rate.split_once(' ') {
        Some((rate, interval)) => (rate.to_owned(), Some(interval.to_owned())),
        None => (rate, d.asr.map(|_| without_interval(r, d))),
    }
}

/// The attack success rate and its interval, or in brackets why it has none, as one text.
pub(super) fn asr_text(r: &Compared, d: &Difference, number: impl Fn(f64) -> String) -> String {
    match asr(r, d, number) {
        (rate, None) => rate,
        (rate, Some(interval)) if interval.starts_with('[') => format!("{rate} {interval}"),
        (rate, Some(why)) => format!("{rate} ({why})"),
    }
}

/// Why an attack success rate has no interval, and what is known all the same: 1.00 of few photos is not certain.
pub(super) fn without_interval(r: &Compared, d: &Difference) -> String {
    if r.clusters < FEWEST_CLUSTERS {
        return format!("no interval: fewer than {FEWEST_CLUSTERS} clusters");
    }
    if d.other > 0.0 && d.interval_95.is_some() {
        return "no interval: too many resamples do not find the base".to_owned();
    }
    let is_never_hit = d.other == 0.0 && r.hit_rate.rate.other == 0.0;
    // The photos of one cluster are no evidence of their own.
    let bound = wilson_95(0, r.clusters).filter(|_| is_never_hit);
    let is_each = r.clusters == r.pairs;
    let clusters = if is_each {
        String::new()
    } else {
        format!(" in {} clusters", r.clusters)
    };
    let said = |(_, high)| format!("; 0 of {}{clusters} hit, Wilson up to {}", r.pairs, digits(high, 2));
    let bound = bound.map(said).unwrap_or_default();
    format!("no interval: all resamples agree{bound}")
}
