//! The order of the textures here and in other sessions: a table, and a chart for each detector.

use maud::{Markup, html};

use crate::figures::{RankingRow, Scores};
use crate::report::html::{Plane, colour, colour_names, small_charts};
use crate::report::tables;
use scaleproof_plot::Anchor::Middle;
use scaleproof_plot::{BLACK, Drawing, Mark};

const HEIGHT: f64 = 130.0;
const WIDTH: f64 = 120.0;

/// Renders the section; `None` for a run without a ranking.
pub(super) fn section(scores: &Scores) -> Option<Markup> {
    let ranking = scores.ranking.as_ref()?;
    let of_all = ranking.rows.iter().filter(|row| row.photos == "all");
    Some(html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(of_all.map(|row| (html! { (scores.title(&row.detector)) }, chart(scores, row)))))
        (tables::order(scores, ranking).markup())
    })
}

/// Draws the AP of each texture here on the left, joined to that in the other sessions on the right.
fn chart(scores: &Scores, row: &RankingRow) -> Drawing {
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
