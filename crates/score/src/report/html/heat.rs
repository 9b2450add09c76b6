//! Heat maps of the viewing directions: azimuth across, pitch and distance down, for each detector and texture.

use std::collections::BTreeSet;

use maud::{Markup, html};

use super::side;
use crate::report::number;
use crate::report::shade::{ink, shade};
use crate::score::{CellFigures, EvaluatedDetector, Scores, Summary};
use scaleproof_plot::Drawing;
use scaleproof_pose::scene::Bin;

const LEFT: f64 = 66.0;
const TOP: f64 = 26.0;
/// Width and height of a cell.
const CELL: (f64, f64) = (34.0, 28.0);
/// Of a texture's name above its rows.
const NAME: f64 = 17.0;
const GAP: f64 = 7.0;

/// What stands in a cell.
pub(in crate::report) const CELLS: &str = "In each cell mean confidence, hits / photos below; “–”: no photo";

/// A map for each detector, its textures below each other.
pub(super) fn maps(scores: &Scores) -> Markup {
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

/// The map of each detector, by its title; none where no photo is in a bin.
pub(in crate::report) fn charts(scores: &Scores) -> Vec<(&str, Drawing)> {
    let azimuths = scores.sessions[0].scene.bins.azimuth_centres();
    let rows = rows(scores);
    let all = scores.detectors.iter().filter(|_| !rows.is_empty());
    all.map(|c| (c.manifest.title.as_str(), map(scores, c, &azimuths, &rows)))
        .collect()
}

/// Some steps of the colour scale, with what they mean.
pub(in crate::report) fn legend() -> Vec<(String, String)> {
    let steps = [
        ("mean confidence 0", 0.0),
        ("0.25", 0.25),
        ("0.5", 0.5),
        ("0.75", 0.75),
        ("1", 1.0),
    ];
    steps.map(|(name, share)| (shade(share), name.to_owned())).to_vec()
}

/// A row of the maps: a bin without its azimuth.
fn row_of(bin: &Bin) -> Bin {
    Bin {
        azimuth_deg: 0.0,
        ..*bin
    }
}

/// Every pitch and distance that has photos, ascending.
fn rows(scores: &Scores) -> Vec<Bin> {
    let cells = scores.summaries.iter().flat_map(|s| &s.cells);
    let rows: BTreeSet<Bin> = cells.map(|c| row_of(&c.bin)).collect();
    rows.into_iter().collect()
}

fn map(scores: &Scores, detector: &EvaluatedDetector, azimuths: &[f64], rows: &[Bin]) -> Drawing {
    let own = scores.summaries.iter().filter(|s| s.detector == detector.manifest.name);
    let own: Vec<&Summary> = own.collect();
    let block = NAME + GAP + CELL.1 * rows.len() as f64;
    let width = LEFT + CELL.0 * azimuths.len() as f64 + 2.0;
    let height = TOP + block * own.len() as f64;
    let x = |column: usize| LEFT + CELL.0 * (column as f64 + 0.5);
    let marks = html! {
        @for (column, azimuth) in azimuths.iter().enumerate() {
            text x=(x(column)) y="11" font-size="9.5" text-anchor="middle" { (azimuth) "°" }
            @if azimuth % 90.0 == 0.0 {
                text x=(x(column)) y="21" font-size="8.5" text-anchor="middle" fill="#5b6573" { (side(*azimuth)) }
            }
        }
        @for (i, s) in own.iter().enumerate() {
            @let top = TOP + block * i as f64;
            text x="0" y=(top + 11.0) font-size="11" font-weight="600" { (s.variant) }
            @for (j, row) in rows.iter().enumerate() {
                @let y = top + NAME + CELL.1 * j as f64;
                text x=(LEFT - 5.0) y=(y + 12.0) font-size="9.5" text-anchor="end" { (row.pitch_deg) "°" }
                text x=(LEFT - 5.0) y=(y + 22.0) font-size="8.5" text-anchor="end" fill="#5b6573" { (row.distance_mm) " mm" }
                @for (column, azimuth) in azimuths.iter().enumerate() {
                    @let bin = Bin { azimuth_deg: *azimuth, ..*row };
                    (cell(s, &bin, x(column), y))
                }
            }
        }
    };
    Drawing {
        area: [0.0, 0.0, width, height],
        label: format!(
            "Mean confidence by azimuth, pitch and distance, {}",
            detector.manifest.title
        ),
        marks,
    }
}

fn cell(s: &Summary, bin: &Bin, x: f64, y: f64) -> Markup {
    let found = s.cells.iter().find(|c| c.bin == *bin);
    let (fill, text) = found.map_or(("#fff".to_owned(), "#5b6573"), |c| {
        let confidence = c.figures.mean_confidence;
        (shade(confidence), ink(confidence))
    });
    html! {
        g.cell {
            title { (title(s, bin, found)) }
            rect x=(x - CELL.0 / 2.0) y=(y) width=(CELL.0) height=(CELL.1) fill=(fill) stroke="#c3cad2" stroke-width="0.7" {}
            @match found {
                Some(c) => {
                    text x=(x) y=(y + 12.5) font-size="10.5" text-anchor="middle" fill=(text) { (number(c.figures.mean_confidence, 2)) }
                    text x=(x) y=(y + 23.0) font-size="8.5" text-anchor="middle" fill=(text) {
                        (c.figures.hit_rate.count) "/" (c.figures.photos)
                    }
                }
                None => { text x=(x) y=(y + 17.0) font-size="10.5" text-anchor="middle" fill=(text) { "–" } }
            }
        }
    }
}

/// Everything about a cell, for the pointer and for screen readers.
fn title(s: &Summary, bin: &Bin, found: Option<&CellFigures>) -> String {
    let place = format!(
        "{}, {}, {}° × {}° × {} mm",
        s.detector, s.variant, bin.azimuth_deg, bin.pitch_deg, bin.distance_mm
    );
    let Some(CellFigures { figures: f, .. }) = found else {
        return format!("{place}: no photo");
    };
    let r = &f.hit_rate;
    // One photo has no ranking.
    let ap50 = if f.photos > 1 {
        format!(", AP@0.5 {}", number(f.ap50, 3))
    } else {
        String::new()
    };
    format!(
        "{place}: mean confidence {}, {} hits of {} [{}, {}]{}",
        number(f.mean_confidence, 3),
        r.count,
        f.photos,
        number(r.low, 2),
        number(r.high, 2),
        ap50
    )
}
