//! Charts of AP against the severity of corruptions.

use crate::figures::{CorruptedRow, Robustness, Scores};
use crate::report::charts::colours::colour;
use crate::report::charts::plane::Plane;
use scaleproof_plot::Anchor::Middle;
use scaleproof_plot::{Colour, Drawing, Mark, NOTE, WHITE, distinct};

const PLANE: Plane = Plane {
    width: 180.0,
    height: 120.0,
};
/// Greatest severity.
const LAST: f64 = 5.0;

pub(crate) const MARKS: &str = "Severity 0: the photo reduced to 640 px, no worse; below the axes the amounts. Filled: the 95 % interval of the drop of AP@0.5 from the base lies above 0 there.";

/// Returns the chart of each detector and corruption, by its title.
pub(crate) fn charts(scores: &Scores, robustness: &Robustness) -> Vec<(String, Drawing)> {
    let corruptions = robustness.corruptions();
    let mut all = Vec::new();
    for detector in &scores.detectors {
        for corruption in &corruptions {
            let is_own = |row: &&CorruptedRow| {
                row.corruption == *corruption && row.difference.detector == detector.manifest.name
            };
            let own: Vec<&CorruptedRow> = robustness.rows.iter().filter(is_own).collect();
            let title = format!("{}: {corruption}", detector.manifest.title);
            all.push((title.clone(), chart(scores, title, &own)));
        }
    }
    all
}

/// Draws the chart of `own`, the rows of one detector and corruption.
pub(crate) fn chart(scores: &Scores, title: String, own: &[&CorruptedRow]) -> Drawing {
    let from_base: Vec<&CorruptedRow> = own
        .iter()
        .copied()
        .filter(|row| row.difference.base == scores.base)
        .collect();
    let amounts = distinct(from_base.iter().map(|row| (row.severity, row.amount.as_str())));
    let lines = scores.variants().into_iter().enumerate().map(|(i, variant)| {
        let points: Vec<(f64, f64, bool)> = if variant == scores.base {
            of_base(&from_base)
        } else {
            let own = from_base.iter().filter(|row| row.difference.variant == variant);
            own.map(|row| {
                (
                    f64::from(row.severity),
                    row.difference.ap50.other,
                    row.difference.is_above_zero() == Some(true),
                )
            })
            .collect()
        };
        line(colour(i), &points, variant == scores.base)
    });
    let mut marks = PLANE.grid(-5.0, None);
    for (severity, amount) in &amounts {
        let [x, bottom] = at(f64::from(*severity), 0.0);
        marks.push(Mark::text([x, bottom + 13.0], 8.0, Middle, NOTE, short(amount)));
    }
    marks.extend(lines.flatten());
    marks.push(PLANE.upright_title(-27.0, "AP@0.5"));
    Drawing {
        area: [-38.0, -8.0, 232.0, 146.0],
        label: format!("AP@0.5 against severity, {title}"),
        marks,
    }
}

/// Returns the part of an amount that has room below an axis: the text before its bracket.
fn short(amount: &str) -> &str {
    match amount.split(" (").next() {
        None | Some("") => "0",
        Some(short) => short,
    }
}

fn of_base(from_base: &[&CorruptedRow]) -> Vec<(f64, f64, bool)> {
    let first = from_base.first().map(|row| row.difference.variant.as_str());
    let own = from_base
        .iter()
        .filter(|row| Some(row.difference.variant.as_str()) == first);
    own.map(|row| (f64::from(row.severity), row.difference.ap50.base, true))
        .collect()
}

/// Draws a line through (severity, AP, whether the dot is filled), with dots but for the base.
fn line(colour: Colour, points: &[(f64, f64, bool)], is_base: bool) -> Vec<Mark> {
    let places = points.iter().map(|(severity, ap, _)| at(*severity, *ap));
    let dots = points.iter().filter(|_| !is_base).map(|(severity, ap, is_filled)| {
        let dot = Mark::circle(at(*severity, *ap), 3.0).outlined(colour, 1.5);
        dot.filled(if *is_filled { colour } else { WHITE })
    });
    [Mark::polyline(places, colour, 2.0)].into_iter().chain(dots).collect()
}

fn at(severity: f64, ap: f64) -> [f64; 2] {
    PLANE.at(severity / LAST, ap)
}
