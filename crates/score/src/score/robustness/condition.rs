//! What is done with a photo before the detectors look at it.

use std::sync::Arc;

use crate::score::corrupt::Corruption;
use scaleproof_detect::ProgramDefence;
use scaleproof_photo::defence::Defence;

/// A way to give back what a pattern took, in the image alone.
#[derive(Debug, Clone)]
pub enum Defending {
    Published(Defence),
    Program(Arc<ProgramDefence>),
}

impl Defending {
    /// As it is asked for, without `exec:`.
    pub fn name(&self) -> String {
        match self {
            Self::Published(defence) => defence.name(),
            Self::Program(program) => program.card().name.clone(),
        }
    }
}

#[derive(Debug, Clone)]
pub(super) enum Condition {
    /// No more than reduced.
    Reduced,
    Worse(Corruption, u8),
    Defended(Defending),
}

impl Condition {
    /// As messages say it.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Reduced => "no more than reduced".to_owned(),
            Self::Worse(kind, severity) => format!("{} {severity}", kind.name()),
            Self::Defended(defence) => defence.name(),
        }
    }
}
