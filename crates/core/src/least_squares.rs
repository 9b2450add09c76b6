//! Levenberg–Marquardt (Marquardt 1963): one loop for every least-squares problem, dense or in blocks.

use crate::workers::interruption;

/// A least-squares problem, linearised at one point.
pub trait LeastSquares: Sized {
    /// Sum of the (weighted) squared residuals.
    fn cost(&self) -> f64;

    /// Returns the problem where a step leads, with the normal equations' diagonal raised by the factor 1 + `damping`. `None` when the
    /// equations have no solution, or when it leads out of the domain.
    fn stepped(&self, damping: f64) -> Option<Self>;
}

/// Stopping conditions.
pub struct Limits {
    pub first_damping: f64,
    /// Steps that are tried, those that are refused included.
    pub most_trials: usize,
    /// A step that changes the cost by less than this share of it is the last.
    pub relative_gain: f64,
    /// A step that lowers the cost by less than this is the last.
    pub absolute_gain: f64,
}

/// A step of this damping changes nothing any more.
const MOST_DAMPING: f64 = 1e9;
/// Costs that differ by less than this share of them are the same: the rest is rounding.
const ROUNDING: f64 = 1e-15;
/// Damping below the rounding of the equations has no effect.
const LEAST_DAMPING: f64 = 1e-12;

/// Returns the problem at the minimum near `start`: steps that raise the cost are refused and repeated with ten times the damping.
pub fn minimise<P: LeastSquares>(start: P, limits: &Limits) -> P {
    let (mut at, mut damping) = (start, limits.first_damping);
    for _ in 0..limits.most_trials {
        interruption::check();
        let cost = at.cost();
        let next = at.stepped(damping);
        let gain = next.as_ref().map_or(f64::NEG_INFINITY, |next| cost - next.cost());
        let is_last = if let (Some(next), true) = (next, gain >= 0.0) {
            (at, damping) = (next, (damping / 10.0).max(LEAST_DAMPING));
            gain <= limits.relative_gain.max(ROUNDING) * cost + limits.absolute_gain
        } else {
            damping *= 10.0;
            damping > MOST_DAMPING || -gain <= limits.relative_gain.max(ROUNDING) * cost
        };
        if is_last {
            break;
        }
    }
    at
}
