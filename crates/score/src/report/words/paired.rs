//! Sentences about the drop on paired photos: they stand beside every drop.

use crate::figures::{BASE_VARIANT, Compared, Difference, Effect, Finding, PlanCheck};
use crate::report::words::numbers::{bracketed, p_value};
use scaleproof_core::spelling::{self, digits};

/// Returns an effect in a word or two.
pub fn briefly(effect: Effect) -> &'static str {
    match effect {
        Effect::Hides => "hides",
        Effect::Weakens => "weakens",
        Effect::Strengthens => "strengthens",
        Effect::NothingShown => "nothing shown",
        Effect::BaseUnseen => "cannot tell",
    }
}

/// Returns the effect on a detector in a word or two, or `not tested`.
pub(crate) fn effect_word(r: &Compared) -> &'static str {
    r.finding.map_or(NOT_TESTED, |finding| briefly(finding.effect))
}

const NOT_TESTED: &str = "not tested";

/// Returns an effect with its p value and its limits: `weakens, p 0.008`; `nothing shown, p 0.180; a drop of 0.31 would have been (chance 0.8)`.
pub(crate) fn effect_sentence(r: &Compared, base: &str) -> String {
    let Some(finding) = r.finding else {
        return NOT_TESTED.to_owned();
    };
    let effect = briefly(finding.effect);
    let p = format!("p {}", p_value(finding.confidence_p));
    let beside = match finding.effect {
        Effect::BaseUnseen => return format!("{effect}: it does not see {}", named_base(base)),
        Effect::NothingShown => open(r),
        Effect::Hides | Effect::Weakens | Effect::Strengthens => elsewhere(r),
    };
    let parts = [Some(format!("{effect}, {p}")), held_back(&finding), beside];
    parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// Returns `the plain model`, or another base by its name.
pub(crate) fn named_base(base: &str) -> String {
    match base {
        BASE_VARIANT => "the plain model".to_owned(),
        other => format!("“{other}”"),
    }
}

/// Returns a sentence on the effect that is withheld because of the control.
fn held_back(finding: &Finding) -> Option<String> {
    let withheld = finding.withheld_by_control?;
    Some(if finding.effect.is_shown() {
        format!(
            "“{}” is withheld: the control round moves the hits of this detector by as much",
            briefly(withheld)
        )
    } else {
        "withheld: the control round moves this detector by as much".to_owned()
    })
}

/// Returns the reason why nothing is shown: repeated photos, missing views, or the least drop that would have been shown.
fn open(r: &Compared) -> Option<String> {
    let finding = r.finding?;
    if finding.withheld_for_copies {
        return Some("withheld, as it rests on photos that show the same moment again".to_owned());
    }
    let drop = finding.drop_shown_from.map(|drop| digits(drop, 2));
    match finding.views_missing {
        0 => drop.map(|drop| format!("a drop of {drop} would have been shown with a chance of 0.8")),
        more => Some(format!(
            "{} more are needed before anything can be",
            spelling::count(more, "view")
        )),
    }
}

/// Returns the second finding in words, the one for places like these.
fn elsewhere(r: &Compared) -> Option<String> {
    let second = r.finding?.in_places_like_these?;
    Some(match second.places_missing {
        0 if second.effect.is_shown() => {
            let p = p_value(second.confidence_p);
            format!("in places like these, too: {}, p {p}", briefly(second.effect))
        }
        0 => format!(
            "in places like these it is not shown, p {}",
            p_value(second.confidence_p)
        ),
        more => format!(
            "for places like these {} missing",
            spelling::choose(more, "1 place is", &format!("{more} places are"))
        ),
    })
}

/// Test of whether an effect is withheld for a reason, and the reason.
pub(crate) type Withheld = (fn(&Compared) -> bool, &'static str);

pub(crate) const WITHHELD: [Withheld; 2] = [
    (
        |r| r.finding.is_some_and(|finding| finding.withheld_for_copies),
        "it rests on photos that show the same moment again",
    ),
    (
        |r| r.finding.is_some_and(|finding| finding.withheld_by_control.is_some()),
        "a second plain round, the control, moved the detector by as much",
    ),
];

/// Returns true if an effect was found but is withheld.
pub(crate) fn is_withheld(r: &Compared) -> bool {
    r.effect() == Effect::NothingShown && WITHHELD.iter().any(|(is_so, _)| is_so(r))
}

/// Returns true if a change of the mean confidence is shown.
pub(crate) fn is_confidence_shown(r: &Compared) -> bool {
    r.effect().is_shown()
}

/// Returns true if the hit rate is shown to fall, which is tested only where the confidence falls.
pub(crate) fn is_hit_rate_shown(r: &Compared) -> bool {
    let falls = |finding: &Finding| {
        let is_withheld = finding.withheld_by_control.is_some();
        let is_reached = finding.hit_rate_p <= finding.hit_rate_level;
        matches!(finding.effect, Effect::Hides | Effect::Weakens) && is_reached && !is_withheld
    };
    r.hit_rate.rate.drop > 0.0 && r.finding.as_ref().is_some_and(falls)
}

/// Writes the interval of the drop as `[0.38, 1.00]`, its numbers by `number`.
pub(crate) fn interval(d: &Difference, number: impl Fn(f64) -> String) -> Option<String> {
    d.interval_95.map(|i| bracketed(i, number))
}

/// Writes the attack success rate as `0.33 [−0.10, 0.60]`; `–` where the base's figure is 0.
pub(crate) fn asr(d: &Difference, number: impl Fn(f64) -> String) -> String {
    let interval = d.asr_interval_95.map(|i| format!(" {}", bracketed(i, &number)));
    let rate = d.asr.map(|asr| number(asr) + &interval.unwrap_or_default());
    rate.unwrap_or_else(|| "–".to_owned())
}

/// Returns the pairs of a comparison: `8 pairs from 1 place × 8 bins`, with the number of views taken where some are missing, and of near-copies
/// counted once.
pub(crate) fn basis(r: &Compared) -> String {
    let grid = format!(
        "{} from {} × {}",
        spelling::count(r.pairs, "pair"),
        spelling::count(r.places, "place"),
        spelling::count(r.bins, "bin")
    );
    let basis = if r.clusters == r.places * r.bins {
        grid
    } else {
        format!("{grid}, {} of them taken", r.clusters)
    };
    match r.near_copies {
        0 => basis,
        n => format!(
            "{basis}, {} counted once",
            spelling::choose(n, "1 near-copy", &format!("{n} near-copies"))
        ),
    }
}

/// Returns a sentence on the number of views that would show the observed drop of the mean confidence, if it is the true one; `None` where an effect
/// is shown or there is no drop. Intervals narrow with the square root of the number of views.
pub(crate) fn more_photos(r: &Compared) -> Option<String> {
    let drop = r.mean_confidence.drop;
    let shown_from = r.finding?.drop_shown_from.filter(|_| drop > 0.005)?;
    let seen = digits(drop, 2);
    let needed = (r.clusters as f64 * (shown_from / drop).powi(2)).ceil();
    if needed > MOST_VIEWS {
        return Some(format!("a drop as small as {seen} is beyond what photos can show"));
    }
    let more = (needed as usize).saturating_sub(r.clusters);
    Some(match more {
        0 => format!("photos like these show a drop of {seen} with a chance of 0.8: these happened not to"),
        more => format!(
            "if the true drop is the {seen} seen, about {needed} views show it with a chance of 0.8, and these photos are of {}: {} photos more",
            r.clusters,
            2 * more
        ),
    })
}

/// Largest number of views that is suggested.
const MOST_VIEWS: f64 = 2000.0;

/// Returns `2 deviations`, or that there is none, and whether the plan was judged by the hit rate.
pub(crate) fn deviations(plan: &PlanCheck) -> String {
    let kept = match plan.deviations.len() {
        0 => "kept, no deviation".into(),
        n => spelling::count(n, "deviation"),
    };
    let judged = "; judged as it was sealed, by the hit rate (McNemar, corrected by Holm)";
    kept + if plan.judged_by_hit_rate { judged } else { "" }
}
