//! Number of views that show a drop of the mean confidence, by simulated experiments decided as a comparison is.

use std::iter;

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::compare::{LEVEL, missing};
use crate::plan::Spread;
use scaleproof_core::statistics::normal::TWO_SIDED_95;
use scaleproof_core::statistics::{EXACT_CLUSTERS, SEED, sign_flip_critical, sign_flip_p, sign_flip_statistic};
use scaleproof_pose::simulate::normal;

/// Reason why no number can be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    #[error(
        "the drop must lie above 0 and not above {most:.2}, the largest mean confidence of the plain model: it is {drop}"
    )]
    Drop { drop: f64, most: f64 },
    #[error("the least drop that matters, {least}, must not be above the drop that is planned for, {drop}")]
    Least { least: f64, drop: f64 },
    #[error("the power must lie from 0.5 to 0.99: it is {0}")]
    Power(f64),
    #[error("more than {MOST_VIEWS} views would be needed: such a drop is too small for photos")]
    TooMany,
}

/// Largest number of views that is planned.
pub(crate) const MOST_VIEWS: usize = 2000;
/// Number of simulated experiments behind each probability.
pub const PLAN_EXPERIMENTS: usize = 2000;
/// Seed of the experiments.
pub const PLAN_SEED: u64 = SEED;
/// Number of experiments whose critical statistics are averaged.
const CRITICALS: usize = 8;

/// Drop that is to be shown, and with which power, among how many detectors and textures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// Drop of one detector's mean confidence; the others, and other textures, are assumed to show nothing, which requires the most views.
    pub drop: f64,
    /// Probability with which it is to be shown.
    pub power: f64,
    pub detectors: usize,
    /// Number of textures besides the base.
    pub textures: usize,
    pub spread: Spread,
}

/// Number of views that show the drop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewsNeeded {
    pub views: usize,
    /// Share of the simulated experiments that show it.
    pub chance: f64,
    /// Half the width of the 95 % interval of `chance`.
    pub chance_error: f64,
}

impl Question {
    /// Returns the share of the error rate that a texture starts with.
    fn level(&self) -> f64 {
        LEVEL / self.textures.max(1) as f64
    }

    /// Returns the fewest views that can show anything, and the fewest places that can for places like these: 2 · 2⁻ⁿ is within the texture's share.
    pub fn fewest(&self) -> usize {
        missing(0, self.level())
    }

    /// Returns the fewest views, of some numbers that are the same for every question, that show the drop with the required power.
    ///
    /// All questions use the same random differences, and the bisection goes over the same numbers of views: a question whose drop fewer experiments
    /// show never gets fewer views.
    pub fn views_needed(&self) -> Result<ViewsNeeded, PlanError> {
        self.check()?;
        let numbers = numbers();
        let at = numbers.partition_point(|views| self.chance(*views) < self.power);
        let views = *numbers.get(at).ok_or(PlanError::TooMany)?;
        let chance = self.chance(views);
        let deviation = (chance * (1.0 - chance) / PLAN_EXPERIMENTS as f64).sqrt();
        Ok(ViewsNeeded {
            views,
            chance,
            chance_error: TWO_SIDED_95 * deviation,
        })
    }

    pub(crate) fn check(&self) -> Result<(), PlanError> {
        if !(self.drop > 0.0 && self.drop <= 1.0) {
            return Err(PlanError::Drop {
                drop: self.drop,
                most: 1.0,
            });
        }
        if !(0.5..=0.99).contains(&self.power) {
            return Err(PlanError::Power(self.power));
        }
        Ok(())
    }

    /// Returns the share of simulated experiments with so many views in which the flipped signs show the drop.
    pub fn chance(&self, views: usize) -> f64 {
        if views < self.fewest() {
            return 0.0;
        }
        // With many views the critical value hardly depends on the experiment.
        let critical = (views > EXACT_CLUSTERS).then(|| self.critical(views));
        let shows = |experiment: &usize| {
            let own = self.differences(*experiment, 0, self.drop, views);
            own.iter().sum::<f64>() > 0.0
                && match critical {
                    Some(critical) => sign_flip_statistic(&own) >= critical,
                    None => sign_flip_p(&self.beside_others(own, *experiment))[0] <= self.level(),
                }
        };
        (0..PLAN_EXPERIMENTS).filter(shows).count() as f64 / PLAN_EXPERIMENTS as f64
    }

    fn critical(&self, views: usize) -> f64 {
        let of = |experiment| {
            let own = self.differences(experiment, 0, self.drop, views);
            sign_flip_critical(&self.beside_others(own, experiment), self.level())
        };
        (0..CRITICALS).map(of).sum::<f64>() / CRITICALS as f64
    }

    fn beside_others(&self, own: Vec<f64>, experiment: usize) -> Vec<Vec<f64>> {
        let others = (1..self.detectors).map(|other| self.differences(experiment, other, 0.0, own.len()));
        let others: Vec<Vec<f64>> = others.collect();
        iter::once(own).chain(others).collect()
    }

    fn differences(&self, experiment: usize, detector: usize, drop: f64, views: usize) -> Vec<f64> {
        self.view_by_view(experiment, detector, drop).take(views).collect()
    }

    /// Returns a detector's differences, base minus texture, without end: normal about the drop, with a part of each view that all detectors share.
    pub(crate) fn view_by_view(&self, experiment: usize, detector: usize, drop: f64) -> impl Iterator<Item = f64> {
        let Spread {
            deviation, correlation, ..
        } = self.spread;
        let (common, own) = (correlation.sqrt(), (1.0 - correlation).sqrt());
        let [mut of_view, mut of_detector] = [0, detector + 1].map(|series| stream(experiment, series));
        iter::repeat_with(move || {
            let peculiar = common * normal(&mut of_view) + own * normal(&mut of_detector);
            (drop + deviation * peculiar).clamp(-1.0, 1.0)
        })
    }
}

fn stream(experiment: usize, series: usize) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(PLAN_SEED + ((experiment as u64) << 32) + series as u64)
}

/// Returns each number of views up to 32, then in steps of a sixteenth.
fn numbers() -> Vec<usize> {
    let next = |views: &usize| Some(views + (views / 16).max(1));
    iter::successors(Some(1), next)
        .take_while(|views| *views <= MOST_VIEWS)
        .collect()
}
