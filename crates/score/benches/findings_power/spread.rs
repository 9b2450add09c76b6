//! By how much confidences vary, and how much of it detectors share, estimated from photos of two textures.

use std::path::Path;

use scaleproof_detect::Manifest;
use scaleproof_score::{Options, Scores, evaluated_detectors, paired_photos, score};
use scaleproof_session::Session;

use crate::DETECTORS;

/// The mean confidence of plain photos, and what it varies by.
#[derive(Clone, Copy)]
pub struct Spread {
    pub mean: f64,
    /// Standard deviation from view to view.
    pub view: f64,
    /// Standard deviation in each photo.
    pub photo: f64,
    /// The share of the variance from view to view that all detectors have in common.
    pub view_shared: f64,
    /// The share of the variance in each photo that all detectors have in common.
    pub photo_shared: f64,
}

/// Of each detector, by view.
type Confidences = Vec<Vec<f64>>;

impl Spread {
    /// That of the plain photos of a session and of those in a random pattern, by its recorded detections.
    ///
    /// With v² the variance from view to view and w² that in each photo, a plain confidence has the variance v² + w², and a difference of two photos of a view 2 w²;
    /// the covariances of two detectors are those of the shared parts. What the pattern does differently in different views counts with w². Variances are
    /// means over the detectors, covariances over pairs of them.
    pub fn of_session(folder: &Path) -> Spread {
        let scores = scored(folder);
        let pairs = paired_photos(&scores, "normal", "random");
        let of = |figure: &dyn Fn(usize, usize) -> f64| -> Confidences {
            let views = |k: usize| (0..pairs.len()).map(|v| figure(k, v)).collect();
            (0..scores.detectors.len()).map(views).collect()
        };
        let plain = of(&|k, v| pairs[v].0.outcomes[k].confidence);
        let fallen = of(&|k, v| pairs[v].0.outcomes[k].confidence - pairs[v].1.outcomes[k].confidence);
        let (all, own) = (variance(&plain), variance(&fallen) / 2.0);
        let (all_shared, own_shared) = (covariance(&plain), covariance(&fallen) / 2.0);
        let view = (all - own).max(0.0);
        let share = |part: f64, of: f64| if of > 0.0 { (part / of).clamp(0.0, 1.0) } else { 0.0 };
        Spread {
            mean: mean(&plain.iter().map(|views| mean(views)).collect::<Vec<_>>()),
            view: view.sqrt(),
            photo: own.sqrt(),
            view_shared: share(all_shared - own_shared, view),
            photo_shared: share(own_shared, own),
        }
    }

    pub fn in_words(&self) -> String {
        format!(
            "plain {:.2}, {:.3} from view to view ({:.2} of the variance shared), {:.3} in each photo ({:.2} shared)",
            self.mean, self.view, self.view_shared, self.photo, self.photo_shared
        )
    }
}

/// A session by what it has recorded.
fn scored(folder: &Path) -> Scores {
    let sessions = vec![Session::open(folder).unwrap()];
    let recorded = |m: &Manifest| folder.join(format!("recorded/{}.json", m.name)).exists();
    let manifests = Manifest::all().unwrap().into_iter().filter(recorded).collect();
    let detectors = evaluated_detectors(&sessions, manifests, None).unwrap();
    assert_eq!(detectors.len(), DETECTORS, "detections of {}", folder.display());
    score(sessions, detectors, &Options::default(), || {}).unwrap()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn covariance_of(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let products = a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b));
    products.sum::<f64>() / (a.len() - 1) as f64
}

/// Mean over the detectors.
fn variance(all: &Confidences) -> f64 {
    mean(&all.iter().map(|own| covariance_of(own, own)).collect::<Vec<_>>())
}

/// Mean over the pairs of detectors.
fn covariance(all: &Confidences) -> f64 {
    let pairs = (0..all.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    mean(&pairs.map(|(i, j)| covariance_of(&all[i], &all[j])).collect::<Vec<_>>())
}
