//! Charts of the evidence of a sequential comparison as it grew.

use crate::figures::{Course, Scores, Sequential};
use crate::report::charts::colours::colour;
use crate::report::words::looks::SHOWN_FROM;
use crate::report::words::{figures, unit};
use scaleproof_plot::Anchor::{End, Middle};
use scaleproof_plot::{BLACK, Drawing, FAINT, INK, Mark, NOTE};

pub(crate) const SIDE: [f64; 2] = [220.0, 120.0];
/// Range of the evidence in a chart, as base-10 logarithms.
const EVIDENCE: [f64; 2] = [-2.0, 4.0];

pub(crate) fn chart(scores: &Scores, sequential: &Sequential, course: &Course) -> Drawing {
    let last = course.looks.max(2) as f64;
    let at = |look: f64, evidence: f64| {
        let share = (evidence.clamp(EVIDENCE[0], EVIDENCE[1]) - EVIDENCE[0]) / (EVIDENCE[1] - EVIDENCE[0]);
        [(look - 1.0) / (last - 1.0) * SIDE[0], (1.0 - share) * SIDE[1]]
    };
    let mut marks = Vec::new();
    for (tick, name) in [(-2.0, "0.01"), (0.0, "1"), (2.0, "100"), (4.0, "10⁴")] {
        marks.push(Mark::line(at(1.0, tick), at(last, tick), FAINT));
        marks.push(Mark::text([-5.0, at(1.0, tick)[1] + 3.0], 9.0, End, NOTE, name));
    }
    marks.push(Mark::line(at(1.0, SHOWN_FROM), at(last, SHOWN_FROM), INK).dashed(true));
    for (i, (_, decision)) in figures(course).into_iter().enumerate() {
        let looks = decision.log10_evidence.iter().enumerate();
        let places = looks.map(|(look, evidence)| at(1.0 + look as f64, *evidence));
        marks.push(Mark::polyline(places, colour(i), 2.0));
    }
    for (x, look) in [(0.0, 1), (SIDE[0], course.looks)] {
        marks.push(Mark::text([x, SIDE[1] + 13.0], 9.0, Middle, NOTE, look));
    }
    let below = format!("{}s", unit(sequential));
    marks.push(Mark::text([SIDE[0] / 2.0, SIDE[1] + 15.0], 10.0, Middle, BLACK, below));
    Drawing {
        area: [-34.0, -8.0, 268.0, 148.0],
        label: format!(
            "Evidence for a drop after each {}, {}, {}",
            unit(sequential),
            scores.title(&course.detector),
            course.variant
        ),
        marks,
    }
}
