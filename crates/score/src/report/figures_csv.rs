//! `figures.csv`: one line per detector, variant and group of photos: all of them, an azimuth, a cell, a place, a value of a condition.

use serde::Serialize;

use super::{ReportError, csv_of};
use crate::score::{Asr, Drop, Figures, Protocol, Rate, Scores, Summary};

#[derive(Serialize, Default)]
struct FigureRow<'a> {
    detector: &'a str,
    variant: &'a str,
    /// `all`, `azimuth`, `cell` (azimuth × pitch × distance), `place` or `condition`.
    group: &'static str,
    bin_azimuth_deg: Option<f64>,
    bin_pitch_deg: Option<f64>,
    bin_distance_mm: Option<f64>,
    place: &'a str,
    condition: &'a str,
    value: &'a str,
    photos: usize,
    protocol: &'static str,
    ap_definition: &'static str,
    ap50: Option<f64>,
    ap50_95: Option<f64>,
    mar50: Option<f64>,
    mar: Option<f64>,
    hit_confidence: f64,
    hits: Option<usize>,
    hit_rate: Option<f64>,
    hit_rate_low: Option<f64>,
    hit_rate_high: Option<f64>,
    misclassified: Option<usize>,
    misclassification_rate: Option<f64>,
    misclassification_rate_low: Option<f64>,
    misclassification_rate_high: Option<f64>,
    disappeared: Option<usize>,
    disappearance_rate: Option<f64>,
    disappearance_rate_low: Option<f64>,
    disappearance_rate_high: Option<f64>,
    hallucinations_per_image: Option<f64>,
    false_positives_per_image: Option<f64>,
    mean_confidence: Option<f64>,
    median_confidence: Option<f64>,
    drop_ap50: Option<f64>,
    drop_hit_rate: Option<f64>,
    drop_mean_confidence: Option<f64>,
    drop_median_confidence: Option<f64>,
    asr_ap50: Option<f64>,
    asr_mar50: Option<f64>,
    asr_hit_rate: Option<f64>,
}

pub(super) fn render(scores: &Scores) -> Result<String, ReportError> {
    csv_of(scores.summaries.iter().flat_map(|s| rows(scores, s)))
}

fn rows<'a>(scores: &'a Scores, s: &'a Summary) -> Vec<FigureRow<'a>> {
    let row = |group, figures, drop| FigureRow {
        detector: &s.detector,
        variant: &s.variant,
        group,
        protocol: scores.criteria.protocol.map_or("", Protocol::name),
        ap_definition: scores.criteria.ap.name(),
        hit_confidence: scores.criteria.hit_confidence,
        ..numbers(figures, drop)
    };
    let with_asr = |row: FigureRow<'a>, asr: Option<Asr>| FigureRow {
        asr_ap50: asr.and_then(|a| a.ap50),
        asr_mar50: asr.and_then(|a| a.mar50),
        asr_hit_rate: asr.and_then(|a| a.hit_rate),
        ..row
    };
    let all = with_asr(row("all", Some(&s.overall), s.drop), s.asr);
    let azimuths = s.azimuth_bins.iter().map(|b| FigureRow {
        bin_azimuth_deg: Some(b.azimuth_deg),
        ..row("azimuth", b.figures.as_ref(), b.drop)
    });
    let cells = s.cells.iter().map(|c| FigureRow {
        bin_azimuth_deg: Some(c.bin.azimuth_deg),
        bin_pitch_deg: Some(c.bin.pitch_deg),
        bin_distance_mm: Some(c.bin.distance_mm),
        ..row("cell", Some(&c.figures), c.drop)
    });
    let places = s.places.iter().map(|p| FigureRow {
        place: p.place.as_deref().unwrap_or_default(),
        ..row("place", Some(&p.figures), p.drop)
    });
    let conditions = s.conditions.iter().map(|c| FigureRow {
        condition: &c.condition,
        value: &c.value,
        ..with_asr(row("condition", Some(&c.figures), c.drop), c.asr)
    });
    let groups = azimuths.chain(cells).chain(places).chain(conditions);
    [all].into_iter().chain(groups).collect()
}

/// The columns of figures; a group without photos has none but its zero.
fn numbers<'a>(figures: Option<&Figures>, drop: Option<Drop>) -> FigureRow<'a> {
    let rate = |of: fn(&Figures) -> Rate| figures.map(of);
    let (hit, mis) = (rate(|f| f.hit_rate), rate(|f| f.misclassification_rate));
    let gone = rate(|f| f.disappearance_rate);
    FigureRow {
        photos: figures.map_or(0, |f| f.photos),
        ap50: figures.map(|f| f.ap50),
        ap50_95: figures.map(|f| f.ap50_95),
        mar50: figures.map(|f| f.mar50),
        mar: figures.map(|f| f.mar),
        hits: hit.map(|r| r.count),
        hit_rate: hit.map(|r| r.rate),
        hit_rate_low: hit.map(|r| r.low),
        hit_rate_high: hit.map(|r| r.high),
        misclassified: mis.map(|r| r.count),
        misclassification_rate: mis.map(|r| r.rate),
        misclassification_rate_low: mis.map(|r| r.low),
        misclassification_rate_high: mis.map(|r| r.high),
        disappeared: gone.map(|r| r.count),
        disappearance_rate: gone.map(|r| r.rate),
        disappearance_rate_low: gone.map(|r| r.low),
        disappearance_rate_high: gone.map(|r| r.high),
        hallucinations_per_image: figures.map(|f| f.hallucinations_per_image),
        false_positives_per_image: figures.map(|f| f.false_positives_per_image),
        mean_confidence: figures.map(|f| f.mean_confidence),
        median_confidence: figures.map(|f| f.median_confidence),
        drop_ap50: drop.map(|d| d.ap50),
        drop_hit_rate: drop.map(|d| d.hit_rate),
        drop_mean_confidence: drop.map(|d| d.mean_confidence),
        drop_median_confidence: drop.map(|d| d.median_confidence),
        ..FigureRow::default()
    }
}
