//! Scoring runs and comparisons.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc;

use pyo3::prelude::*;
use scaleproof::in_process::{self, Watch};
use scaleproof_score as score;
use scaleproof_score::report;

use crate::error::{Error, refused, unpanicked};
use crate::function::{self, Function};
use crate::watched::{self, Course};

/// What a scoring run found.
#[pyclass(frozen, module = "scaleproof._native")]
pub struct Scores(Arc<score::Scores>);

/// Scores photos as `score` does with these arguments, with functions among the detectors.
#[pyfunction]
#[pyo3(name = "score", signature = (arguments, functions, progress))]
pub fn score_photos(
    py: Python<'_>,
    arguments: Vec<String>,
    functions: Vec<Function>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Scores> {
    let (course, requests) = (Course::default(), mpsc::channel());
    let detectors = functions.iter().enumerate();
    let detectors = detectors.map(|(number, function)| function.detector(number, &requests.0));
    let detectors = detectors.collect::<PyResult<Vec<_>>>()?;
    let run = || {
        let watch = Watch {
            begins: &|photos| course.of.store(photos, Ordering::Relaxed),
            on_photo: &|| course.step(),
            stop: Arc::clone(&course.stop),
        };
        in_process::scored(&arguments, detectors, &watch)
    };
    let answer = |py: Python<'_>, asked, waiting: &_| function::answer(py, &functions, asked, waiting);
    let scores = watched::work(py, &course, progress, requests, answer, run)?;
    Ok(Scores(Arc::new(scores.map_err(Error::new_err)?)))
}

/// Something of a run, made without Python's lock.
fn made<T: Send, E: std::error::Error + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, E> + Send,
) -> PyResult<T> {
    py.detach(|| unpanicked(|| work().map_err(refused))?)
}

#[pymethods]
impl Scores {
    /// `summary.json`.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        made(py, || report::summary_json(&self.0, None))
    }

    /// `photos.csv`.
    fn photos_csv(&self, py: Python<'_>) -> PyResult<String> {
        made(py, || report::photos_csv(&self.0))
    }

    /// `figures.csv`.
    fn figures_csv(&self, py: Python<'_>) -> PyResult<String> {
        made(py, || report::figures_csv(&self.0))
    }

    /// `report.html`.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| unpanicked(|| report::html::render(&self.0, None)))
    }

    /// `table.tex`.
    fn latex(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| unpanicked(|| report::latex::table(&self.0)))
    }

    /// The table in a terminal.
    fn table(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| unpanicked(|| report::summary_table(&self.0)))
    }

    /// Writes every file of the report into a folder: the path of the page to open.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
        made(py, || report::write(&folder, &self.0, None))
    }

    /// The textures against the one that the run measures drops from.
    fn compare(&self, py: Python<'_>) -> PyResult<Comparison> {
        let found = made(py, || score::compare(&self.0, &self.0.base, self.0.criteria.ap))?;
        Ok(Comparison(Arc::clone(&self.0), found))
    }
}

/// Textures compared on paired photos, and the run they are from.
#[pyclass(frozen, module = "scaleproof._native")]
pub struct Comparison(Arc<score::Scores>, score::Comparison);

#[pymethods]
impl Comparison {
    /// `comparison.json`.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        made(py, || report::comparison_json(&self.0, &self.1))
    }

    /// `comparison.csv`.
    fn csv(&self, py: Python<'_>) -> PyResult<String> {
        made(py, || report::comparison_csv(&self.0, &self.1))
    }

    /// `comparison.html`.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| unpanicked(|| report::comparison_html(&self.0, &self.1)))
    }

    /// `comparison.tex`.
    fn latex(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| unpanicked(|| report::latex::comparison(&self.0, &self.1)))
    }

    /// The table in a terminal.
    fn table(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| unpanicked(|| report::comparison_table(&self.0, &self.1)))
    }

    /// Writes every file of the comparison into a folder: the path of the page to open.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
        made(py, || report::write_comparison(&folder, &self.0, &self.1))
    }
}
