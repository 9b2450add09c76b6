//! 100 mm rulers on every page: printers stretch one axis without notice, and a ruler shows it.

use super::sheet::{Mark, TextAnchor};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::CAP_HEIGHT;

pub const LENGTH_MM: f64 = 100.0;
/// Depth of a ruler's strip with ticks and labels.
pub const DEPTH_MM: f64 = 8.5;

const LINE_MM: f64 = 0.12;
const LABEL_MM: f64 = 2.2;
const LABEL_GAP_MM: f64 = 0.5;
const LONGEST_TICK_MM: f64 = 4.0;

/// Draws a ruler along x from `origin` to the right; ticks and labels are below.
pub fn horizontal(origin: Point2) -> Vec<Mark> {
    let (x, y) = (origin[0], origin[1]);
    let label_y = y - LONGEST_TICK_MM - LABEL_GAP_MM - CAP_HEIGHT * LABEL_MM;
    let mut marks = vec![Mark::line([x, y], [x + LENGTH_MM, y], LINE_MM)];
    marks.extend(ticks().map(|(at, tick)| Mark::line([x + at, y], [x + at, y - tick], LINE_MM)));
    marks.extend(labels().map(|(at, label)| Mark::text([x + at, label_y], LABEL_MM, TextAnchor::Centre, label)));
    marks
}

/// Draws a ruler along y from `origin` upwards; ticks and labels are to its left.
pub fn vertical(origin: Point2) -> Vec<Mark> {
    let (x, y) = (origin[0], origin[1]);
    let label_x = x - LONGEST_TICK_MM - LABEL_GAP_MM;
    let mut marks = vec![Mark::line([x, y], [x, y + LENGTH_MM], LINE_MM)];
    marks.extend(ticks().map(|(at, tick)| Mark::line([x, y + at], [x - tick, y + at], LINE_MM)));
    for (at, label) in labels() {
        let baseline = y + at - 0.5 * CAP_HEIGHT * LABEL_MM;
        marks.push(Mark::text([label_x, baseline], LABEL_MM, TextAnchor::Right, label));
    }
    marks
}

/// Returns (position along the ruler, tick length) of every millimetre, in mm.
fn ticks() -> impl Iterator<Item = (f64, f64)> {
    (0..=LENGTH_MM as u32).map(|mm| {
        let length = match mm {
            _ if mm % 10 == 0 => LONGEST_TICK_MM,
            _ if mm % 5 == 0 => 2.5,
            _ => 1.5,
        };
        (f64::from(mm), length)
    })
}

/// Returns (position, text): each centimetre, and the unit between the first two.
fn labels() -> impl Iterator<Item = (f64, String)> {
    let centimetres = (0..=LENGTH_MM as u32)
        .step_by(10)
        .map(|mm| (f64::from(mm), mm.to_string()));
    centimetres.chain([(5.0, "mm".to_owned())])
}
