//! A function of Python as a detector: photos that are looked at in several threads reach it in batches, in the thread that started the run.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};

use image::RgbImage;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scaleproof_detect::{CalledDetector, Callee, ForeignCard, ForeignKind, FoundBox, FoundLabel};

use crate::error::{Error, refused};
use crate::watched::Event;

/// A function of Python and what is known of it, as `scaleproof.Detector` hands it over.
#[derive(FromPyObject)]
pub struct Function {
    /// Takes a list of (pixels, file), gives for each a list of (label, confidence, box).
    call: Py<PyAny>,
    name: String,
    title: String,
    version: String,
    /// As in a manifest: JSON.
    labels: String,
    class_map: BTreeMap<String, String>,
    /// Name and SHA-256.
    files: Vec<(String, String)>,
    is_deterministic: bool,
    batch: usize,
}

/// A photo that waits for its boxes.
#[derive(Debug)]
pub struct Asked {
    function: usize,
    image: Arc<RgbImage>,
    file: String,
    reply: Sender<Result<Vec<FoundBox>, String>>,
}

/// The detector's end of the way to a function.
#[derive(Debug)]
struct Asking {
    function: usize,
    to: Sender<Event<Asked>>,
}

impl Callee for Asking {
    fn find(&self, file: &str, image: &Arc<RgbImage>) -> Result<Vec<FoundBox>, String> {
        let (reply, answer) = mpsc::channel();
        let asked = Asked {
            function: self.function,
            image: Arc::clone(image),
            file: file.to_owned(),
            reply,
        };
        let is_over = || format!("was not asked about {file}: the run is over");
        self.to.send(Event::Ask(asked)).map_err(|_| is_over())?;
        answer.recv().unwrap_or_else(|_| Err(is_over()))
    }
}

impl Function {
    /// The detector that asks a function, which is the `number`th.
    pub fn detector(&self, number: usize, to: &Sender<Event<Asked>>) -> PyResult<CalledDetector> {
        let name = self.name.clone();
        if !scaleproof::Manifest::is_name(&name) {
            let rule = "use letters, digits, `_`, `-` and `.`, 100 at most";
            return Err(Error::new_err(format!("the detector's name is {name:?}: {rule}")));
        }
        if scaleproof::Manifest::names().contains(&name.as_str()) {
            return Err(Error::new_err(format!(
                "the detector's name is {name:?}, which a detector of the program has: give it another"
            )));
        }
        let doubt =
            format!("{name} does not say that it answers alike each time, so that another run may give other figures");
        let card = ForeignCard {
            kind: ForeignKind::Function,
            title: self.title.clone(),
            licence: "not stated".to_owned(),
            origin: "a function of Python".to_owned(),
            version: Some(self.version.clone()).filter(|version| !version.is_empty()),
            command: Vec::new(),
            labels: serde_json::from_str(&self.labels).map_err(refused)?,
            class_map: self.class_map.clone(),
            files: self.files.clone(),
            notes: if self.is_deterministic { Vec::new() } else { vec![doubt] },
            name,
        };
        let (function, to) = (number, to.clone());
        Ok(CalledDetector::new(card, Box::new(Asking { function, to })))
    }
}

/// An image as NumPy takes it, not copied: the array keeps it.
#[pyclass(frozen)]
struct Pixels(Arc<RgbImage>);

#[pymethods]
impl Pixels {
    /// Height × width × 3 bytes, read-only, as NumPy's array interface describes memory (version 3).
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (width, height) = self.0.dimensions();
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", (height, width, 3))?;
        interface.set_item("typestr", "|u1")?;
        interface.set_item("data", (self.0.as_ptr().expose_provenance(), true))?;
        Ok(interface)
    }
}

/// A label as Python gives it.
#[derive(FromPyObject)]
enum Label {
    Name(String),
    Number(usize),
}

/// Boxes of one photo: label, confidence, left, top, right, bottom.
type Boxes = Vec<(Label, f64, [f64; 4])>;

/// Answers a request, and with it those that wait for the same function, as many as it takes at a time. Those for other functions are answered, too.
///
/// # Errors
/// What a function raised, where it is the module's own error or no `Exception`; else an error that says which, and has it as its cause.
pub fn answer(py: Python<'_>, functions: &[Function], first: Asked, waiting: &Receiver<Event<Asked>>) -> PyResult<()> {
    let mut batches: BTreeMap<usize, Vec<Asked>> = BTreeMap::new();
    let mut next = Some(first);
    while let Some(asked) = next.take() {
        let (number, most) = (asked.function, functions[asked.function].batch.max(1));
        let batch = batches.entry(number).or_default();
        batch.push(asked);
        if batch.len() == most {
            let full = std::mem::take(batch);
            call(py, &functions[number], full)?;
        } else if let Ok(Event::Ask(more)) = waiting.try_recv() {
            next = Some(more);
        }
    }
    let mut left = batches.into_iter().filter(|(_, batch)| !batch.is_empty());
    left.try_for_each(|(number, batch)| call(py, &functions[number], batch))
}

fn call(py: Python<'_>, function: &Function, batch: Vec<Asked>) -> PyResult<()> {
    let photos: Vec<_> = batch
        .iter()
        .map(|asked| (Pixels(Arc::clone(&asked.image)), asked.file.as_str()))
        .collect();
    let answers = function
        .call
        .call1(py, (photos,))
        .and_then(|all| all.extract::<Vec<Boxes>>(py));
    let answers = answers.map_err(|e| {
        if e.is_instance_of::<Error>(py) || !e.is_instance_of::<PyException>(py) {
            return e;
        }
        let (files, text) = (batch.iter().map(|asked| asked.file.as_str()), e.value(py).to_string());
        let kind = e
            .get_type(py)
            .name()
            .map_or_else(|_| "an error".to_owned(), |name| name.to_string());
        let files = files.collect::<Vec<_>>().join(", ");
        let raised = Error::new_err(format!("{} raised {kind} at {files}: {text}", function.name));
        raised.set_cause(py, Some(e));
        raised
    })?;
    for (asked, boxes) in batch.into_iter().zip(answers) {
        let boxes = boxes.into_iter().map(|(label, score, b)| FoundBox {
            label: match label {
                Label::Name(name) => FoundLabel::Name(name),
                Label::Number(number) => FoundLabel::Number(number),
            },
            score,
            b,
        });
        // The thread that asked is gone only when the run has ended.
        drop(asked.reply.send(Ok(boxes.collect())));
    }
    Ok(())
}
