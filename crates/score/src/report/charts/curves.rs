//! Charts of precision over recall, and of the share of photos found from each confidence up.

use crate::figures::{Curves, HitRateFrom, Scores, curves};
use crate::report::charts::colours::colour;
use crate::report::charts::plane::{SIDE, SQUARE};
use scaleproof_plot::Anchor::Middle;
use scaleproof_plot::{BLACK, Colour, Drawing, INK, Mark};

/// Returns by the title of each detector the charts of photos found from a confidence and of precision over recall.
pub(crate) fn charts(scores: &Scores) -> Vec<(&str, [Drawing; 2])> {
    let (all, variants) = (curves(scores), scores.variants());
    let of = scores.detectors.iter().map(|c| {
        let own = variants.iter().enumerate().filter_map(|(i, variant)| {
            let is_own = |curve: &&Curves| curve.detector == c.manifest.name && curve.variant == *variant;
            Some((colour(i), all.iter().find(is_own)?))
        });
        let (title, own) = (c.manifest.title.as_str(), own.collect::<Vec<_>>());
        let found = found_chart(title, &own, scores.criteria.hit_confidence);
        (title, [found, precision_recall(title, &own)])
    });
    of.collect()
}

type ColouredCurves<'a> = [(Colour, &'a Curves)];

fn found_chart(title: &str, own: &ColouredCurves, hit_confidence: f64) -> Drawing {
    let mut content = Vec::new();
    for (colour, curve) in own {
        let rates = curve.hit_rate.iter().map(|p| SQUARE.at(p.confidence, p.rate.rate));
        content.push(Mark::polygon(band(&curve.hit_rate)).filled(*colour).sheer(0.15));
        content.push(Mark::polyline(rates, *colour, 2.0));
    }
    let [bottom, top] = [0.0, 1.0].map(|share| SQUARE.at(hit_confidence, share));
    content.push(Mark::line(bottom, top, INK).dashed(true));
    let label = format!("Share of photos found by confidence, {title}");
    chart(label, ["confidence", "share found"], content)
}

fn precision_recall(title: &str, own: &ColouredCurves) -> Drawing {
    let line = |(colour, curve): &(Colour, &Curves)| {
        let points = curve.precision_recall.iter().map(|p| SQUARE.at(p.recall, p.precision));
        Mark::polyline(points, *colour, 2.0)
    };
    let label = format!("Precision over recall, {title}");
    chart(label, ["recall", "precision"], own.iter().map(line).collect())
}

fn chart(label: String, [below, beside]: [&str; 2], content: Vec<Mark>) -> Drawing {
    let mut marks = SQUARE.grid(-5.0, Some(13.0));
    marks.extend(content);
    marks.push(Mark::text([SIDE / 2.0, SIDE + 28.0], 10.0, Middle, BLACK, below));
    marks.push(SQUARE.upright_title(-21.0, beside));
    let area = [-30.0, -8.0, 222.0, 226.0];
    Drawing { area, label, marks }
}

/// Returns the outline of the intervals: along their upper ends, and back along the lower ones.
fn band(points: &[HitRateFrom]) -> impl Iterator<Item = [f64; 2]> {
    let upper = points.iter().map(|p| SQUARE.at(p.confidence, p.rate.high));
    let lower = points.iter().rev().map(|p| SQUARE.at(p.confidence, p.rate.low));
    upper.chain(lower)
}
