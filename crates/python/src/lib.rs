//! The module `scaleproof._native`: scaleproof's library behind plain values, and its program.
//!
//! Everything that a Python user meets is in `python/scaleproof`, which checks values, knows numpy and makes classes of what comes from here: JSON as
//! the program prints it, bytes of arrays, and sentences. Nothing here holds Python's lock while it works, and every panic ends as an exception.

mod error; // the module's exception, and panics as one
mod figures; // average precision of plain boxes
mod frames; // the surrogate renderer of a view, as arrays
mod function; // a Python function as a detector
mod locating; // poses of photos
mod pattern; // patterns as arrays, and their files
mod scoring; // photos scored and compared
mod watched; // work that Ctrl-C stops

use std::ffi::OsString;
use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use scaleproof::in_process;

use error::{Error, unpanicked};

/// Photos in large pages.
#[global_allocator]
static ALLOCATOR: scaleproof_core::workers::memory::LargePages = scaleproof_core::workers::memory::LargePages;

/// Prepares the process; `module` is the file of this module.
#[pyfunction]
fn begin(module: PathBuf) -> PyResult<()> {
    in_process::begin(&module).map_err(Error::new_err)
}

/// Runs the program with arguments, its own name first: its exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    py.detach(|| unpanicked(|| scaleproof::main(&arguments)))
}

/// Runs a command in this process: what it printed, and whether some input was bad.
#[pyfunction]
fn run(py: Python<'_>, arguments: Vec<String>) -> PyResult<(Py<PyBytes>, bool)> {
    let ran = watched::alone(py, move || in_process::run(&arguments))?;
    match ran.error {
        Some(sentence) => Err(Error::new_err(sentence)),
        None => Ok((PyBytes::new(py, &ran.printed).unbind(), ran.is_some_input_bad)),
    }
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<Error>())?;
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(begin, module)?)?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(locating::locate, module)?)?;
    module.add_function(wrap_pyfunction!(pattern::pattern_load, module)?)?;
    module.add_function(wrap_pyfunction!(pattern::pattern_save, module)?)?;
    module.add_function(wrap_pyfunction!(figures::ap, module)?)?;
    module.add_function(wrap_pyfunction!(scoring::score_photos, module)?)?;
    module.add_class::<locating::Scene>()?;
    module.add_class::<locating::Camera>()?;
    module.add_class::<scoring::Scores>()?;
    module.add_class::<scoring::Comparison>()?;
    module.add_class::<frames::Frames>()
}
