//! Polar charts: mean confidence by azimuth, the model's front up, seen from above.

use crate::figures::{BinFigures, Scores};
use crate::report::charts::colours::colour;
use scaleproof_plot::Anchor::{End, Middle, Start};
use scaleproof_plot::{Colour, Drawing, FAINT, Mark, NOTE, WHITE};

const RADIUS: f64 = 88.0;

/// Explanation of the marks.
pub(crate) const MARKS: &str = "Distance from the middle: mean confidence, rings at 0.5 and 1; filled dot: every photo a hit, hollow: not every one; \
    a line where every bin has several photos";

/// Least number of photos from which a bin's mean is more than one photo's chance.
const SEVERAL: usize = 2;

pub(crate) fn charts(scores: &Scores) -> Vec<(&str, Drawing)> {
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

pub(crate) fn chart(title: &str, series: &[(Colour, &[BinFigures])]) -> Drawing {
    let ring = |share: f64| Mark::circle([0.0; 2], RADIUS * share).outlined(FAINT, 1.0);
    let mut marks = vec![ring(0.5), ring(1.0)];
    marks.push(Mark::text([2.0, -RADIUS / 2.0 - 2.0], 8.0, Start, NOTE, "0.5"));
    let bins = series.first().map_or(&[][..], |s| s.1);
    marks.extend(
        bins.iter()
            .map(|bin| Mark::line([0.0; 2], at(bin.azimuth_deg, 1.0), FAINT)),
    );
    marks.extend(side_names());
    marks.extend(series.iter().flat_map(|(colour, bins)| line(*colour, bins)));
    Drawing {
        area: [-125.0, -116.0, 250.0, 232.0],
        label: format!("Mean confidence by azimuth, {title}"),
        marks,
    }
}

fn side_names() -> [Mark; 4] {
    let names = [
        ("front", [0.0, -RADIUS - 8.0], Middle),
        ("rear", [0.0, RADIUS + 16.0], Middle),
        ("left", [-RADIUS - 6.0, 3.0], End),
        ("right", [RADIUS + 6.0, 3.0], Start),
    ];
    names.map(|(name, place, anchor)| Mark::text(place, 11.0, anchor, NOTE, name))
}

/// Draws the points of one variant, joined to a line only where each bin rests on several photos: a line between single photos would show a course
/// without support. A bin without photos breaks the line.
fn line(colour: Colour, bins: &[BinFigures]) -> Vec<Mark> {
    let point = |b: &BinFigures| Some(at(b.azimuth_deg, b.figures.as_ref()?.mean_confidence));
    let points: Vec<Option<[f64; 2]>> = bins.iter().map(point).collect();
    let mut figures = bins.iter().filter_map(|b| b.figures.as_ref());
    let is_joined = figures.all(|f| f.photos >= SEVERAL);
    let known = |points: &[Option<[f64; 2]>]| points.iter().flatten().copied().collect::<Vec<_>>();
    let mut marks = Vec::new();
    if is_joined && points.iter().all(Option::is_some) {
        let area = Mark::polygon(known(&points)).filled(colour).sheer(0.12);
        marks.push(area.outlined(colour, 2.0));
    } else if is_joined {
        let runs = points.split(Option::is_none);
        marks.extend(runs.map(|run| Mark::polyline(known(run), colour, 2.0)));
    }
    for (bin, point) in bins.iter().zip(&points) {
        if let (Some(f), Some(place)) = (&bin.figures, point) {
            let is_all = f.hit_rate.count == f.photos;
            let dot = Mark::circle(*place, 3.0).outlined(colour, 1.5);
            marks.push(dot.filled(if is_all { colour } else { WHITE }));
        }
    }
    marks
}

/// Returns the place of a share of the radius at an azimuth: front up, counter-clockwise seen from above, so that the model's left side is on the
/// left.
pub fn at(azimuth_deg: f64, share: f64) -> [f64; 2] {
    let a = azimuth_deg.to_radians();
    [-RADIUS * share * a.sin(), -RADIUS * share * a.cos()]
}
