//! Heat maps of the viewing directions: azimuth across, elevation and distance down.

use std::collections::BTreeSet;

use crate::evaluated::EvaluatedDetector;
use crate::figures::{CellFigures, Scores, Summary};
use crate::report::charts::shade::{ink, shade};
use crate::report::words::{number, side};
use scaleproof_plot::Anchor::{End, Middle, Start};
use scaleproof_plot::{BLACK, Colour, Drawing, Mark, NOTE, WHITE};
use scaleproof_pose::scene::Bin;

const LEFT: f64 = 66.0;
const TOP: f64 = 26.0;
/// Width and height of a cell.
const CELL: (f64, f64) = (34.0, 28.0);
/// Height of a texture's name above its rows.
const NAME: f64 = 17.0;
const GAP: f64 = 7.0;

/// Explanation of the cells.
pub(crate) const CELLS: &str = "In each cell mean confidence, hits / photos below; “–”: no photo";

/// Returns the map of each detector, by its title; none where no photo is in a bin.
pub(crate) fn charts(scores: &Scores) -> Vec<(&str, Drawing)> {
    let azimuths = scores.sessions[0].scene.bins.azimuth_centres();
    let rows = rows(scores);
    let all = scores.detectors.iter().filter(|_| !rows.is_empty());
    all.map(|c| (c.manifest.title.as_str(), map(scores, c, &azimuths, &rows)))
        .collect()
}

/// Returns some steps of the colour scale, with their meaning.
pub(crate) fn legend() -> Vec<(Colour, String)> {
    let steps = [
        ("mean confidence 0", 0.0),
        ("0.25", 0.25),
        ("0.5", 0.5),
        ("0.75", 0.75),
        ("1", 1.0),
    ];
    steps.map(|(name, share)| (shade(share), name.to_owned())).to_vec()
}

/// Returns the row of a bin: the bin at azimuth 0.
fn row_of(bin: &Bin) -> Bin {
    Bin {
        azimuth_deg: 0.0,
        ..*bin
    }
}

/// Returns every elevation and distance that has photos, ascending.
fn rows(scores: &Scores) -> Vec<Bin> {
    let cells = scores.summaries.iter().flat_map(|s| &s.cells);
    let rows: BTreeSet<Bin> = cells.map(|c| row_of(&c.bin)).collect();
    rows.into_iter().collect()
}

pub(crate) fn map(scores: &Scores, detector: &EvaluatedDetector, azimuths: &[f64], rows: &[Bin]) -> Drawing {
    let own = scores.summaries.iter().filter(|s| s.detector == detector.manifest.name);
    let own: Vec<&Summary> = own.collect();
    let block = NAME + GAP + CELL.1 * rows.len() as f64;
    let width = LEFT + CELL.0 * azimuths.len() as f64 + 2.0;
    let height = TOP + block * own.len() as f64;
    let x = |column: usize| LEFT + CELL.0 * (column as f64 + 0.5);
    let mut marks = Vec::new();
    for (column, azimuth) in azimuths.iter().enumerate() {
        let degrees = format!("{azimuth}°");
        marks.push(Mark::text([x(column), 11.0], 9.5, Middle, BLACK, degrees));
        if azimuth % 90.0 == 0.0 {
            marks.push(Mark::text([x(column), 21.0], 8.5, Middle, NOTE, side(*azimuth)));
        }
    }
    for (i, s) in own.iter().enumerate() {
        let top = TOP + block * i as f64;
        marks.push(Mark::text([0.0, top + 11.0], 11.0, Start, BLACK, &s.variant).bold());
        for (j, row) in rows.iter().enumerate() {
            let y = top + NAME + CELL.1 * j as f64;
            let [pitch, distance] = [format!("{}°", row.pitch_deg), format!("{} mm", row.distance_mm)];
            marks.push(Mark::text([LEFT - 5.0, y + 12.0], 9.5, End, BLACK, pitch));
            marks.push(Mark::text([LEFT - 5.0, y + 22.0], 8.5, End, NOTE, distance));
            for (column, &azimuth_deg) in azimuths.iter().enumerate() {
                let bin = Bin { azimuth_deg, ..*row };
                marks.push(Mark::group([x(column), y], cell(s, &bin)).titled(title(s, &bin)));
            }
        }
    }
    Drawing {
        area: [0.0, 0.0, width, height],
        label: format!(
            "Mean confidence by azimuth, pitch and distance, {}",
            detector.manifest.title
        ),
        marks,
    }
}

fn cell_figures<'a>(s: &'a Summary, bin: &Bin) -> Option<&'a CellFigures> {
    s.cells.iter().find(|c| c.bin == *bin)
}

/// Draws a cell; the middle of its upper edge is the origin.
fn cell(s: &Summary, bin: &Bin) -> Vec<Mark> {
    let area = Mark::rect([-CELL.0 / 2.0, 0.0], [CELL.0, CELL.1]).outlined(Colour(0xc3cad2), 0.7);
    let text = |y: f64, size: f64, colour: Colour, words: String| Mark::text([0.0, y], size, Middle, colour, words);
    let Some(CellFigures { figures: f, .. }) = cell_figures(s, bin) else {
        return vec![area.filled(WHITE), text(17.0, 10.5, NOTE, "–".to_owned())];
    };
    let ink = ink(f.mean_confidence);
    vec![
        area.filled(shade(f.mean_confidence)),
        text(12.5, 10.5, ink, number(f.mean_confidence, 2)),
        text(23.0, 8.5, ink, format!("{}/{}", f.hit_rate.count, f.photos)),
    ]
}

/// Returns all figures of a cell in words, for the pointer and for screen readers.
pub(crate) fn title(s: &Summary, bin: &Bin) -> String {
    let place = format!(
        "{}, {}, {}° × {}° × {} mm",
        s.detector, s.variant, bin.azimuth_deg, bin.pitch_deg, bin.distance_mm
    );
    let Some(CellFigures { figures: f, .. }) = cell_figures(s, bin) else {
        return format!("{place}: no photo");
    };
    let r = &f.hit_rate;
    // A single photo has no ranking, and so no AP.
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
