//! Charts of the order of the textures here and in other sessions.

use crate::figures::{RankingRow, Scores};
use crate::report::charts::colours::colour;
use crate::report::charts::plane::Plane;
use scaleproof_plot::Anchor::Middle;
use scaleproof_plot::{BLACK, Drawing, Mark};

const HEIGHT: f64 = 130.0;
const WIDTH: f64 = 120.0;

/// Draws the AP of each texture here on the left, joined to that in the other sessions on the right.
pub(crate) fn chart(scores: &Scores, row: &RankingRow) -> Drawing {
    let plane = Plane {
        width: WIDTH,
        height: HEIGHT,
    };
    let all = scores.variants();
    let mut marks = plane.grid(-7.0, None);
    for own in &row.variants {
        let colour = all
            .iter()
            .position(|variant| *variant == own.variant)
            .map_or(BLACK, colour);
        let (here, there) = (plane.at(0.0, own.ap50), plane.at(1.0, own.other_ap50));
        marks.push(Mark::line(here, there, colour).outlined(colour, 2.0));
        marks.extend([here, there].map(|at| Mark::circle(at, 3.0).filled(colour)));
    }
    for (x, name) in [(0.0, "here"), (WIDTH, "there")] {
        marks.push(Mark::text([x, HEIGHT + 14.0], 10.0, Middle, BLACK, name));
    }
    marks.push(plane.upright_title(-29.0, "AP@0.5"));
    Drawing {
        area: [-42.0, -8.0, 186.0, 158.0],
        label: format!("AP@0.5 of each texture here and there, {}", scores.title(&row.detector)),
        marks,
    }
}
