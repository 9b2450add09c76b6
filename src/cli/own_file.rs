//! The file that this code runs from, on which cached results depend: the program's own, or that of a module in another program.

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

/// Returns true if this code runs inside another program, whose process goes on after an interruption.
pub(super) fn is_in_another_program() -> bool {
    MODULE.get().is_some()
}

/// SHA-256 of the module that holds this code, on which results depend that are kept; empty in the program, whose own file is hashed.
pub(super) fn module() -> &'static str {
    MODULE.get().map_or("", String::as_str)
}
