//! Experiments that were never made: confidences and hits of five detectors on plain photos, and on those of other rounds.

use rand_pcg::Pcg64Mcg;
use scaleproof_pose::simulate::normal;
use scaleproof_score::HIT_CONFIDENCE;

use crate::DETECTORS;
use crate::spread::Spread;

/// What a round does to a detector.
#[derive(Clone, Copy, PartialEq)]
pub enum Effect {
    Nothing,
    /// The confidence falls by so much.
    Falls(f64),
    /// Hits come nearer to the confidence of a hit, and all others to 0, so that the confidence falls while as many hits are lost as gained.
    FallsBesideHits,
}

/// A round of photos of the same views as the plain one.
#[derive(Clone)]
pub struct Round {
    pub effects: [Effect; DETECTORS],
    /// By how much all its confidences are lower, whatever the model wears: a cloud.
    pub cloud: f64,
}

/// A round minus the plain one: for each detector, by view.
pub struct Differences {
    pub confidence: Vec<Vec<f64>>,
    pub hits: Vec<Vec<f64>>,
}

/// One experiment. The confidence of a photo is the mean, plus what is hard about the view, plus what is hard about the photo, each in part for all detectors
/// alike, and cut to 0 … 1.
pub fn experiment(rng: &mut Pcg64Mcg, views: usize, spread: &Spread, rounds: &[Round]) -> Vec<Differences> {
    let mut all: Vec<Differences> = rounds.iter().map(|_| Differences::none(views)).collect();
    for view in 0..views {
        let hard_for_all = normal(rng);
        let photos_for_all: Vec<f64> = (0..=rounds.len()).map(|_| normal(rng)).collect();
        for detector in 0..DETECTORS {
            let hard = spread.view * shared(spread.view_shared, hard_for_all, normal(rng));
            let mut seen = |photo: usize, fall: f64| {
                let noise = spread.photo * shared(spread.photo_shared, photos_for_all[photo], normal(rng));
                (spread.mean - fall + hard + noise).clamp(0.0, 1.0)
            };
            let plain = seen(0, 0.0);
            for (i, round) in rounds.iter().enumerate() {
                let effect = round.effects[detector];
                let fall = if let Effect::Falls(fall) = effect { fall } else { 0.0 };
                let other = seen(i + 1, round.cloud + fall);
                all[i].confidence[detector][view] = nearer(effect, other) - plain;
                all[i].hits[detector][view] = hit(other) - hit(plain);
            }
        }
    }
    all
}

impl Differences {
    fn none(views: usize) -> Differences {
        let none = || vec![vec![0.0; views]; DETECTORS];
        Differences {
            confidence: none(),
            hits: none(),
        }
    }
}

/// Of standard deviation 1, with so much of its variance from what is shared.
fn shared(share: f64, common: f64, own: f64) -> f64 {
    share.sqrt() * common + (1.0 - share).sqrt() * own
}

fn hit(confidence: f64) -> f64 {
    f64::from(u8::from(confidence >= HIT_CONFIDENCE))
}

fn nearer(effect: Effect, confidence: f64) -> f64 {
    /// What is left of the way.
    const LEFT: f64 = 0.4;
    match effect {
        Effect::FallsBesideHits if confidence >= HIT_CONFIDENCE => {
            HIT_CONFIDENCE + LEFT * (confidence - HIT_CONFIDENCE)
        }
        Effect::FallsBesideHits => LEFT * confidence,
        Effect::Nothing | Effect::Falls(_) => confidence,
    }
}
