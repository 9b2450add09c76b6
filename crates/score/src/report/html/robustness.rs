//! AP against the severity of corruptions, a chart for each detector and corruption, and how far each drop goes.

use maud::{Markup, html};

use super::{colour, round, variants};
use crate::report::robustness::{heading, survival_table};
use crate::score::{CorruptedRow, Finding, Robustness, Scores};
use scaleproof_plot::{Drawing, distinct};

const SIDE: [f64; 2] = [180.0, 120.0];
/// Of the last severity.
const LAST: f64 = 5.0;

/// What explains a chart.
pub(in crate::report) const MARKS: &str = "Severity 0: the photo reduced to 640 px, no worse; below the axes the amounts. Filled: a drop of AP@0.5 from the base is shown there at 5 %; hollow: none is.";

/// `None` where it was not asked for.
pub(super) fn section(scores: &Scores) -> Option<Markup> {
    let robustness = scores.robustness.as_ref()?;
    let table = survival_table(robustness);
    Some(html! {
        ul.legend {
            @for (i, variant) in variants(scores).iter().enumerate() { li { i style=(format!("background:{}", colour(i))) {} (variant) } }
        }
        div.small-charts {
            @for (title, drawing) in charts(scores, robustness) { figure { (drawing.inline(None)) figcaption { (title) } } }
        }
        p.note { (MARKS) }
        h3 { "How far each drop goes" }
        div.scroll {
            table.matrix {
                thead { tr { @for head in &table[0] { th { (head) } } } }
                tbody { @for row in &table[1..] { tr { @for cell in row { td { (cell) } } } } }
            }
        }
        p.note {
            "In the table: " (heading()) ". Photos are reduced to 640 px, then made worse by the amounts of ImageNet-C (Hendrycks and Dietterich 2019); " code { "crop" }
            " cuts 10 to 50 % of the model's box off."
        }
        @for caution in &robustness.cautions { p.note { (caution) } }
    })
}

/// By title.
pub(in crate::report) fn charts(scores: &Scores, robustness: &Robustness) -> Vec<(String, Drawing)> {
    let corruptions = robustness.corruptions();
    let mut all = Vec::new();
    for detector in &scores.detectors {
        for corruption in &corruptions {
            let is_own = |row: &&CorruptedRow| row.corruption == *corruption && row.detector == detector.manifest.name;
            let own: Vec<&CorruptedRow> = robustness.rows.iter().filter(is_own).collect();
            let title = format!("{}: {corruption}", detector.manifest.title);
            all.push((title.clone(), chart(scores, title, &own)));
        }
    }
    all
}

/// `own`: those of one detector and corruption.
fn chart(scores: &Scores, title: String, own: &[&CorruptedRow]) -> Drawing {
    let from_base: Vec<&CorruptedRow> = own.iter().copied().filter(|row| row.base == scores.base).collect();
    let amounts = distinct(from_base.iter().map(|row| (row.severity, row.amount.as_str())));
    let lines = variants(scores).into_iter().enumerate().map(|(i, variant)| {
        let points: Vec<(f64, f64, bool)> = if variant == scores.base {
            of_base(&from_base)
        } else {
            let own = from_base.iter().filter(|row| row.variant == variant);
            own.map(|row| {
                (
                    f64::from(row.severity),
                    row.ap50.other,
                    row.ap50.finding == Finding::Drop,
                )
            })
            .collect()
        };
        line(colour(i), &points, variant == scores.base)
    });
    let marks = html! {
        @for tick in [0.0, 0.5, 1.0] {
            line x1="0" x2=(SIDE[0]) y1=(y(tick)) y2=(y(tick)) stroke="#d7dce2" {}
            text x="-5" y=(y(tick) + 3.0) font-size="9" text-anchor="end" fill="#5b6573" { (tick) }
        }
        @for (severity, amount) in &amounts {
            text x=(x(f64::from(*severity))) y=(SIDE[1] + 13.0) font-size="8" text-anchor="middle" fill="#5b6573" { (short(amount)) }
        }
        @for line in lines { (line) }
        text transform=(format!("translate(-27 {}) rotate(-90)", SIDE[1] / 2.0)) font-size="10" text-anchor="middle" { "AP@0.5" }
    };
    Drawing {
        area: [-38.0, -8.0, 232.0, 146.0],
        label: format!("AP@0.5 against severity, {title}"),
        marks,
    }
}

/// What has room below an axis.
fn short(amount: &str) -> &str {
    match amount.split(" (").next() {
        None | Some("") => "0",
        Some(short) => short,
    }
}

/// The base of the first variant's pairs.
fn of_base(from_base: &[&CorruptedRow]) -> Vec<(f64, f64, bool)> {
    let first = from_base.first().map(|row| row.variant.as_str());
    let own = from_base.iter().filter(|row| Some(row.variant.as_str()) == first);
    own.map(|row| (f64::from(row.severity), row.ap50.base, true)).collect()
}

/// (severity, AP, whether it is filled); the base has no marks.
fn line(colour: &str, points: &[(f64, f64, bool)], is_base: bool) -> Markup {
    let path: Vec<String> = points
        .iter()
        .map(|(severity, ap, _)| format!("{},{}", x(*severity), y(*ap)))
        .collect();
    html! {
        polyline points=(path.join(" ")) fill="none" stroke=(colour) stroke-width="2" {}
        @for (severity, ap, is_filled) in points.iter().filter(|_| !is_base) {
            circle cx=(x(*severity)) cy=(y(*ap)) r="3" stroke=(colour) stroke-width="1.5" fill=(if *is_filled { colour } else { "#fff" }) {}
        }
    }
}

fn x(severity: f64) -> f64 {
    round(severity / LAST * SIDE[0])
}

fn y(ap: f64) -> f64 {
    round((1.0 - ap) * SIDE[1])
}
