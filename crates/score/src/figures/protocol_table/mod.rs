//! The table that a protocol's paper prints, filled from a run: its columns, its digits.

mod apricot;
mod armory;

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::evaluated::EvaluatedDetector;
use crate::figures::protocol_table::apricot::targeted_ap;
use crate::figures::protocol_table::armory::{armory_ap, armory_rates};
use crate::figures::thresholds::MATCH_IOU;
use crate::figures::{DetectorView, Protocol, ScoredPhoto, Scores, Summary, Thresholds, variants};
use scaleproof_core::ap::average_precision_as;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::spelling::digits;
use scaleproof_detect::Detection;

pub use crate::figures::protocol_table::apricot::targeted_ap as apricot_ap;
pub use crate::figures::protocol_table::armory::armory_rates as rates_as_armory;

/// The table of a protocol, as texts.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ProtocolTable {
    /// Name of the protocol; `source` names the publication or code that defines it.
    pub name: &'static str,
    pub source: &'static str,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

/// Returns the table of the run's protocol; `None` when it follows none.
pub fn protocol_table(scores: &Scores) -> Option<ProtocolTable> {
    let protocol = scores.criteria.protocol?;
    let (columns, rows) = match protocol {
        Protocol::Dta => by_texture(scores, ["AP@0.5", "confidence"], |s| {
            [digits(s.overall.ap50, 2), digits(s.overall.mean_confidence, 2)]
        }),
        Protocol::Active => by_texture(scores, ["AP@0.5, %", "found, %"], |s| {
            let [ap, found] = [s.overall.ap50, s.overall.hit_rate.rate].map(|share| 100.0 * share);
            [digits(ap, 1), significant(found)]
        }),
        Protocol::PaDetBench => (PADETBENCH.map(str::to_owned).to_vec(), padetbench(scores)),
        Protocol::Armory => (ARMORY.map(str::to_owned).to_vec(), rows(scores, armory)),
        Protocol::Apricot => (APRICOT.map(str::to_owned).to_vec(), rows(scores, apricot)),
    };
    Some(ProtocolTable {
        name: protocol.name(),
        source: protocol.source(),
        columns,
        rows,
    })
}

/// Fields of PADetBench's results.
const PADETBENCH: [&str; 6] = ["adv_type", "benchmark", "model_name", "mAP 50", "mAR 50", "ASR"];

const ARMORY: [&str; 8] = [
    "detector",
    "texture",
    "photos",
    "AP of the model's class",
    "disappearance rate",
    "hallucinations per image",
    "misclassification rate",
    "true positive rate",
];

const APRICOT: [&str; 6] = ["detector", "texture", "photos", "target", "targeted AP", "fooled"];

/// PADetBench's names of the plain model and of the whole set of photos.
const CLEAN: &str = "clean";
const ENTIRE: &str = "entire";

/// Name of the condition of imported photos that has the part of PADetBench they belong to.
const BENCHMARK: &str = "benchmark";

/// Returns columns for each detector, and a row for each texture.
fn by_texture(
    scores: &Scores,
    names: [&str; 2],
    cells: impl Fn(&Summary) -> [String; 2],
) -> (Vec<String>, Vec<Vec<String>>) {
    let own = scores.detectors.iter().map(|d| &d.manifest.title);
    let columns = own.flat_map(|title| names.map(|name| format!("{title} {name}")));
    let row = |variant: &String| {
        let of = |d: &EvaluatedDetector| {
            let summary = scores.summary(&d.manifest.name, variant);
            summary.map_or_else(|| names.map(|_| String::new()), &cells)
        };
        let cells = scores.detectors.iter().flat_map(of);
        [variant.clone()].into_iter().chain(cells).collect()
    };
    let columns = ["texture".to_owned()].into_iter().chain(columns).collect();
    (
        columns,
        variants(&scores.photos, &scores.base).iter().map(row).collect(),
    )
}

struct TexturePhotos<'a> {
    side: DetectorView<'a>,
    detector: &'a EvaluatedDetector,
    photos: Vec<&'a ScoredPhoto>,
}

impl TexturePhotos<'_> {
    fn mean(&self, of: impl Fn(&ScoredPhoto) -> f64) -> f64 {
        self.photos.iter().map(|p| of(p)).sum::<f64>() / self.photos.len() as f64
    }
}

/// Returns a row for each detector and texture: their names, the number of photos, and `cells`.
fn rows(scores: &Scores, cells: fn(&Scores, &TexturePhotos) -> Vec<String>) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for (side, detector) in DetectorView::each(&scores.detectors) {
        for variant in variants(&scores.photos, &scores.base) {
            let photos = scores.photos.iter().filter(|p| p.variant == variant).collect();
            let shown = TexturePhotos { side, detector, photos };
            let head = [detector.manifest.title.clone(), variant, shown.photos.len().to_string()];
            rows.push(head.into_iter().chain(cells(scores, &shown)).collect());
        }
    }
    rows
}

fn armory(scores: &Scores, shown: &TexturePhotos) -> Vec<String> {
    let (criteria, side) = (&scores.criteria, shown.side);
    let least = Thresholds {
        confidence: criteria.hit_confidence,
        iou: criteria.match_iou(),
    };
    let of = |p: &ScoredPhoto| armory_rates(&[(side.counted, p.truth)], &p.detections[side.detector], least);
    vec![
        armory_digits(armory_ap(&side.images(shown.photos.iter().copied()), least.iou)),
        digits(shown.mean(|p| of(p).disappearance), 2),
        digits(shown.mean(|p| of(p).hallucinations as f64), 2),
        digits(shown.mean(|p| of(p).misclassification), 2),
        digits(shown.mean(|p| of(p).true_positive), 2),
    ]
}

fn apricot<'a>(scores: &Scores, shown: &TexturePhotos<'a>) -> Vec<String> {
    let iou = scores.criteria.match_iou();
    let image = |p: &&'a ScoredPhoto| (p.truth, p.detections[shown.side.detector].as_slice());
    let images: Vec<(BoxPx, &[Detection])> = shown.photos.iter().map(image).collect();
    let strongest = shown.photos.iter().filter_map(|p| shown.side.outcome(p).other);
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for (label, _) in strongest {
        *counts.entry(label).or_default() += 1;
    }
    // The first of labels that are found equally often.
    let target = counts
        .into_iter()
        .reduce(|most, next| if next.1 > most.1 { next } else { most });
    let target = target.map(|(label, _)| label);
    let name = target.and_then(|label| shown.detector.labels().name(label));
    let fooled = shown.photos.iter().filter(|p| shown.side.outcome(p).other.is_some());
    vec![
        name.unwrap_or("–").to_owned(),
        target.map_or("–".to_owned(), |label| {
            armory_digits(targeted_ap(&images, label, iou))
        }),
        format!("{}/{}", fooled.count(), shown.photos.len()),
    ]
}

/// Returns a row for each detector, texture and part of the benchmark: all photos, the parts that their condition `benchmark` names, and the groups
/// of the run.
fn padetbench(scores: &Scores) -> Vec<Vec<String>> {
    let own = scores.photos.iter().filter_map(|p| p.conditions.get(BENCHMARK));
    let parts: BTreeSet<&String> = own.filter(|part| *part != ENTIRE).collect();
    let mut rows = Vec::new();
    for s in &scores.summaries {
        let Some(side) = DetectorView::named(&scores.detectors, &s.detector) else {
            continue;
        };
        let row = |benchmark: &str, ap: f64, mar: f64, asr: Option<f64>| {
            let adv_type = if s.variant == scores.base { CLEAN } else { &s.variant };
            let asr = asr.map_or(String::new(), |asr| digits(asr, 3));
            let names = [adv_type, benchmark, &s.detector].map(str::to_owned);
            names
                .into_iter()
                .chain([digits(ap, 3), digits(mar, 3), asr])
                .collect::<Vec<_>>()
        };
        let (all, asr) = (&s.overall, s.asr.and_then(|a| a.mar50));
        rows.push(row(ENTIRE, all.ap50, all.mar50, asr));
        for part in &parts {
            let figures = |variant: &str| part_figures(scores, side, variant, part);
            if let Some((ap, mar)) = figures(&s.variant) {
                let clean = figures(&scores.base).filter(|(_, clean)| *clean > 0.0 && s.variant != scores.base);
                rows.push(row(part, ap, mar, clean.map(|(_, clean)| 1.0 - mar / clean)));
            }
        }
        rows.extend(s.conditions.iter().map(|c| {
            let name = format!("{}={}", c.condition, c.value);
            row(&name, c.figures.ap50, c.figures.mar50, c.asr.and_then(|a| a.mar50))
        }));
    }
    rows
}

/// Returns AP and recall at IoU 0.5 of the photos of one part of the benchmark.
fn part_figures(scores: &Scores, side: DetectorView, variant: &str, part: &str) -> Option<(f64, f64)> {
    let own = |p: &&ScoredPhoto| p.variant == variant && p.conditions.get(BENCHMARK).is_some_and(|b| b == part);
    let images = side.images(scores.photos.iter().filter(own));
    let found = average_precision_as(scores.criteria.ap, &images, MATCH_IOU)?;
    Some((found.ap, found.recall))
}

/// Formats Armory's AP with two digits. Armory adds 1e-8 to the number that a precision is divided by: a five behind the last digit becomes less.
fn armory_digits(ap: f64) -> String {
    digits(ap * (1.0 - 1e-8), 2)
}

/// Formats three significant digits, one of them behind the point at least.
pub fn significant(value: f64) -> String {
    digits(value, if value < 10.0 { 2 } else { 1 })
}
