//! Smallest drop of the mean confidence that photos like the given ones would have shown.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use scaleproof_core::statistics::{EXACT_CLUSTERS, SEED, sign_flip_critical, sign_flip_p, sign_flip_statistic};

/// Number of simulated experiments behind each drop that is tried.
const EXPERIMENTS: usize = 200;
/// Probability with which the drop is to be shown.
const POWER: f64 = 0.8;

/// Returns the smallest drop of one detector's mean confidence, in steps of 0.01, that is shown with a probability of 0.8 by as many views, whose
/// differences scatter as these do; `None` where not even a drop of 1 is.
///
/// `differences[k][c]` are those of detector `k`, summed over the `pairs[c]` pairs of a view. In an experiment each view's deviations from the means keep or
/// change their sign, for all detectors together; the others keep their mean difference, and `own` gets the drop that is tried.
pub(crate) fn drop_shown_from(differences: &[Vec<f64>], pairs: &[f64], own: usize, level: f64) -> Option<f64> {
    let spread = Spread::of(differences, pairs, own);
    // With many views the critical value hardly depends on the experiment.
    let critical = (pairs.len() > EXACT_CLUSTERS).then(|| sign_flip_critical(differences, level));
    let is_shown = |experiment: &Vec<Vec<f64>>| match critical {
        Some(critical) => sign_flip_statistic(&experiment[own]) >= critical,
        None => sign_flip_p(experiment)[own] <= level,
    };
    let shows = |percent: &u32| {
        let drop = f64::from(*percent) / 100.0;
        let mut rng = Pcg64Mcg::seed_from_u64(SEED);
        let shown = (0..EXPERIMENTS).filter(|_| is_shown(&spread.experiment(drop, &mut rng)));
        shown.count() as f64 >= POWER * EXPERIMENTS as f64
    };
    // The larger the drop, the more probably it is shown.
    let drops: Vec<u32> = (1..=100).collect();
    let first = drops.partition_point(|percent| !shows(percent));
    drops.get(first).map(|percent| f64::from(*percent) / 100.0)
}

/// Scatter of differences about their means.
struct Spread<'a> {
    /// Mean difference of a pair, by detector.
    means: Vec<f64>,
    /// Deviations from the mean, by detector and view.
    deviations: Vec<Vec<f64>>,
    pairs: &'a [f64],
    own: usize,
}

impl<'a> Spread<'a> {
    fn of(differences: &[Vec<f64>], pairs: &'a [f64], own: usize) -> Spread<'a> {
        let all: f64 = pairs.iter().sum();
        let means: Vec<f64> = differences.iter().map(|d| d.iter().sum::<f64>() / all).collect();
        let deviations = differences
            .iter()
            .zip(&means)
            .map(|(d, mean)| d.iter().zip(pairs).map(|(d, pairs)| d - mean * pairs).collect());
        Spread {
            deviations: deviations.collect(),
            means,
            pairs,
            own,
        }
    }

    fn experiment(&self, drop: f64, rng: &mut Pcg64Mcg) -> Vec<Vec<f64>> {
        let signs: Vec<f64> = self
            .pairs
            .iter()
            .map(|_| if rng.random() { 1.0 } else { -1.0 })
            .collect();
        let of = |(k, deviations): (usize, &Vec<f64>)| {
            let mean = if k == self.own { drop } else { self.means[k] };
            let views = deviations.iter().zip(&signs).zip(self.pairs);
            views
                .map(|((deviation, sign), pairs)| mean * pairs + sign * deviation)
                .collect()
        };
        self.deviations.iter().enumerate().map(of).collect()
    }
}
