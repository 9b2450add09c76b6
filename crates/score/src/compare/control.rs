//! Control, a second round of the base: effects no larger than the difference between the two rounds are withheld.

use crate::compare::{CompareError, pairs};
use crate::figures::{Compared, Control, Difference, Effect, Finding, Scores};
use scaleproof_core::message::bail;
use scaleproof_core::spelling;

/// Difference below which two drops count as equal.
const TIED: f64 = 1e-9;

impl Scores {
    /// Makes a variant the control: a second round of the base, which is no texture; effects no larger than its own are withheld. To be called after
    /// [`Scores::against`].
    ///
    /// # Errors
    /// It is the base or no variant; none of its photos pairs with one of the base; there is no texture beside it.
    pub fn controlled_by(mut self, control: Option<&str>) -> Result<Scores, CompareError> {
        if let Some(control) = control {
            check_control(&self.variants(), &self.base, control)?;
            if !pairs(self.set(), &self.base, control) {
                let (base, variant) = (self.base.clone(), control.to_owned());
                return Err(CompareError::NoPair { base, variant });
            }
        }
        self.control = control.map(str::to_owned);
        self.sum_up();
        Ok(self)
    }
}

/// Checks that one of these variants can be the control of some texture against a base.
pub fn check_control(variants: &[&str], base: &str, control: &str) -> Result<(), CompareError> {
    let others: Vec<&str> = variants.iter().copied().filter(|v| *v != base).collect();
    let similar = || spelling::hint(control, others.iter().copied());
    if control == base {
        let similar = similar();
        bail!(
            "the control is the base itself, `{base}`: it has to be a second plain round, under another name{similar}"
        );
    }
    if !others.contains(&control) {
        let (variants, similar) = (variants.join(", "), similar());
        bail!("no photo has the variant `{control}`, which is to be the control, only {variants}{similar}");
    }
    if others.len() == 1 {
        bail!("all photos have the variant `{base}` or that of its control, `{control}`: add those of a texture");
    }
    Ok(())
}

/// Withholds effects that are no larger than those of the control.
pub(crate) fn withhold(results: &mut [Compared], control: &Control) {
    for compared in results {
        let own = control.results.iter().find(|own| own.detector == compared.detector);
        let (Some(own), Some(finding)) = (own, compared.finding) else {
            continue;
        };
        compared.finding = Some(match remaining_effect(finding.effect, compared, own) {
            effect if effect == finding.effect => finding,
            effect => withheld(finding, effect),
        });
    }
}

/// Returns what remains of an effect: nothing where the mean confidence differs by no more than between the rounds of the base, in size; no *hides*
/// where the hit rate does.
fn remaining_effect(effect: Effect, compared: &Compared, control: &Compared) -> Effect {
    let is_no_larger = |of: fn(&Compared) -> &Difference| of(compared).drop.abs() <= of(control).drop.abs() + TIED;
    if effect.is_shown() && is_no_larger(|r| &r.mean_confidence) {
        Effect::NothingShown
    } else if effect == Effect::Hides && is_no_larger(|r| &r.hit_rate.rate) {
        Effect::Weakens
    } else {
        effect
    }
}

fn withheld(finding: Finding, effect: Effect) -> Finding {
    let like = finding
        .in_places_like_these
        .filter(|_| effect.is_shown())
        .map(|mut like| {
            if like.effect == Effect::Hides {
                like.effect = effect;
            }
            like
        });
    Finding {
        effect,
        withheld_by_control: Some(finding.effect),
        in_places_like_these: like,
        ..finding
    }
}
