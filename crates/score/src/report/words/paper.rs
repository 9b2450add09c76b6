//! Sentences on a comparison for a paper, with its caveats, ready to paste.

use crate::figures::{Compared, Effect, Scores};
use crate::report::Findings;
use crate::report::words::paired::{WITHHELD, is_withheld, named_base};
use crate::report::words::{p_value, verdict};
use scaleproof_core::spelling::{self, digits};
use scaleproof_plot::distinct;

/// Returns a sentence or two for each texture, then one on how effects were decided and one on how far they hold; none where nothing was tested.
pub(crate) fn sentences(findings: Findings) -> Vec<String> {
    let tested: Vec<&Compared> = findings.results.iter().filter(|r| r.finding.is_some()).collect();
    let textures = distinct(tested.iter().map(|r| r.variant.as_str()));
    let own = |texture: &str| -> Vec<&Compared> { tested.iter().filter(|r| r.variant == texture).copied().collect() };
    let mut all: Vec<String> = textures
        .iter()
        .flat_map(|texture| of_texture(findings, &own(texture)))
        .collect();
    if !all.is_empty() {
        all.push(method(findings));
        all.push(reach(findings.scores, &tested));
    }
    all
}

/// Returns sentences on the effects of one texture that were shown, were not shown, or are withheld.
fn of_texture(findings: Findings, own: &[&Compared]) -> Vec<String> {
    let (scores, base) = (findings.scores, findings.base);
    let Some(first) = own.first() else {
        return Vec::new();
    };
    let views = format!(
        "On {} ({} × {})",
        spelling::count(first.clusters, "paired view"),
        spelling::count(first.places, "place"),
        spelling::count(first.bins, "direction")
    );
    let with = |effects: &[Effect]| -> Vec<&Compared> {
        own.iter().filter(|r| effects.contains(&r.effect())).copied().collect()
    };
    let groups = [
        ("lowered", with(&[Effect::Hides, Effect::Weakens])),
        ("raised", with(&[Effect::Strengthens])),
    ];
    let shown = groups.iter().filter(|(_, some)| !some.is_empty()).map(|(verb, some)| {
        let each: Vec<String> = some.iter().map(|r| change(scores, r)).collect();
        format!(
            "{views} the texture “{}” {verb} the mean confidence of {} of {} against {}: {}.",
            first.variant,
            some.len(),
            spelling::count(own.len(), "detector"),
            named_base(base),
            each.join("; ")
        )
    });
    let mut sentences: Vec<String> = shown.collect();
    let (withheld, nothing): (Vec<&Compared>, Vec<&Compared>) =
        with(&[Effect::NothingShown]).into_iter().partition(|r| is_withheld(r));
    if !nothing.is_empty() {
        let names: Vec<&str> = nothing.iter().map(|r| scores.title(&r.detector)).collect();
        let on = if sentences.is_empty() {
            format!("{views} no change by “{}”", first.variant)
        } else {
            "No change".to_owned()
        };
        sentences.push(format!("{on} was shown for {}{}.", names.join(", "), power(&nothing)));
    }
    for (is_so, why) in WITHHELD {
        let names: Vec<&str> = withheld
            .iter()
            .filter(|r| is_so(r))
            .map(|r| scores.title(&r.detector))
            .collect();
        if !names.is_empty() {
            sentences.push(format!(
                "What was seen of {} by “{}” is withheld: {why}.",
                names.join(", "),
                first.variant
            ));
        }
    }
    let unseen = with(&[Effect::BaseUnseen]);
    if !unseen.is_empty() {
        let names: Vec<&str> = unseen.iter().map(|r| scores.title(&r.detector)).collect();
        sentences.push(format!(
            "{} did not see {} and can tell nothing.",
            names.join(", "),
            named_base(base)
        ));
    }
    sentences
}

/// Returns the change of one detector: `A from 0.72 to 0.23 (difference 0.49, 95 % CI 0.30 to 0.66, p = 0.008; 6 of 8 photos hit, then 0)`.
fn change(scores: &Scores, r: &Compared) -> String {
    let d = &r.mean_confidence;
    let two = |v: f64| digits(v, 2);
    let interval = d
        .interval_95
        .map(|i| format!(", 95 % CI {} to {}", two(i.low), two(i.high)));
    let p = r
        .finding
        .map(|finding| format!(", p {}", p_value(finding.confidence_p)));
    let hits = r.hits();
    format!(
        "{} from {} to {} (difference {}{}{}; {} of {} photos hit, then {})",
        scores.title(&r.detector),
        two(d.base),
        two(d.other),
        two(d.drop),
        interval.unwrap_or_default(),
        p.unwrap_or_default(),
        hits[0],
        r.pairs,
        hits[1]
    )
}

/// Returns the range of drops that would have been shown, if it is known for each detector, or the number of views missing before anything can be
/// shown.
fn power(nothing: &[&Compared]) -> String {
    let missing = nothing.iter().filter_map(|r| Some(r.finding?.views_missing)).max();
    if let Some(more @ 1..) = missing {
        let views = spelling::count(more, "view");
        return format!(", as nothing can be with {views} fewer than are needed");
    }
    let drops: Option<Vec<f64>> = nothing.iter().map(|r| r.finding?.drop_shown_from).collect();
    let Some(drops) = drops else {
        return String::new();
    };
    let (least, most) = drops.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), drop| {
        (drop.min(least), drop.max(most))
    });
    let [least, most] = [least, most].map(|drop| digits(drop, 2));
    let range = if least == most {
        least
    } else {
        format!("{least} to {most}")
    };
    format!(", where a drop of {range} would have been shown with a power of 0.8")
}

fn method(findings: Findings) -> String {
    if findings.is_sequential {
        return "The photos were looked at pair by pair; significance is by bets on the paired differences (Waudby-Smith and Ramdas 2024), corrected for the detectors by Holm and for the number of textures, and holds however often one looks.".to_owned();
    }
    if findings.plan.is_some_and(|plan| plan.judged_by_hit_rate) {
        return "As sealed before the photos, findings rest on McNemar's exact test of the hit rate, corrected by Holm; confidence intervals are bootstrapped by view and uncorrected.".to_owned();
    }
    "Significance is by sign flips of the views, joint over the detectors of a texture (step-down, Westfall and Young 1993), at 5 % shared by the textures; confidence intervals are bootstrapped by view and uncorrected.".to_owned()
}

/// Returns a sentence on the places, light, print and model that the result holds for.
fn reach(scores: &Scores, tested: &[&Compared]) -> String {
    let places = tested.iter().map(|r| r.places).max().unwrap_or_default();
    let is_wider = tested.iter().any(|r| {
        let like = r.finding.and_then(|finding| finding.in_places_like_these);
        like.is_some_and(|like| like.effect.is_shown())
    });
    let model = &scores.sessions[0].scene.model;
    let places = match (places, is_wider) {
        (_, true) => "places like these".to_owned(),
        (1, _) => "this place".to_owned(),
        (places, _) => format!("these {places} places"),
    };
    let renders = if verdict::are_renders(scores) {
        "; the photos are renders"
    } else {
        ""
    };
    format!(
        "The result holds for {places}, this light, this print and this 1:{} model of a {}{renders}.",
        model.scale, model.class
    )
}
