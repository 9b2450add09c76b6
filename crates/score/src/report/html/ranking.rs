//! The order of the textures here and in other sessions: a table, and a chart for each detector.

use maud::{Markup, html};

use super::{colour, number, round, variants};
use crate::report::ranking::{found, note, tau};
use crate::score::{RankingRow, Scores};
use scaleproof_plot::Drawing;

const HEIGHT: f64 = 130.0;
const WIDTH: f64 = 120.0;

/// `None` where it was not asked for.
pub(super) fn section(scores: &Scores) -> Option<Markup> {
    let ranking = scores.ranking.as_ref()?;
    Some(html! {
        ul.legend {
            @for (i, variant) in variants(scores).iter().enumerate() { li { i style=(format!("background:{}", colour(i))) {} (variant) } }
        }
        div.small-charts {
            @for row in ranking.rows.iter().filter(|row| row.photos == "all") {
                figure { (chart(scores, row).inline(None)) figcaption { (scores.title(&row.detector)) } }
            }
        }
        @if !ranking.rows.is_empty() { div.scroll {
            table {
                thead { tr { th { "detector" } @for name in ["photos", "order here, AP@0.5 (there)", "τ, 95 %", "finding"] { th.text { (name) } } } }
                tbody {
                    @for row in &ranking.rows {
                        tr {
                            td { (scores.title(&row.detector)) } td.text { (row.photos) }
                            td.wrap {
                                @for (i, own) in row.variants.iter().enumerate() {
                                    @if i > 0 { ", " }
                                    (own.variant) " " (number(own.ap50, 2)) " (" (number(own.other_ap50, 2)) ")"
                                }
                            }
                            td.text { (tau(row)) } td.text { (found(row)) }
                        }
                    }
                }
            }
        } }
        p.note { (note(ranking)) }
        @for caution in &ranking.cautions { p.note { "Note: " (caution) "." } }
    })
}

/// AP here on the left, there on the right.
fn chart(scores: &Scores, row: &RankingRow) -> Drawing {
    let y = |ap: f64| round((1.0 - ap) * HEIGHT);
    let all = variants(scores);
    let marks = html! {
        @for tick in [0.0, 0.5, 1.0] {
            line x1="0" x2=(WIDTH) y1=(y(tick)) y2=(y(tick)) stroke="#d7dce2" {}
            text x="-7" y=(y(tick) + 3.0) font-size="9" text-anchor="end" fill="#5b6573" { (tick) }
        }
        @for own in &row.variants {
            @let colour = all.iter().position(|variant| *variant == own.variant).map_or("#000", colour);
            line x1="0" x2=(WIDTH) y1=(y(own.ap50)) y2=(y(own.other_ap50)) stroke=(colour) stroke-width="2" {}
            circle cx="0" cy=(y(own.ap50)) r="3" fill=(colour) {}
            circle cx=(WIDTH) cy=(y(own.other_ap50)) r="3" fill=(colour) {}
        }
        text x="0" y=(HEIGHT + 14.0) font-size="10" text-anchor="middle" { "here" }
        text x=(WIDTH) y=(HEIGHT + 14.0) font-size="10" text-anchor="middle" { "there" }
        text transform=(format!("translate(-29 {}) rotate(-90)", HEIGHT / 2.0)) font-size="10" text-anchor="middle" { "AP@0.5" }
    };
    Drawing {
        area: [-42.0, -8.0, 186.0, 158.0],
        label: format!("AP@0.5 of each texture here and there, {}", scores.title(&row.detector)),
        marks,
    }
}
