//! Precision over recall, and how many photos show the model from each confidence up, with intervals: a pair of charts for each detector.

use maud::{Markup, html};

use super::{SIDE, SQUARE, colour, colour_names, points, small_charts};
use crate::score::{Curves, HitRateFrom, Scores, curves};
use scaleproof_plot::Drawing;

pub(super) fn section(scores: &Scores) -> Markup {
    let both = charts(scores).into_iter().flat_map(|(title, charts)| {
        let captions = ["found from a confidence", "precision over recall"];
        let captions = captions.map(|what| html! { (title) br; small { (what) } });
        captions.into_iter().zip(charts)
    });
    html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(both))
        p.note {
            "Found: share of photos that show the model at this confidence or more, with its 95 % Wilson interval; upright line: the confidence of a hit. "
            "Precision and recall of the detections of the class at IoU 0.5, from the most confident down to 0.001."
        }
    }
}

/// By the title of each detector: found from a confidence, and precision over recall.
pub(in crate::report) fn charts(scores: &Scores) -> Vec<(&str, [Drawing; 2])> {
    let (all, variants) = (curves(scores), scores.variants());
    let of = scores.detectors.iter().map(|c| {
        let own = variants.iter().enumerate().filter_map(|(i, variant)| {
            let is_own = |curve: &&Curves| curve.detector == c.manifest.name && curve.variant == *variant;
            Some((colour(i), all.iter().find(is_own)?))
        });
        let (title, own) = (c.manifest.title.as_str(), own.collect::<Vec<_>>());
        let found = found(title, &own, scores.criteria.hit_confidence);
        (title, [found, precision_recall(title, &own)])
    });
    of.collect()
}

type Own<'a> = [(&'static str, &'a Curves)];

fn found(title: &str, own: &Own, hit_confidence: f64) -> Drawing {
    let marks = html! {
        @for (colour, curve) in own {
            polygon points=(band(&curve.hit_rate)) fill=(colour) fill-opacity="0.15" {}
            polyline points=(line(curve.hit_rate.iter().map(|p| (p.confidence, p.rate.rate)))) fill="none" stroke=(colour) stroke-width="2" {}
        }
        line x1=(SQUARE.x(hit_confidence)) x2=(SQUARE.x(hit_confidence)) y1=(SIDE) y2="0" stroke="#1b1f24" stroke-dasharray="4 3" {}
    };
    chart(
        format!("Share of photos found by confidence, {title}"),
        ["confidence", "share found"],
        marks,
    )
}

fn precision_recall(title: &str, own: &Own) -> Drawing {
    let marks = html! {
        @for (colour, curve) in own {
            polyline points=(line(curve.precision_recall.iter().map(|p| (p.recall, p.precision)))) fill="none" stroke=(colour) stroke-width="2" {}
        }
    };
    chart(
        format!("Precision over recall, {title}"),
        ["recall", "precision"],
        marks,
    )
}

fn chart(label: String, axes: [&str; 2], content: Markup) -> Drawing {
    let marks = html! {
        (SQUARE.grid(-5.0, Some(13.0)))
        (content)
        text x=(SIDE / 2.0) y=(SIDE + 28.0) font-size="10" text-anchor="middle" { (axes[0]) }
        (SQUARE.upright_title(-21.0, axes[1]))
    };
    let area = [-30.0, -8.0, 222.0, 226.0];
    Drawing { area, label, marks }
}

fn line(shares: impl Iterator<Item = (f64, f64)>) -> String {
    points(shares.map(|(h, v)| (SQUARE.x(h), SQUARE.y(v))))
}

/// Along the upper ends of the intervals, and back along the lower ones.
fn band(points: &[HitRateFrom]) -> String {
    let upper = points.iter().map(|p| (p.confidence, p.rate.high));
    let lower = points.iter().rev().map(|p| (p.confidence, p.rate.low));
    line(upper.chain(lower))
}
