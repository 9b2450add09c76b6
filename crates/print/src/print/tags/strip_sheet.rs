//! Draws place strips: the ground as it is seen through the strip, and what to do with its ends.

use super::Instead;
use super::ground::Ground;
use super::piece::{CutPiece, cut_line};
use super::strip::{PlaceStrip, WIDTH_MM};
use crate::print::sheet::{Mark, PointMm, TextAnchor};
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm};

const NAME_MM: f64 = 6.0;
const TEXT_MM: f64 = 2.4;
const EDGE_MM: f64 = 2.0;

/// The strips of a mat.
pub fn pieces(ground: &Ground) -> Vec<CutPiece<'_>> {
    ground.strips.iter().map(|strip| piece(strip, ground)).collect()
}

fn piece<'a>(strip: &'a PlaceStrip, ground: &'a Ground) -> CutPiece<'a> {
    CutPiece {
        size_mm: (strip.length_mm, WIDTH_MM),
        name: format!("strip T{}", strip.tent + 1),
        what: format!("the place strip of tent card T{}", strip.tent + 1),
        instead: Instead::WholeMat,
        draw: Box::new(move |at| Ok(marks(strip, ground, at))),
    }
}

fn marks(strip: &PlaceStrip, ground: &Ground, at: PointMm) -> Vec<Mark> {
    let area = strip.area(at);
    let mut marks = ground.mat.marks(&strip.window(at), area);
    let name = format!("T{}", strip.tent + 1);
    // Between what is glued and what lies beneath the card.
    let free = (area.left_mm + strip.root_mm, area.right_mm - strip.under_mm);
    let middle = ((free.0 + free.1) / 2.0, (area.bottom_mm + area.top_mm) / 2.0);
    let size_mm = fitting_size_mm(&name, NAME_MM, (free.1 - free.0 - 2.0).max(2.0));
    let baseline = middle.1 - 0.5 * CAP_HEIGHT * size_mm;
    marks.push(Mark::text(
        (middle.0, baseline),
        size_mm,
        TextAnchor::Centre,
        name.clone(),
    ));
    let foot = area.bottom_mm + EDGE_MM;
    marks.push(Mark::text(
        (area.left_mm + EDGE_MM, foot),
        TEXT_MM,
        TextAnchor::Left,
        format!("glue onto strip {name}"),
    ));
    marks.push(Mark::line(
        (free.0, area.bottom_mm),
        (free.0, area.bottom_mm + EDGE_MM),
        0.2,
    ));
    marks.push(Mark::line((free.0, area.top_mm - EDGE_MM), (free.0, area.top_mm), 0.2));
    marks.extend(cut_line(area));
    marks
}
