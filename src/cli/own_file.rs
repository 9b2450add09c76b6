//! Which file this code runs from, since results that are kept depend on it.

use std::path::Path;
use std::sync::OnceLock;

use scaleproof_core::files;

/// Notes the file of the module that holds this code; called once before anything else.
///
/// # Errors
/// The file cannot be read.
pub fn begin(module: &Path) -> std::result::Result<(), String> {
    let hash = files::hashed(module).map_err(|e| e.to_string())?;
    MODULE.get_or_init(|| hash.1);
    Ok(())
}

static MODULE: OnceLock<String> = OnceLock::new();

/// SHA-256 of the module that holds this code, on which results depend that are kept; empty in the program, whose own file is hashed.
pub(super) fn module() -> &'static str {
    MODULE.get().map_or("", String::as_str)
}
