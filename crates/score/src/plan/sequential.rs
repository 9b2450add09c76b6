//! Number of views that a sequential comparison takes, by simulation.

use serde::Serialize;

use crate::compare::LEVEL;
use crate::plan::views_needed::MOST_VIEWS;
use crate::plan::{PLAN_EXPERIMENTS, PlanError, Question};
use scaleproof_core::statistics::{Sequence, Shown};

/// Multiples of the planned drop that are simulated as the real one.
const REAL: [f64; 5] = [0.0, 0.5, 1.0, 1.5, 2.0];

/// Number of simulations at most: one for each real drop, and one for the most views before them.
pub const SEQUENTIAL_ROWS: usize = REAL.len() + 1;

/// Expected course of a comparison that is looked at after each view and stops when it knows.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SequentialPlan {
    /// The drop that matters; `null` where none is named.
    pub least: Option<f64>,
    /// The most views that are taken: within them the drop is shown with the power asked for.
    pub most_views: usize,
    pub table: Vec<Expected>,
}

/// Outcome of experiments with one real drop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Expected {
    /// The drop of the mean confidence that is simulated.
    pub real_drop: f64,
    /// Share of the experiments that show a drop; `rise_shown`, `less_than_least_shown` and `undecided` are the other shares.
    pub drop_shown: f64,
    pub rise_shown: f64,
    pub less_than_least_shown: f64,
    pub undecided: f64,
    /// Mean number of views until it stops.
    pub mean_views: f64,
}

/// Plans for one detector's drop, decided at the strictest step of the correction for all detectors and textures; a place has `directions`
/// directions.
pub fn sequential_plan(
    question: &Question,
    least: Option<f64>,
    directions: usize,
    on_row: impl Fn(),
) -> Result<SequentialPlan, PlanError> {
    question.check()?;
    if let Some(least) = least.filter(|least| *least > question.drop) {
        let drop = question.drop;
        return Err(PlanError::Least { least, drop });
    }
    let looks = Looks {
        question,
        least,
        directions: directions.max(1),
    };
    let shown_after = |(shown, after): Stopped| match shown {
        Some(Shown::Above) => after,
        _ => usize::MAX,
    };
    let mut shown: Vec<usize> = looks
        .ends(question.drop, MOST_VIEWS)
        .into_iter()
        .map(shown_after)
        .collect();
    on_row();
    shown.sort_unstable();
    let most_views = shown[(question.power * PLAN_EXPERIMENTS as f64).ceil() as usize - 1];
    if most_views > MOST_VIEWS {
        return Err(PlanError::TooMany);
    }
    // The rounding error of the product is removed.
    let real = REAL.map(|times| (times * question.drop * 1e9).round() / 1e9);
    let row = |real: f64| {
        let row = expected(real, &looks.ends(real, most_views));
        on_row();
        row
    };
    Ok(SequentialPlan {
        least,
        most_views,
        table: real.into_iter().filter(|real| *real <= 1.0).map(row).collect(),
    })
}

/// First finding, and the number of views until then; `None` after all of them.
type Stopped = (Option<Shown>, usize);

struct Looks<'a> {
    question: &'a Question,
    least: Option<f64>,
    directions: usize,
}

impl Looks<'_> {
    fn ends(&self, drop: f64, most: usize) -> Vec<Stopped> {
        (0..PLAN_EXPERIMENTS)
            .map(|experiment| self.end(experiment, drop, most))
            .collect()
    }

    fn end(&self, experiment: usize, drop: f64, most: usize) -> Stopped {
        let tests = self.question.detectors * self.question.textures;
        let mut sequence = Sequence::new(self.directions, self.least).among(tests);
        let differences = self.question.view_by_view(experiment, 0, drop).take(most);
        for (view, difference) in differences.enumerate() {
            sequence.see(view % self.directions, difference);
            let is_shown = sequence.p() * (tests as f64) < LEVEL;
            let shown = match () {
                () if is_shown && sequence.is_above() => Shown::Above,
                () if is_shown => Shown::Below,
                () if sequence.less_after().is_some() => Shown::LessThanLeast,
                () => continue,
            };
            return (Some(shown), view + 1);
        }
        (None, most)
    }
}

fn expected(real_drop: f64, ends: &[Stopped]) -> Expected {
    let share = |of: Option<Shown>| ends.iter().filter(|end| end.0 == of).count() as f64 / ends.len() as f64;
    Expected {
        real_drop,
        drop_shown: share(Some(Shown::Above)),
        rise_shown: share(Some(Shown::Below)),
        less_than_least_shown: share(Some(Shown::LessThanLeast)),
        undecided: share(None),
        mean_views: ends.iter().map(|end| end.1 as f64).sum::<f64>() / ends.len() as f64,
    }
}
