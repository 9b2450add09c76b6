//! Errors that nobody tells apart: a sentence with place and cause, and a hint for whoever can mend it.
//!
//! An error is a variant of an enum where somebody matches it, and a [`Message`] where all that is ever done with it is to show it.
//!
//! ```
//! use scaleproof_core::message::{Hint, Message, message};
//!
//! fn started(seconds: u32) -> Result<(), Message> {
//!     if seconds > 60 {
//!         return Err(message!("no answer for {seconds} s").hint("give it more time by ‹detector_timeout›"));
//!     }
//!     Ok(())
//! }
//!
//! let error = started(61).unwrap_err();
//! assert_eq!(error.to_string(), "no answer for 61 s");
//! let hint = Hint::of(&error).unwrap();
//! let shown = hint.spelled(|setting| format!("--{}", setting.replace('_', "-")));
//! assert_eq!(shown, "give it more time by --detector-timeout");
//! ```

use std::error::Error;
use std::fmt::{self, Display, Formatter};

/// Error that nobody tells apart: what is wrong and where, perhaps with a hint and the error that caused it.
#[derive(Debug)]
pub struct Message {
    sentence: String,
    source: Option<Box<dyn Error + Send + Sync>>,
}

impl Message {
    /// Creates an error of one sentence: what is wrong, and where.
    pub fn new(sentence: impl Into<String>) -> Message {
        Message {
            sentence: sentence.into(),
            source: None,
        }
    }

    /// Adds what to do about the error, with settings in ‹guillemets› (see [`Hint`]).
    #[must_use]
    pub fn hint(self, text: impl Into<String>) -> Message {
        let hint = Hint {
            text: text.into(),
            cause: self.source,
        };
        Message {
            source: Some(Box::new(hint)),
            ..self
        }
    }

    /// Adds the error that caused this one, before any hint. Its sentence is not shown; its hint is, if this error has none.
    #[must_use]
    pub fn caused_by(self, cause: impl Error + Send + Sync + 'static) -> Message {
        Message {
            source: Some(Box::new(cause)),
            ..self
        }
    }
}

impl From<&str> for Message {
    fn from(sentence: &str) -> Message {
        Message::new(sentence)
    }
}

impl From<String> for Message {
    fn from(sentence: String) -> Message {
        Message::new(sentence)
    }
}

impl Display for Message {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}

impl Error for Message {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(self.source.as_deref()?)
    }
}

/// Remedy of an error, as one part of a sentence.
///
/// Settings stand in it by their names in the library, in guillemets: the command line shows `‹detector_timeout›` as `--detector-timeout`, and
/// Python as `detector_timeout=`. Among the sources of an error a hint comes right behind what it is about, so that enums with a transparent
/// variant and errors with another cause keep it.
#[derive(Debug)]
pub struct Hint {
    text: String,
    cause: Option<Box<dyn Error + Send + Sync>>,
}

impl Hint {
    /// Creates the hint of a variant of an enum, which names it as its source.
    pub fn new(text: impl Into<String>) -> Hint {
        Hint {
            text: text.into(),
            cause: None,
        }
    }

    /// Finds the first hint among an error and its sources.
    pub fn of<'a>(error: &'a (dyn Error + 'static)) -> Option<&'a Hint> {
        std::iter::successors(Some(error), |e| (*e).source()).find_map(|e| e.downcast_ref())
    }

    /// Returns the hint with each setting's name as `spell` spells it.
    pub fn spelled(&self, spell: impl Fn(&str) -> String) -> String {
        let mut parts = self.text.split('‹');
        let mut spelled = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            match part.split_once('›') {
                Some((setting, after)) => spelled += &(spell(setting) + after),
                None => spelled += part,
            }
        }
        spelled
    }
}

impl Display for Hint {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.spelled(str::to_owned))
    }
}

impl Error for Hint {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(self.cause.as_deref()?)
    }
}

/// Creates a [`Message`] of a sentence that is written as for `format!`.
#[macro_export]
macro_rules! message {
    ($($sentence:tt)*) => { $crate::message::Message::new(::std::format!($($sentence)*)) };
}

/// Returns from a function with a [`Message`], perhaps with a hint behind a semicolon: `bail!("no answer for {s} s"; hint: "wait")`.
#[macro_export]
macro_rules! bail {
    ($sentence:literal $(, $value:expr)* ; hint: $($hint:tt)+) => {
        return ::core::result::Result::Err($crate::message!($sentence $(, $value)*).hint(::std::format!($($hint)+)).into())
    };
    ($($sentence:tt)*) => { return ::core::result::Result::Err($crate::message!($($sentence)*).into()) };
}

/// Returns from a function with a [`Message`] where a condition does not hold, as [`bail!`](crate::bail) does: `ensure!(s < 60, "no answer for {s} s")`.
#[macro_export]
macro_rules! ensure {
    ($holds:expr, $($sentence:tt)+) => {
        if !$holds {
            $crate::bail!($($sentence)+)
        }
    };
}

pub use crate::{bail, ensure, message};
