//! AP against the severity of corruptions, a chart for each detector and corruption, and how far each drop goes.

use maud::{Markup, html};

use super::{Plane, colour, colour_names, points, small_charts};
use crate::report::tables;
use crate::score::{CorruptedRow, Robustness, Scores};
use scaleproof_plot::{Drawing, distinct};

const PLANE: Plane = Plane {
    width: 180.0,
    height: 120.0,
};
/// Of the last severity.
const LAST: f64 = 5.0;

pub(in crate::report) const MARKS: &str = "Severity 0: the photo reduced to 640 px, no worse; below the axes the amounts. Filled: the 95 % interval of the drop of AP@0.5 from the base lies above 0 there.";

/// `None` where it was not asked for.
pub(super) fn section(scores: &Scores) -> Option<Markup> {
    let robustness = scores.robustness.as_ref()?;
    let survival = tables::survival(robustness);
    Some(html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(charts(scores, robustness).into_iter().map(|(title, chart)| (html! { (title) }, chart))))
        p.note { (MARKS) }
        h3 { "How far each drop goes" }
        p.note { (survival.caption) "." }
        (survival.markup())
        p.note {
            "Photos are reduced to 640 px, then made worse by the amounts of ImageNet-C (Hendrycks and Dietterich 2019); " code { "crop" }
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
            let is_own =
                |row: &&CorruptedRow| row.corruption == *corruption && row.held.detector == detector.manifest.name;
            let own: Vec<&CorruptedRow> = robustness.rows.iter().filter(is_own).collect();
            let title = format!("{}: {corruption}", detector.manifest.title);
            all.push((title.clone(), chart(scores, title, &own)));
        }
    }
    all
}

/// `own`: those of one detector and corruption.
fn chart(scores: &Scores, title: String, own: &[&CorruptedRow]) -> Drawing {
    let from_base: Vec<&CorruptedRow> = own.iter().copied().filter(|row| row.held.base == scores.base).collect();
    let amounts = distinct(from_base.iter().map(|row| (row.severity, row.amount.as_str())));
    let lines = scores.variants().into_iter().enumerate().map(|(i, variant)| {
        let points: Vec<(f64, f64, bool)> = if variant == scores.base {
            of_base(&from_base)
        } else {
            let own = from_base.iter().filter(|row| row.held.variant == variant);
            own.map(|row| {
                (
                    f64::from(row.severity),
                    row.held.ap50.other,
                    row.held.is_above_zero() == Some(true),
                )
            })
            .collect()
        };
        line(colour(i), &points, variant == scores.base)
    });
    let marks = html! {
        (PLANE.grid(-5.0, None))
        @for (severity, amount) in &amounts {
            text x=(x(f64::from(*severity))) y=(PLANE.height + 13.0) font-size="8" text-anchor="middle" fill="#5b6573" { (short(amount)) }
        }
        @for line in lines { (line) }
        (PLANE.upright_title(-27.0, "AP@0.5"))
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

fn of_base(from_base: &[&CorruptedRow]) -> Vec<(f64, f64, bool)> {
    let first = from_base.first().map(|row| row.held.variant.as_str());
    let own = from_base.iter().filter(|row| Some(row.held.variant.as_str()) == first);
    own.map(|row| (f64::from(row.severity), row.held.ap50.base, true))
        .collect()
}

/// (severity, AP, whether it is filled); the base has no marks.
fn line(colour: &str, marks: &[(f64, f64, bool)], is_base: bool) -> Markup {
    let path = points(marks.iter().map(|(severity, ap, _)| (x(*severity), PLANE.y(*ap))));
    html! {
        polyline points=(path) fill="none" stroke=(colour) stroke-width="2" {}
        @for (severity, ap, is_filled) in marks.iter().filter(|_| !is_base) {
            circle cx=(x(*severity)) cy=(PLANE.y(*ap)) r="3" stroke=(colour) stroke-width="1.5" fill=(if *is_filled { colour } else { "#fff" }) {}
        }
    }
}

fn x(severity: f64) -> f64 {
    PLANE.x(severity / LAST)
}
