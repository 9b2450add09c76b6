//! Draws place strips: the ground as it is seen through the strip, and what to do with its ends.

use super::ground::Ground;
use super::piece::CutPiece;
use super::strip::{PlaceStrip, WIDTH_MM};
use super::{Instead, LINE_MM};
use crate::print::sheet::{Mark, PointMm, TextAnchor};

const NAME_MM: f64 = 6.0;
const TEXT_MM: f64 = 2.4;
const EDGE_MM: f64 = 2.0;

/// The strips of a mat.
pub fn pieces<'a>(ground: &'a Ground) -> Vec<CutPiece<'a>> {
    let piece = |strip: &'a PlaceStrip| CutPiece {
        size_mm: (strip.length_mm, WIDTH_MM),
        name: format!("strip T{}", strip.tent + 1),
        what: format!("the place strip of tent card T{}", strip.tent + 1),
        instead: Instead::WholeMat,
        draw: Box::new(move |at| Ok(marks(strip, ground, at))),
    };
    ground.strips.iter().map(piece).collect()
}

fn marks(strip: &PlaceStrip, ground: &Ground, at: PointMm) -> Vec<Mark> {
    let area = strip.area(at);
    let mut marks = ground.mat.marks(&strip.window(at), area);
    let name = format!("T{}", strip.tent + 1);
    // Between what is glued and what lies beneath the card.
    let free = (area.left_mm + strip.root_mm, area.right_mm - strip.under_mm);
    let middle = ((free.0 + free.1) / 2.0, area.middle().1);
    let size = (NAME_MM, (free.1 - free.0 - 2.0).max(2.0));
    marks.push(Mark::centred(middle, size, name.as_str()));
    let corner = (area.left_mm + EDGE_MM, area.bottom_mm + EDGE_MM);
    let glue = format!("glue onto strip {name}");
    marks.push(Mark::text(corner, TEXT_MM, TextAnchor::Left, glue));
    let ends = [
        (area.bottom_mm, area.bottom_mm + EDGE_MM),
        (area.top_mm - EDGE_MM, area.top_mm),
    ];
    marks.extend(ends.map(|(from, to)| Mark::line((free.0, from), (free.0, to), LINE_MM)));
    marks.extend(Mark::outline(&area.outline(), LINE_MM));
    marks
}
