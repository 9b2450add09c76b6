//! The order of the textures here and in other sessions: a table, and a chart for each detector.

use maud::{Markup, html};

use super::{Plane, colour, colour_names, small_charts};
use crate::report::tables;
use crate::score::{RankingRow, Scores};
use scaleproof_plot::Drawing;

const HEIGHT: f64 = 130.0;
const WIDTH: f64 = 120.0;

/// `None` where it was not asked for.
pub(super) fn section(scores: &Scores) -> Option<Markup> {
    let ranking = scores.ranking.as_ref()?;
    let of_all = ranking.rows.iter().filter(|row| row.photos == "all");
    Some(html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(of_all.map(|row| (html! { (scores.title(&row.detector)) }, chart(scores, row)))))
        (tables::order(scores, ranking).markup())
    })
}

/// AP here on the left, there on the right.
fn chart(scores: &Scores, row: &RankingRow) -> Drawing {
    let plane = Plane {
        width: WIDTH,
        height: HEIGHT,
    };
    let (all, y) = (scores.variants(), |ap: f64| plane.y(ap));
    let marks = html! {
        (plane.grid(-7.0, None))
        @for own in &row.variants {
            @let colour = all.iter().position(|variant| *variant == own.variant).map_or("#000", colour);
            line x1="0" x2=(WIDTH) y1=(y(own.ap50)) y2=(y(own.other_ap50)) stroke=(colour) stroke-width="2" {}
            circle cx="0" cy=(y(own.ap50)) r="3" fill=(colour) {}
            circle cx=(WIDTH) cy=(y(own.other_ap50)) r="3" fill=(colour) {}
        }
        text x="0" y=(HEIGHT + 14.0) font-size="10" text-anchor="middle" { "here" }
        text x=(WIDTH) y=(HEIGHT + 14.0) font-size="10" text-anchor="middle" { "there" }
        (plane.upright_title(-29.0, "AP@0.5"))
    };
    Drawing {
        area: [-42.0, -8.0, 186.0, 158.0],
        label: format!("AP@0.5 of each texture here and there, {}", scores.title(&row.detector)),
        marks,
    }
}
