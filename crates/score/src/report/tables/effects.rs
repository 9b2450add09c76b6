//! Table of the effect of each texture on each detector, the main one of a comparison.

use crate::compare::MOST_HIT;
use crate::figures::{Compared, Effect, Scores, Summary};
use crate::report::Findings;
use crate::report::table::{Cell, Column, Table, Value};
use crate::report::words::paired;
use scaleproof_core::spelling::{self, digits};

/// Returns a row for each detector and texture: the effect, the mean confidence and hits of the base and of the texture.
pub(crate) fn effects(findings: Findings) -> Table {
    let (scores, results, base) = (findings.scores, findings.results, findings.base);
    let mut table = Table::new(
        &format!("Textures against {}", paired::named_base(base)),
        vec![
            Column::words("detector"),
            Column::words("texture"),
            Column::words("effect"),
            Column::numbers("drop").called("drop_mean_confidence").in_unit("95 %"),
            Column::numbers("confidence").called("mean_confidence"),
            Column::numbers("hits"),
            Column::numbers("AP@0.5").called("ap50"),
        ],
    );
    for detector in &scores.detectors {
        let name = &detector.manifest.name;
        let all = results.iter().chain(findings.control);
        let own = all.filter(|r| r.detector == *name).map(|r| row(scores, r));
        let unpaired = unpaired(findings, name).map(|(base, s)| unpaired_row(scores, base, s));
        table.add_block(own.chain(unpaired));
    }
    table.notes.extend(open(results));
    table.notes.extend(withheld(results));
    table.notes.extend(unsaid(results));
    table
}

fn row(scores: &Scores, r: &Compared) -> Vec<Cell> {
    let d = &r.mean_confidence;
    let [from, to] = r.hits();
    let of = r.pairs;
    vec![
        Cell::text(scores.title(&r.detector)),
        Cell::text(&r.variant),
        Cell::text(if scores.control.as_ref() == Some(&r.variant) {
            "the control"
        } else {
            paired::effect_word(r)
        })
        .strong(r.effect().is_shown())
        .with_remark(remark(r)),
        Cell::number(d.drop, 2).with_interval(d.interval_95),
        Cell::change(d.base, d.other, 2),
        Cell::of(Value::ShareChange { from, to, of }),
        Cell::change(r.ap50.base, r.ap50.other, 2),
    ]
}

/// Returns the remark in brackets behind an effect: where nothing is shown, the drop that would have been, or the views missing; an effect that is
/// withheld.
fn remark(r: &Compared) -> Option<String> {
    let finding = r.finding?;
    match finding.views_missing {
        _ if finding.effect == Effect::Weakens => finding.withheld_by_control.map(|_| "hides: withheld".to_owned()),
        _ if finding.effect != Effect::NothingShown => None,
        _ if finding.withheld_for_copies || finding.withheld_by_control.is_some() => Some("withheld".to_owned()),
        0 => finding.drop_shown_from.map(|drop| digits(drop, 2)),
        more => Some(format!("{} missing", spelling::count(more, "view"))),
    }
}

/// Returns the explanation of drops in brackets, where there are some.
fn open(results: &[Compared]) -> Option<String> {
    let has_drop = |r: &Compared| r.finding.is_some_and(|finding| finding.drop_shown_from.is_some());
    results
        .iter()
        .any(has_drop)
        .then(|| "(0.00): so large a drop of the confidence would have been shown, with a chance of 0.8".to_owned())
}

/// Returns the reason why a texture does not hide the model, though few hits are left.
fn unsaid(results: &[Compared]) -> Option<String> {
    let few_left = |r: &Compared| r.effect() == Effect::Weakens && r.hit_rate.rate.other <= MOST_HIT;
    let is_unsaid = |r: &Compared| few_left(r) && r.hit_rate.rate.drop > 0.0 && !paired::is_hit_rate_shown(r);
    let note = "weakens, though few hits are left: these views are too few to show that the hits fall, too";
    results.iter().any(is_unsaid).then(|| note.to_owned())
}

/// Returns the reasons why effects are withheld, where some are.
fn withheld(results: &[Compared]) -> Vec<String> {
    let findings = || results.iter().filter_map(|r| r.finding);
    let copies = findings().any(|finding| finding.withheld_for_copies);
    let control = findings().any(|finding| finding.withheld_by_control.is_some());
    let reasons = [
        (
            copies,
            "withheld: what is shown rests on photos that show the same moment again",
        ),
        (control, "withheld: the control round moves the detector by as much"),
    ];
    reasons
        .into_iter()
        .filter(|(is_so, _)| *is_so)
        .map(|(_, reason)| reason.to_owned())
        .collect()
}

/// Returns the textures of a detector that share no place and bin with the base, each after the base itself.
fn unpaired<'a>(findings: Findings<'a>, detector: &'a str) -> impl Iterator<Item = (&'a Summary, &'a Summary)> {
    let scores = findings.scores;
    let base = scores.summary(detector, &scores.base);
    let others = scores
        .summaries
        .iter()
        .filter(move |s| s.detector == detector && s.variant != scores.base);
    let all = move || findings.results.iter().chain(findings.control);
    others
        .filter(move |s| all().all(|r| r.variant != s.variant))
        .filter_map(move |s| Some((base?, s)))
}

/// Returns figures over all photos, as no photos pair.
fn unpaired_row(scores: &Scores, base: &Summary, s: &Summary) -> Vec<Cell> {
    let (a, b) = (&base.overall, &s.overall);
    vec![
        Cell::text(scores.title(&s.detector)),
        Cell::text(&s.variant),
        Cell::text("not paired"),
        Cell::number(a.mean_confidence - b.mean_confidence, 2),
        Cell::change(a.mean_confidence, b.mean_confidence, 2),
        Cell::share(b.hit_rate.count, b.photos),
        Cell::change(a.ap50, b.ap50, 2),
    ]
}
