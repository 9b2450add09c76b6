//! What a user of the command line does about an error of the attack's rooms.

use std::error::Error;

use crate::cli::advice;
use scaleproof_gradients::WhiteBoxError;

/// The option that helps.
pub(in crate::cli) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        WhiteBoxError::Program(error) => advice::on(error)?,
        WhiteBoxError::StrongestAlone { .. } => "leave --loss out",
    }
}
