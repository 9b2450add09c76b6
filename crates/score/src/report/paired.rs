//! What the paired photos say of a drop, in words: it stands beside every drop.

use crate::score::{ClusteredBy, Compared, Difference, Finding, PlanCheck, Scores, paired, places_needed_among};
use scaleproof_core::spelling::{self, digits};
use scaleproof_core::statistics::Interval;

/// What the pairs of a variant and the base say of one detector; none where no photos pair.
pub(super) fn compared<'a>(scores: &'a Scores, detector: &str, variant: &str) -> Option<&'a Compared> {
    let mut results = paired(scores).iter();
    results.find(|r| r.detector == detector && r.variant == variant)
}

pub(super) fn in_words(finding: Finding) -> &'static str {
    match finding {
        Finding::Drop => "a drop",
        Finding::Rise => "a rise",
        Finding::NotAfterCorrection => "not shown after correction, by itself it would be",
        Finding::NoDifferenceShown => "no difference shown, one of 0.2 is excluded",
        Finding::TooFewPhotosToTell => "too few photos to tell",
    }
}

/// A finding in a few words, without its explanation.
pub fn briefly(finding: Finding) -> &'static str {
    in_words(finding).split(',').next().unwrap_or_default()
}

pub(super) fn is_shown(d: &Difference) -> bool {
    d.finding.is_shown()
}

/// `[0.38, 1.00]`, by what writes its numbers.
pub(super) fn ends(interval: Interval, number: impl Fn(f64) -> String) -> String {
    format!("[{}, {}]", number(interval.low), number(interval.high))
}

/// `[0.38, 1.00]` of the drop, by what writes its numbers.
pub(super) fn interval(d: &Difference, number: impl Fn(f64) -> String) -> Option<String> {
    d.interval_95.map(|i| ends(i, number))
}

/// `0.33 [−0.10, 0.60]`: the attack success rate; `–` where the base's figure is 0.
pub(super) fn asr(d: &Difference, number: impl Fn(f64) -> String) -> String {
    let interval = d.asr_interval_95.map(|i| format!(" {}", ends(i, &number)));
    let rate = d.asr.map(|asr| number(asr) + &interval.unwrap_or_default());
    rate.unwrap_or_else(|| "–".to_owned())
}

/// `8 pairs from 1 place × 8 bins`, how many clusters they are where that is not the product, and how many near-copies count with them.
pub(super) fn basis(r: &Compared) -> String {
    let grid = format!(
        "{} from {} × {}",
        spelling::count(r.pairs, "pair"),
        spelling::count(r.places, "place"),
        spelling::count(r.bins, "bin")
    );
    let basis = match r.clustered_by {
        ClusteredBy::Place => format!("{grid}, clustered by place"),
        ClusteredBy::PlaceAndBin if r.clusters == r.places * r.bins => grid,
        ClusteredBy::PlaceAndBin => format!("{grid}, {} of them taken", r.clusters),
    };
    match r.near_copies {
        0 => basis,
        n => format!(
            "{basis}, {} counted once",
            spelling::choose(n, "1 near-copy", &format!("{n} near-copies"))
        ),
    }
}

/// How many more places would show the drop of the hit rate that was seen, if it is the true one; none where it is shown already or there is none.
pub(super) fn more_photos(r: &Compared) -> Option<String> {
    let d = &r.hit_rate.rate;
    if is_shown(d) || d.drop <= 0.0 {
        return None;
    }
    let needed = places_needed_among(r.tests, r.bins, [d.base, d.drop.min(d.base)], POWER).ok();
    let (bins, drop) = (spelling::count(r.bins, "bin"), digits(d.drop, 2));
    let Some(needed) = needed else {
        return Some(format!("a drop as small as {drop} is beyond what photos can show"));
    };
    let places = spelling::count(needed, "place");
    Some(match needed.saturating_sub(r.places) {
        0 => format!("{places} of {bins} show a drop of {drop} with a chance of {POWER}: these happened not to"),
        more => format!(
            "if the true drop is the {drop} seen, {places} of these {bins} show it with a chance of {POWER}, and these photos are of {}: {}, {} photos",
            r.places,
            spelling::choose(more, "1 place more", &format!("{more} places more")),
            2 * more * r.bins
        ),
    })
}

/// `2 deviations`, or that there is none.
pub(super) fn deviations(plan: &PlanCheck) -> String {
    match plan.deviations.len() {
        0 => "kept, no deviation".into(),
        n => spelling::count(n, "deviation"),
    }
}

/// How often a drop shall be shown.
const POWER: f64 = 0.8;
