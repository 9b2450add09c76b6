//! The module's exception; errors of the library and panics become one.

use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use scaleproof::in_process;

pyo3::create_exception!(
    scaleproof,
    Error,
    PyException,
    "Why something could not be done: one sentence, as the program says it."
);

/// An error of the library as the exception, with the program's advice.
pub fn refused(e: impl std::error::Error + 'static) -> PyErr {
    Error::new_err(in_process::sentence(&e))
}

/// Work whose panic is an error.
pub fn unpanicked<T>(work: impl FnOnce() -> T) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        Error::new_err(format!(
            "scaleproof failed, which is a fault of its own: {}; please report it",
            text.unwrap_or("a panic")
        ))
    })
}
