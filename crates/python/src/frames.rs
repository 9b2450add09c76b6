//! What the surrogate renderer of a view is made of, as arrays.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use scaleproof_frames::surrogate::projection::world::{self, Misplacement};
use scaleproof_frames::surrogate::projection::{Grid, Projection};
use scaleproof_frames::surrogate::renderer::{ClosedForm, FlatImage, PerPixel, Renderer};
use scaleproof_frames::{Frame, FrameSet, views};

use crate::error::{Error, refused, unpanicked};

/// A set of frames.
#[pyclass(frozen, module = "scaleproof._native")]
pub struct Frames(FrameSet);

/// A view that was prepared for patterns of one grid.
struct Prepared {
    name: String,
    renderer: PerPixel,
    projection: Projection,
    object: Vec<u8>,
}

/// Numbers as bytes in this machine's order.
macro_rules! bytes_of {
    ($py:expr, $numbers:expr) => {{
        let bytes: Vec<u8> = $numbers.flat_map(|number| number.to_ne_bytes()).collect();
        PyBytes::new($py, &bytes).unbind()
    }};
}

/// Starts, cells and weights of the projection; terms; the tone curve's exponent; the object's coverage; the frame's name.
type Parts = (
    Py<PyBytes>,
    Py<PyBytes>,
    Py<PyBytes>,
    Py<PyBytes>,
    Option<f64>,
    Py<PyBytes>,
    String,
);

#[pymethods]
impl Frames {
    #[new]
    fn open(py: Python<'_>, folder: PathBuf) -> PyResult<Frames> {
        py.detach(|| unpanicked(|| FrameSet::open(&folder).map(Frames).map_err(refused))?)
    }

    /// How many views it has, and the width and height of their images, px.
    fn about(&self) -> (usize, (u32, u32)) {
        (self.0.view_count(), self.0.list.size_px.into())
    }

    /// What a view's image is made of, for patterns of columns × rows cells whose repeat is `tile_mm` wide.
    fn view(&self, py: Python<'_>, view: usize, cells: [u32; 2], tile_mm: f64, form: &str) -> PyResult<Parts> {
        let found = self.prepared(py, view, Grid::new(cells, tile_mm), form)?;
        let (projection, renderer) = (&found.projection, &found.renderer);
        Ok((
            bytes_of!(py, projection.starts.iter().map(|start| *start as u64)),
            bytes_of!(py, projection.entries().iter().map(|(cell, _)| *cell)),
            bytes_of!(py, projection.entries().iter().map(|(_, weight)| *weight)),
            bytes_of!(py, renderer.terms().as_flattened().as_flattened().iter()),
            renderer.tone().map(|tone| tone.power),
            PyBytes::new(py, &found.object).unbind(),
            found.name,
        ))
    }

    /// The image of a view in a pattern whose cells are linear reflectances, as this library renders it: sRGB, 0 to 1.
    #[allow(clippy::too_many_arguments)]
    fn render(
        &self,
        py: Python<'_>,
        view: usize,
        cells: [u32; 2],
        tile_mm: f64,
        form: &str,
        colours: Vec<[f64; 3]>,
    ) -> PyResult<Py<PyBytes>> {
        let found = self.prepared(py, view, Grid::new(cells, tile_mm), form)?;
        let image = py.detach(|| unpanicked(|| found.renderer.predict(&found.projection.forward(&colours))))?;
        Ok(bytes_of!(py, image.as_flattened().iter()))
    }
}

impl Frames {
    fn prepared(&self, py: Python<'_>, view: usize, grid: Grid, form: &str) -> PyResult<Prepared> {
        let kind = ClosedForm::ALL.into_iter().find(|kind| kind.name() == form);
        let names = ClosedForm::ALL.map(ClosedForm::name).join(", ");
        let kind = kind.ok_or_else(|| Error::new_err(format!("there is no form {form:?}: take one of {names}")))?;
        py.detach(|| {
            unpanicked(|| {
                let all = views(&self.0.list.frames);
                let frames = all.get(view).ok_or_else(|| {
                    Error::new_err(format!(
                        "there is no view {view}: they are numbered from 0 to {}",
                        all.len() - 1
                    ))
                })?;
                self.of_view(frames, &grid, kind)
            })?
        })
    }

    fn of_view(&self, frames: &[&Frame], grid: &Grid, kind: ClosedForm) -> PyResult<Prepared> {
        let set = &self.0;
        let flats = frames.iter().map(|frame| FlatImage::read(set, frame));
        let flats: Vec<FlatImage> = flats
            .filter_map(Result::transpose)
            .collect::<Result<_, _>>()
            .map_err(refused)?;
        let renderer = PerPixel::fit(kind, &flats).map_err(refused)?;
        let first = frames[0];
        let projections = world::project(set, first, grid, false, &[Misplacement::NONE]).map_err(refused)?;
        let projection = projections.and_then(|mut all| all.pop()).ok_or_else(|| {
            let name = &first.name;
            Error::new_err(format!(
                "{name} has no positions, so that nobody knows where a pattern lies on it"
            ))
        })?;
        Ok(Prepared {
            name: first.name.clone(),
            renderer,
            projection,
            object: set.object_mask(first).map_err(refused)?.into_raw(),
        })
    }
}
