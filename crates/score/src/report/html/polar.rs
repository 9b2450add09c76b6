//! Polar charts: mean confidence by azimuth, the model's front up, seen from above.

use maud::{Markup, html};

use super::{colour, colour_names, round};
use crate::score::{BinFigures, Scores};
use scaleproof_plot::Drawing;

const RADIUS: f64 = 88.0;

/// What the marks mean.
pub(in crate::report) const MARKS: &str = "Distance from the middle: mean confidence, rings at 0.5 and 1; filled dot: every photo a hit, hollow: not every one; \
    a line where every bin has several photos";

/// So many photos make a bin's mean more than one photo's chance.
const SEVERAL: usize = 2;

/// One chart per detector, with a legend.
pub(super) fn row(scores: &Scores) -> Markup {
    html! {
        ul.legend {
            (colour_names(&scores.variants()))
            li.note { (MARKS) }
        }
        div.small-charts.polars {
            @for (title, chart) in charts(scores) { figure { (chart.inline(None)) figcaption { (title) } } }
        }
    }
}

pub(in crate::report) fn charts(scores: &Scores) -> Vec<(&str, Drawing)> {
    let variants = scores.variants();
    let all = scores.detectors.iter().map(|c| {
        let series = variants.iter().enumerate().filter_map(|(i, variant)| {
            let own = scores.summary(&c.manifest.name, variant)?;
            Some((colour(i), own.azimuth_bins.as_slice()))
        });
        let title = c.manifest.title.as_str();
        (title, chart(title, &series.collect::<Vec<_>>()))
    });
    all.collect()
}

fn chart(title: &str, series: &[(&str, &[BinFigures])]) -> Drawing {
    let marks = html! {
        @for ring in [0.5, 1.0] {
            circle r=(RADIUS * ring) fill="none" stroke="#d7dce2" {}
        }
        text x="2" y=(-RADIUS / 2.0 - 2.0) font-size="8" fill="#5b6573" { "0.5" }
        @for bin in series.first().map_or(&[][..], |s| s.1) {
            @let [x, y] = at(bin.azimuth_deg, 1.0);
            line x2=(round(x)) y2=(round(y)) stroke="#d7dce2" {}
        }
        (side_names())
        @for (colour, bins) in series { (line(colour, bins)) }
    };
    Drawing {
        area: [-125.0, -116.0, 250.0, 232.0],
        label: format!("Mean confidence by azimuth, {title}"),
        marks,
    }
}

fn side_names() -> Markup {
    let names = [
        ("front", 0.0, -RADIUS - 8.0, "middle"),
        ("rear", 0.0, RADIUS + 16.0, "middle"),
        ("left", -RADIUS - 6.0, 3.0, "end"),
        ("right", RADIUS + 6.0, 3.0, "start"),
    ];
    html! {
        @for (name, x, y, anchor) in names {
            text x=(x) y=(y) text-anchor=(anchor) font-size="11" fill="#5b6573" { (name) }
        }
    }
}

/// The points of one variant, joined to a line only where each bin rests on several photos: a line between single photos would show a course that
/// nothing tells. A bin without photos breaks it.
fn line(colour: &str, bins: &[BinFigures]) -> Markup {
    let point = |b: &BinFigures| Some(at(b.azimuth_deg, b.figures.as_ref()?.mean_confidence));
    let points: Vec<Option<[f64; 2]>> = bins.iter().map(point).collect();
    let counts = || bins.iter().filter_map(|b| Some(b.figures.as_ref()?.photos));
    let is_joined = counts().all(|photos| photos >= SEVERAL);
    let whole = points.iter().all(Option::is_some);
    let list = |points: &[Option<[f64; 2]>]| {
        let points = points.iter().flatten().map(|[x, y]| format!("{x:.1},{y:.1}"));
        points.collect::<Vec<_>>().join(" ")
    };
    let runs = points.split(Option::is_none);
    html! {
        @if !is_joined {} @else if whole {
            polygon points=(list(&points)) fill=(colour) fill-opacity="0.12" stroke=(colour) stroke-width="2" {}
        } @else {
            @for run in runs { polyline points=(list(run)) fill="none" stroke=(colour) stroke-width="2" {} }
        }
        @for (bin, point) in bins.iter().zip(&points) {
            @if let (Some(f), Some([x, y])) = (&bin.figures, point) {
                circle cx=(round(*x)) cy=(round(*y)) r="3" stroke=(colour) stroke-width="1.5"
                    fill=(if f.hit_rate.count == f.photos { colour } else { "#fff" }) {}
            }
        }
    }
}

/// Where a share of the radius at an azimuth is drawn: front up, counter-clockwise seen from above, so that the model's left side is on the left.
pub fn at(azimuth_deg: f64, share: f64) -> [f64; 2] {
    let a = azimuth_deg.to_radians();
    [-RADIUS * share * a.sin(), -RADIUS * share * a.cos()]
}
