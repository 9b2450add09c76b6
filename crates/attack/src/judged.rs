//! Patterns judged on every view of some frames, compared with the plain model.

use schemars::JsonSchema;
use serde::Serialize;

use super::run::Rgb;
use super::run::augmentation::Augmentation;
use super::run::judge::{ViewDetections, detect};
use super::setup::Setup;
use crate::AttackError;
use scaleproof_core::statistics::intervals_95;
use scaleproof_pose::scene::Viewpoint;

/// Figures of a pattern and a detector.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Row")]
pub struct JudgedPattern {
    pub detector: String,
    pub pattern: String,
    /// Over all views, as predicted, like the next two.
    pub ap50: f64,
    pub hit_rate: f64,
    pub mean_confidence: f64,
    pub worst_direction: WorstDirection,
    /// By how much the confidence is below that of the plain model in the same views, in the mean.
    pub drop: f64,
    /// Its 95 % interval over the views.
    pub drop_95: Option<[f64; 2]>,
}

/// Of eight directions around the model, the one in which it is seen best.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub struct WorstDirection {
    /// Its middle.
    pub azimuth_deg: f64,
    pub mean_confidence: f64,
}

/// Name and cells (sRGB, 0 to 1) of a pattern.
pub type NamedCells = (String, Vec<Rgb>);

/// Directions around the model, the first about the front.
const SECTORS: usize = 8;

/// Judges named patterns, the plain model first; detector by detector. `on_image` is called after each image, from any thread.
pub fn judged(
    setup: &Setup,
    patterns: &[NamedCells],
    on_image: impl Fn() + Sync,
) -> Result<Vec<JudgedPattern>, AttackError> {
    let view_set = &setup.view_set;
    let views: Vec<usize> = (0..view_set.views.len()).collect();
    let seen = |(_, cells): &NamedCells| {
        detect(view_set, &setup.detectors, &views, |view| {
            on_image();
            let textured = view_set.textured(view, cells, &Augmentation::NONE);
            Ok(textured.augmented.image)
        })
    };
    let seen = patterns.iter().map(seen).collect::<Result<Vec<_>, _>>()?;
    let (mut rows, sectors) = (Vec::new(), sectors(setup));
    for (d, detector) in setup.detectors.iter().enumerate() {
        for ((pattern, _), by) in patterns.iter().zip(&seen) {
            let (drop, drop_95) = mean_drop(&seen[0][d], &by[d]);
            rows.push(JudgedPattern {
                detector: detector.name().to_owned(),
                pattern: pattern.clone(),
                ap50: by[d].ap50(),
                hit_rate: by[d].hit_rate(),
                mean_confidence: by[d].mean_confidence(),
                worst_direction: worst(&sectors, &by[d].confidences),
                drop,
                drop_95,
            });
        }
    }
    Ok(rows)
}

/// Returns the direction of each view.
fn sectors(setup: &Setup) -> Vec<usize> {
    let step = 360.0 / SECTORS as f64;
    let views = setup.view_set.views.iter().map(|view| {
        let camera_mm = view.frame.pose().inverse().translation.vector.into();
        let azimuth_deg = Viewpoint::from_camera(camera_mm, Default::default()).azimuth_deg;
        (azimuth_deg / step).round().rem_euclid(SECTORS as f64) as usize
    });
    views.collect()
}

/// Returns the sector in which the model is seen best.
fn worst(sectors: &[usize], confidences: &[f64]) -> WorstDirection {
    let direction = |sector: usize| {
        let inside = sectors.iter().zip(confidences).filter(|(s, _)| **s == sector);
        let (sum, n) = inside.fold((0.0, 0), |(sum, n), (_, c)| (sum + c, n + 1));
        (n > 0).then(|| WorstDirection {
            azimuth_deg: sector as f64 * 360.0 / SECTORS as f64,
            mean_confidence: sum / f64::from(n),
        })
    };
    let directions = (0..SECTORS).filter_map(direction);
    let worst = directions.max_by(|a, b| a.mean_confidence.total_cmp(&b.mean_confidence));
    worst.unwrap_or_default()
}

/// Returns the mean drop of confidence from that in the plain model, and its 95 % interval over the views.
fn mean_drop(plain: &ViewDetections, seen: &ViewDetections) -> (f64, Option<[f64; 2]>) {
    let both = plain.confidences.iter().zip(&seen.confidences);
    let differences: Vec<f64> = both.map(|(a, b)| a - b).collect();
    let mean = |weights: &[u32]| {
        let weighted = differences.iter().zip(weights).map(|(d, w)| d * f64::from(*w));
        weighted.sum::<f64>() / f64::from(weights.iter().sum::<u32>().max(1))
    };
    let [interval] = intervals_95(differences.len(), |weights| [mean(weights)]);
    let all = mean(&vec![1; differences.len()]);
    (all, interval.map(|interval| [interval.low, interval.high]))
}
