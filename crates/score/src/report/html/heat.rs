//! Heat maps of the viewing directions, with their legend.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::charts::heat::{CELLS, charts};
use crate::report::charts::shade::shade;

/// Renders a map for each detector, its textures below each other.
pub(crate) fn maps(scores: &Scores) -> Markup {
    let is_wide = scores.sessions[0].scene.bins.azimuth_centres().len() > 12;
    let maps = charts(scores);
    html! {
        @if !maps.is_empty() {
            h3 { "Azimuth × pitch × distance" }
            div.scale {
                span { "mean confidence 0" }
                @for step in 0..=10 { i style=(format!("background:{}", shade(f64::from(step) / 10.0))) {} }
                span { "1" }
            }
            div.maps {
                @for (title, map) in maps {
                    figure.wide[is_wide] { figcaption { (title) } div.scroll { (map.inline(None)) } }
                }
            }
            p.note {
                (CELLS) ". Rows: pitch and distance at model scale, those that have "
                "photos. AP and intervals per cell are in figures.csv."
            }
        }
    }
}
