//! The figures of a finished evaluation.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::AttackError;
use scaleproof_core::files;
use scaleproof_core::message::{bail, ensure, message};
use scaleproof_pose::scene::Classes;

/// The figures of one detector on rendered photos with one pattern.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RenderedFigures {
    pub detector: String,
    /// Rendered photos with this pattern.
    pub photos: usize,
    /// AP@0.5 over these photos, and in `hit_rate` the share of them in which the model is found.
    pub ap50: f64,
    pub hit_rate: f64,
}

/// A pattern as `RenderPaint::identity` writes it; other paints have other keys there.
#[derive(Deserialize)]
struct Paint {
    name: String,
    sha256: String,
    tile_mm: f64,
}

#[derive(Deserialize)]
struct Summary {
    classes: Vec<String>,
    results: Vec<SummaryRow>,
}

#[derive(Deserialize)]
struct SummaryRow {
    detector: String,
    variant: String,
    overall: Overall,
}

#[derive(Deserialize)]
struct Overall {
    photos: usize,
    ap50: f64,
    hit_rate: Share,
}

#[derive(Deserialize)]
struct Share {
    rate: f64,
}

/// Reads the figures of the pattern with the content of this file, repeated every `tile_mm`, one entry for each detector. `classes`: the labels that
/// it was made for, where they are known.
pub fn figures_of(
    evaluation: &Path,
    pattern: &Path,
    tile_mm: f64,
    classes: Option<&Classes>,
) -> Result<Vec<RenderedFigures>, AttackError> {
    let summary = summary_of(evaluation)?;
    if let Some(classes) = classes.filter(|classes| classes.labels() != summary.classes) {
        bail!(
            "{} counted {} as the model, and {} was made for {classes}: evaluate it for the same",
            evaluation.display(), summary.classes.join(","), pattern.display();
            hint: "these are ‹class›"
        );
    }
    let sha256 = files::sha256_hex(&files::read(pattern)?);
    let variant = variant(evaluation, &sha256, tile_mm);
    let rows = summary.results.into_iter();
    let rows = rows.filter(|row| Some(&row.variant) == variant.as_ref());
    let figures = rows.map(|row| RenderedFigures {
        detector: row.detector,
        photos: row.overall.photos,
        ap50: row.overall.ap50,
        hit_rate: row.overall.hit_rate.rate,
    });
    let figures: Vec<RenderedFigures> = figures.collect();
    ensure!(
        !figures.is_empty(),
        "{} has no photos of {} repeated every {tile_mm} mm: add the pattern to the evaluation first",
        evaluation.display(),
        pattern.display()
    );
    Ok(figures)
}

fn summary_of(evaluation: &Path) -> Result<Summary, AttackError> {
    let path = evaluation.join("score").join("summary.json");
    let read = serde_json::from_str::<Summary>(&files::read_text(&path)?).map_err(|e| e.to_string());
    let possible = read.and_then(|summary| {
        let shares = |row: &SummaryRow| [("ap50", row.overall.ap50), ("hit_rate", row.overall.hit_rate.rate)];
        let mut all = summary.results.iter().flat_map(shares);
        match all.find(|(_, share)| !(0.0..=1.0).contains(share)) {
            Some((name, value)) => Err(format!("its {name} is {value}")),
            None => Ok(summary),
        }
    });
    let path = path.display();
    Ok(possible.map_err(|reason| message!("{path} is not of a finished evaluation ({reason})"))?)
}

/// Finds the name under which a pattern was rendered.
fn variant(evaluation: &Path, sha256: &str, tile_mm: f64) -> Option<String> {
    let folders = std::fs::read_dir(evaluation.join("session").join("photos")).ok()?;
    let paints = folders.flatten().filter_map(|folder| {
        let text = files::read_text(&folder.path().join("paint.json")).ok()?;
        serde_json::from_str::<Paint>(&text).ok()
    });
    let mut same = paints.filter(|paint| paint.sha256 == sha256 && paint.tile_mm == tile_mm);
    same.next().map(|paint| paint.name)
}
