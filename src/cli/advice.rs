//! Advice on errors: the library says what is wrong, and the program, which knows its options, what to do.

use std::error::Error;
use std::ffi::OsStr;
use std::path::Path;

use scaleproof_core::files;
use scaleproof_core::message::Hint;
use scaleproof_core::spelling::quoted;
use scaleproof_print::output::OutputError;
use scaleproof_print::paint::PaintError;
use scaleproof_print::tags::{Instead, TagPrintError};
use scaleproof_print::template::TemplateError;
use scaleproof_score::CompareError;
use scaleproof_surface::mesh::MeshError;
use scaleproof_surface::pattern::PatternError;
use scaleproof_surface::texture::TextureError;

/// Advice on one error: what follows its sentence after a colon, or at once if it begins with a comma, a semicolon or a space. `None` where
/// the sentence says all.
pub(super) type Advise = fn(&(dyn Error + 'static)) -> Option<String>;

/// The advice of the first kind of error that this one is.
macro_rules! advice_by_kind {
    ($error:ident, $($kind:pat $(if $guard:expr)? => $advice:expr,)+) => {{
        $(if let Some($kind) = $error.downcast_ref() $(&& $guard)? {
            return Some($advice.into());
        })+
        None
    }};
}

/// Returns what is wrong and what to do about it in one sentence, for a list or a file.
pub(super) fn sentence(error: &(dyn Error + 'static)) -> String {
    match hint(error) {
        Some(hint) => format!("{}; {hint}", advised(error)),
        None => advised(error),
    }
}

/// Prints what is wrong, and the hint on a line of its own.
pub(super) fn say(error: &(dyn Error + 'static)) {
    say!("error: {}", advised(error));
    if let Some(hint) = hint(error) {
        say!("hint: {hint}");
    }
}

/// Returns the error's hint with settings spelled as options: `‹detector_timeout›` is `--detector-timeout`.
fn hint(error: &(dyn Error + 'static)) -> Option<String> {
    Some(Hint::of(error)?.spelled(|setting| format!("--{}", setting.replace('_', "-"))))
}

/// An error's sentence with the advice on it, or on what it wraps.
fn advised(error: &(dyn Error + 'static)) -> String {
    let mut wrapped = std::iter::successors(Some(error), |e| (*e).source());
    let on_more = |e| super::MORE_ADVICE.iter().find_map(|advise| advise(e));
    match wrapped.find_map(|e| on(e).or_else(|| on_more(e))) {
        Some(advice) if advice.starts_with([',', ' ', ';']) => format!("{error}{advice}"),
        Some(advice) => format!("{error}: {advice}"),
        None => error.to_string(),
    }
}

/// The advice on an error that a program of any features has. Errors that say only what they wrap have none of their own.
pub(super) fn on(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        CompareError::NoBase { .. } => "name one of these with --base",
        MeshError::NoModel { .. } => " (--length-mm)",
        MeshError::LifeSize { .. } => "; the option is --length-mm",
        PatternError::TooManyCells { path, .. } => to_import(path),
        PatternError::NotPng { path } if path.extension().is_some_and(is_jpeg) => to_import(path),
        TemplateError::CellTooSmall { .. } => ", as `scaleproof pattern import IMAGE --cells 24` makes them",
        OutputError::UnknownEnding { .. } => ", or give --format",
        PaintError::CellTooSmall { most, least_tile, .. } => format!(
            "; give --min-feature-mm {most} or less, or --tile-mm {least_tile} or more, or make fewer cells by scaleproof pattern import --cells"
        ),
        PaintError::NoStencil(_) => "; give a smaller --min-feature-mm or a larger --tile-mm",
        TagPrintError::TooLarge { instead: Instead::WholeMat, .. } => " (--whole-mat)",
        TagPrintError::TooLarge { instead: Instead::PlainCards, .. } => " (--plain)",
        TextureError::NoCoordinates { .. } => " (--material or --faces)",
        TextureError::NoImages | TextureError::Material { .. } => "; --texture takes another image",
    }
}

fn to_import(path: &Path) -> String {
    format!(", or make one of the image: {}", import_command(path))
}

/// The command that makes a pattern of an image, over nothing that is there.
pub(super) fn import_command(image: &Path) -> String {
    let [from, to] =
        [image, &files::free_place("pattern.png".as_ref())].map(|path| quoted(&path.display().to_string()));
    format!("scaleproof pattern import {from} --cells 24 -o {to}")
}

fn is_jpeg(ending: &OsStr) -> bool {
    ["jpg", "jpeg"].iter().any(|known| ending.eq_ignore_ascii_case(known))
}

#[cfg(test)]
#[path = "tests/advice.rs"]
mod tests;
