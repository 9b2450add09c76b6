//! Conditions of a photo under which the detectors are run.

use std::sync::Arc;

use crate::corrupt::Corruption;
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
pub(super) enum Condition {
    /// Reduced, and not changed otherwise.
    Reduced,
    Worse(Corruption, u8),
    Defended(Defending),
}

impl Condition {
    /// Returns the name for messages.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Reduced => "no more than reduced".to_owned(),
            Self::Worse(kind, severity) => format!("{} {severity}", kind.name()),
            Self::Defended(defence) => defence.name(),
        }
    }
}
