//! Conditions of a photo under which the detectors are run.

use std::sync::Arc;

use crate::error::ScoreError;
use crate::observe::Options;
use crate::robustness::Corruption;
use scaleproof_core::workers;
use scaleproof_detect::ProgramDefence;
use scaleproof_photo::defence::Defence;

/// A defence against patterns that changes the image alone.
#[derive(Debug, Clone)]
pub enum Defending {
    Published(Defence),
    Program(Arc<ProgramDefence>),
}

impl Defending {
    /// Returns the name by which it is chosen, without `exec:`.
    pub fn name(&self) -> String {
        match self {
            Self::Published(defence) => defence.name(),
            Self::Program(program) => program.card().name.clone(),
        }
    }
}

#[derive(Debug, Clone)]
pub(crate) enum Condition {
    /// Reduced, and not changed otherwise.
    Reduced,
    Worse(Corruption, u8),
    Defended(Defending),
}

impl Condition {
    /// Returns the name for messages.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Reduced => "no more than reduced".to_owned(),
            Self::Worse(kind, severity) => format!("{} {severity}", kind.name()),
            Self::Defended(defence) => defence.name(),
        }
    }
}

/// Computes a value for each condition, by its number, in parallel.
pub(crate) fn per_condition<T: Send>(
    options: &Options,
    count: usize,
    of: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, ScoreError> {
    let places: Vec<usize> = (0..count).collect();
    workers::map_over(options.threads, &places, || Ok(()), |(), at| Ok(of(*at)), || {})
}
