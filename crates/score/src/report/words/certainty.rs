//! Sentences on the certainty of a comparison: how its findings were decided, and bounds for rates without an interval.

use crate::figures::{Compared, Difference};
use crate::report::Findings;
use crate::report::words::paired as shown;
use scaleproof_core::spelling::{self, digits};
use scaleproof_core::statistics::{FEWEST_CLUSTERS, wilson_95};
use scaleproof_plot::distinct;

/// Returns the tests of a comparison in words: `5 detectors × 2 textures`.
pub(crate) fn family(results: &[Compared]) -> String {
    let tested = || results.iter().filter(|r| r.finding.is_some());
    let [detectors, textures] = [
        distinct(tested().map(|r| &r.detector)).len(),
        distinct(tested().map(|r| &r.variant)).len(),
    ];
    let of = [
        spelling::count(detectors, "detector"),
        spelling::count(textures, "texture"),
    ];
    of.join(" × ")
}

/// Returns a sentence on how effects are decided, with the p value of each; `None` where nothing was tested, or by a
/// sequential test.
pub(crate) fn tested(findings: Findings) -> Option<String> {
    let results = findings.results;
    let each = |r: &Compared| {
        let is_only = results.iter().all(|other| other.variant == r.variant);
        let texture = if is_only {
            String::new()
        } else {
            format!(" on {}", r.variant)
        };
        let finding = r.finding?;
        let [confidence, hits] = [finding.confidence_p, finding.hit_rate_p].map(|p| digits(p, 3));
        Some(format!(
            "{}{texture} {confidence}, {hits}",
            findings.scores.title(&r.detector)
        ))
    };
    let all: Vec<String> = results.iter().filter_map(each).collect();
    (!all.is_empty() && !findings.is_sequential).then(|| {
        format!(
            "Decided by the mean confidence ({}): the signs of the paired differences are flipped view by view, for the detectors of a texture together \
             (step-down by the largest statistic, Westfall and Young 1993); the textures share 5 %. The hit rate is decided in the same way, with 5 % of its own. \
             Intervals are 95 % each, uncorrected. p of the confidence, of the hit rate: {}",
            family(results),
            all.join("; ")
        )
    })
}

/// Returns the attack success rate and its interval, or the reason why it has none: `0.33` and `[−0.10, 0.60]`; `–` alone where the base's figure is
/// 0.
pub(crate) fn asr(r: &Compared, d: &Difference, number: impl Fn(f64) -> String) -> (String, Option<String>) {
    let rate = shown::asr(d, number);
    match rate.split_once(' ') {
        Some((rate, interval)) => (rate.to_owned(), Some(interval.to_owned())),
        None => (rate, d.asr.map(|_| without_interval(r, d))),
    }
}

/// Returns the attack success rate and its interval, or in brackets the reason why it has none, as one text.
pub(crate) fn asr_text(r: &Compared, d: &Difference, number: impl Fn(f64) -> String) -> String {
    match asr(r, d, number) {
        (rate, None) => rate,
        (rate, Some(interval)) if interval.starts_with('[') => format!("{rate} {interval}"),
        (rate, Some(why)) => format!("{rate} ({why})"),
    }
}

/// Returns the reason why an attack success rate has no interval and, where no photo is hit, a Wilson bound: 1.00 of few photos is not certain.
pub(crate) fn without_interval(r: &Compared, d: &Difference) -> String {
    if r.clusters < FEWEST_CLUSTERS {
        return format!("no interval: fewer than {FEWEST_CLUSTERS} clusters");
    }
    if d.other > 0.0 && d.interval_95.is_some() {
        return "no interval: too many resamples do not find the base".to_owned();
    }
    let is_never_hit = d.other == 0.0 && r.hit_rate.rate.other == 0.0;
    // Photos of one cluster are not independent: the bound counts clusters.
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
