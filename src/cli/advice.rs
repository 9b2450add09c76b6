//! What to do about an error: the library says what is wrong, and the commands know their options.

use std::error::Error;

/// Advice on one error: what follows its sentence after a colon, or at once if it begins with a comma or a space. `None` where the sentence
/// says all.
pub(super) type Advise = fn(&(dyn Error + 'static)) -> Option<String>;

/// An error's sentence with the advice of the commands on it, or on what it wraps.
pub(super) fn sentence(error: &(dyn Error + 'static)) -> String {
    let mut wrapped = std::iter::successors(Some(error), |e| (*e).source());
    let on = |e| super::ADVICE.iter().copied().flatten().find_map(|advise| advise(e));
    match wrapped.find_map(on) {
        Some(advice) if advice.starts_with([',', ' ', ';']) => format!("{error}{advice}"),
        Some(advice) => format!("{error}: {advice}"),
        None => error.to_string(),
    }
}

#[cfg(test)]
#[path = "tests/advice.rs"]
mod tests;
