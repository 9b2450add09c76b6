//! A test and an interval of a mean that hold however often one looks, and whenever one stops.
//!
//! A betting martingale: a wealth of 1 is bet on numbers in [−1, 1], one after the other, that their mean is above `m`. Where it is not, no way of betting gains on
//! average, and the wealth ever reaches 1/α with a probability of α at most (Ville 1939; Waudby-Smith & Ramdas, "Estimating means of bounded
//! random variables by betting", Journal of the Royal Statistical Society B 86 (2024), sections 3 and 4). A bet at the rate λ multiplies the wealth by
//! 1 + λ (x − m) / (1 + m); the wealth is spread over fixed rates.
//!
//! That "no number differs from 0 on average" is tested after every number, in any order. An interval of the *mean over strata* (directions round a model, which differ) takes whole
//! rounds of one number a stratum: with fixed rates, the expected factor of a round is a product whose terms have a mean of 1 at most, and so is 1 at most itself (the
//! geometric mean is not above the arithmetic one), in whatever order the round was.

use super::Interval;

/// Largest probability of a wrong finding, half of it on either side.
const LEVEL: f64 = 0.05;

/// Number of rates over which the wealth is spread, evenly from 0 to 1.
const RATES: usize = 64;

/// The wealth of a bet that numbers are above `mean` on average (an e-value): its logarithm at each rate.
#[derive(Debug, Clone)]
struct EValue {
    mean: f64,
    ln: [f64; RATES],
}

impl EValue {
    /// Creates the e-value of no number yet; `mean` must be above −1.
    fn above(mean: f64) -> EValue {
        EValue { mean, ln: [0.0; RATES] }
    }

    fn bet(&mut self, number: f64) {
        let gain = (number - self.mean) / (1.0 + self.mean);
        for (i, ln) in self.ln.iter_mut().enumerate() {
            let rate = (i as f64 + 0.5) / RATES as f64;
            *ln += (rate * gain).ln_1p();
        }
    }

    fn ln_total(&self) -> f64 {
        let most = self.ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = self.ln.iter().map(|ln| (ln - most).exp()).sum();
        most + (sum / RATES as f64).ln()
    }
}

/// Finding of a sequential test on the mean of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Some lie above 0 on average.
    Above,
    /// Some lie below 0 on average.
    Below,
    /// Their mean over the strata is smaller than the least that matters.
    LessThanLeast,
}

/// Numbers in [−1, 1] that come one after the other, each of a stratum, and what they have shown so far.
#[derive(Debug, Clone)]
pub struct Sequence {
    up: EValue,
    down: EValue,
    /// Evidence that the least mean that matters is not reached.
    least: Option<EValue>,
    strata: Vec<Vec<f64>>,
    rounds: usize,
    numbers: usize,
    /// The most evidence so far for a mean on either side of 0, as a logarithm, and for which.
    most: f64,
    most_is_above: bool,
    /// The evidence that shows that the mean is below the least, as a logarithm, and after how many numbers it did.
    enough_for_less: f64,
    less_after: Option<usize>,
    shown: Option<(Shown, usize)>,
}

impl Sequence {
    /// Creates a test before the first number. `least` must lie in (0, 1).
    pub fn new(strata: usize, least: Option<f64>) -> Sequence {
        Sequence {
            up: EValue::above(0.0),
            down: EValue::above(0.0),
            least: least.map(|least| EValue::above(-least)),
            strata: vec![Vec::new(); strata],
            rounds: 0,
            numbers: 0,
            most: 0.0,
            most_is_above: true,
            enough_for_less: enough(),
            less_after: None,
            shown: None,
        }
    }

    /// Corrects for the number of tests that are decided together: "less than the least" takes that many times the evidence (Bonferroni).
    /// [`Sequence::p`] is of this test alone.
    pub fn among(mut self, tests: usize) -> Sequence {
        self.enough_for_less += (tests.max(1) as f64).ln();
        self
    }

    /// Takes the next number; what is shown first stays shown.
    pub fn see(&mut self, stratum: usize, number: f64) {
        self.numbers += 1;
        self.up.bet(number);
        self.down.bet(-number);
        self.strata[stratum].push(number);
        while self.strata.iter().all(|seen| seen.len() > self.rounds) {
            for seen in &self.strata {
                // Upside down: that the mean is below the least is that the negative is above its negative.
                self.least
                    .iter_mut()
                    .for_each(|e_value| e_value.bet(-seen[self.rounds]));
            }
            self.rounds += 1;
        }
        let [up, down] = [&self.up, &self.down].map(EValue::ln_total);
        for (evidence, is_above) in [(up, true), (down, false)] {
            if evidence > self.most {
                (self.most, self.most_is_above) = (evidence, is_above);
            }
        }
        let is_less = self
            .least
            .as_ref()
            .is_some_and(|least| least.ln_total() >= self.enough_for_less);
        self.less_after = self.less_after.or(is_less.then_some(self.numbers));
        let shown = match () {
            () if up >= enough() => Some(Shown::Above),
            () if down >= enough() => Some(Shown::Below),
            () if is_less => Some(Shown::LessThanLeast),
            () => None,
        };
        self.shown = self.shown.or(shown.map(|shown| (shown, self.numbers)));
    }

    /// Returns the first finding, and the number of values after which it was reached.
    pub fn shown(&self) -> Option<(Shown, usize)> {
        self.shown
    }

    /// Returns the number of values after which their mean over the strata was shown to be smaller than the least that matters.
    pub fn less_after(&self) -> Option<usize> {
        self.less_after
    }

    /// Returns true if the evidence behind [`Sequence::p`] is for a mean above 0, not below.
    pub fn is_above(&self) -> bool {
        self.most_is_above
    }

    /// Returns the two-sided p of "no number differs from 0 on average"; never above α by chance alone with a larger probability than α, over all looks.
    pub fn p(&self) -> f64 {
        (2.0 * (-self.most).exp()).min(1.0)
    }

    /// Returns the base-10 logarithm of what was won by betting on means above 0: from 1.6 (a factor of 40) on they are shown.
    pub fn log10_for_above(&self) -> f64 {
        self.up.ln_total() / std::f64::consts::LN_10
    }

    /// Returns the number of rounds in which every stratum has its number.
    pub fn rounds(&self) -> usize {
        self.rounds
    }

    /// Computes the 95 % interval of the mean over the strata, from whole rounds: all intervals after the rounds so far hold together with a probability of 95 %, and this is what
    /// they have in common. Absent before the first round is whole, and when they have nothing in common: then the rounds differ from each other.
    pub fn interval_95(&self) -> Option<Interval> {
        if self.rounds == 0 {
            return None;
        }
        let [low, high] = [self.bound(1.0), -self.bound(-1.0)];
        (low <= high).then_some(Interval { low, high })
    }

    /// Returns the largest mean that is refuted from above, of the numbers times `sign`.
    fn bound(&self, sign: f64) -> f64 {
        // The larger the mean, the less is won by betting on more.
        let (mut refuted, mut open) = (-1.0, 1.0);
        for _ in 0..30 {
            let mean = (refuted + open) / 2.0;
            if self.is_refuted(mean, sign) {
                refuted = mean
            } else {
                open = mean
            }
        }
        refuted
    }

    fn is_refuted(&self, mean: f64, sign: f64) -> bool {
        let mut e_value = EValue::above(mean);
        (0..self.rounds).any(|round| {
            self.strata.iter().for_each(|seen| e_value.bet(sign * seen[round]));
            e_value.ln_total() >= enough()
        })
    }
}

/// Returns the logarithm of the wealth that shows something.
fn enough() -> f64 {
    (2.0 / LEVEL).ln()
}
