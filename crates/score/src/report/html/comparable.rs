//! The figures that papers compare: AP over IoUs, recall, false positives and attack success rates; the groups that were asked for; a protocol's table.

use maud::{Markup, html};

use super::{heads, number, rows_by_detector, table, title_of};
use crate::report::protocol::photos;
use crate::report::{certainty, paired};
use crate::score::{ConditionFigures, Scores, Summary, protocol_table};
use scaleproof_plot::distinct;

pub(super) fn figures(scores: &Scores) -> Markup {
    let head = html! {
        (heads("detector", &["texture"])) th { "AP@[.5:.95]" } th { "mAR" } th { "mAR 50" } th { "FPPI" }
        th { "ASR of AP@0.5" br; small { "95 % interval" } } th { "ASR of the hit rate" br; small { "95 % interval" } }
    };
    html! {
        (table(None, &head, &rows_by_detector(scores, title_of, |s| cells(scores, s))))
        p.note {
            "ASR: attack success rate, 1 − this texture ÷ " (scores.base) ", on paired photos where there are pairs; its interval is of the same bootstrap "
            "as the drop's. A rate without an interval is not certain: where no photo was hit, Wilson's interval says up to which hit rate these photos leave open."
        }
    }
}

fn cells(scores: &Scores, s: &Summary) -> Markup {
    let f = &s.overall;
    let two = |v: f64| number(v, 2);
    let rates = match (paired::compared(scores, &s.detector, &s.variant), s.asr) {
        (Some(r), _) => [&r.ap50, &r.hit_rate.rate].map(|d| certainty::asr(r, d, two)),
        (None, Some(asr)) => [asr.ap50, asr.hit_rate].map(|asr| (asr.map_or("–".to_owned(), two), None)),
        (None, None) => [(); 2].map(|()| (String::new(), None)),
    };
    html! {
        td { (number(f.ap50_95, 3)) } td { (number(f.mar, 3)) } td { (number(f.mar50, 3)) }
        td { (number(f.false_positives_per_image, 2)) }
        @for (rate, interval) in rates {
            td {
                (rate)
                @match interval {
                    Some(interval) if interval.starts_with('[') => { " " small { (interval) } }
                    Some(why) => { br; small.why { (why) } }
                    None => {}
                }
            }
        }
    }
}

/// A table for each condition that photos were grouped by; nothing when none was asked for.
pub(super) fn groups(scores: &Scores) -> Option<Markup> {
    let all = scores.summaries.iter().flat_map(|s| &s.conditions);
    let conditions = distinct(all.map(|c| c.condition.as_str()));
    (!conditions.is_empty()).then(|| {
        html! {
            @for condition in conditions { h3 { (condition) } (group(scores, condition)) }
            p.note { "AP@0.5 (of two photos or more), hits / photos below, and the attack success rate of the hit rate. “–”: no photo." }
        }
    })
}

/// Values across, detectors and textures down.
fn group(scores: &Scores, condition: &str) -> Markup {
    let own = |s: &'_ Summary| s.conditions.clone().into_iter().filter(|c| c.condition == condition);
    let values = distinct(scores.summaries.iter().flat_map(own).map(|c| c.value));
    let rows = html! {
        @for s in &scores.summaries {
            tr.first[s.variant == scores.base] {
                td { (scores.title(&s.detector)) } td.text { (s.variant) }
                @for value in &values { (group_cell(own(s).find(|c| c.value == *value).as_ref())) }
            }
        }
    };
    let head = html! { (heads("detector", &["texture"])) @for value in &values { th { (value) } } };
    table(None, &head, &rows)
}

fn group_cell(found: Option<&ConditionFigures>) -> Markup {
    html! {
        td {
            @match found {
                Some(c) => {
                    @if c.figures.photos > 1 { (number(c.figures.ap50, 2)) br; }
                    small {
                        (c.figures.hit_rate.count) "/" (c.figures.photos)
                        @if let Some(asr) = c.asr.and_then(|a| a.hit_rate) { ", ASR " (number(asr, 2)) }
                    }
                }
                None => { "–" }
            }
        }
    }
}

/// The table of the protocol that is followed; nothing when none is.
pub(super) fn protocol(scores: &Scores) -> Option<Markup> {
    let own = protocol_table(scores)?;
    let head = html! { @for column in &own.columns { th { (column) } } };
    let rows = html! { @for row in &own.rows { tr { @for cell in row { td { (cell) } } } } };
    Some(html! {
        p.note { b { (own.name) } ": " (own.source) "; " (photos(scores)) "." }
        (table(None, &head, &rows))
    })
}
