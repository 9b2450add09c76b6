//! Average precision of plain boxes.

use pyo3::prelude::*;
use scaleproof_core::ap::{ApDefinition, ImageBoxes, average_precision_as, over_ious};
use scaleproof_core::geometry::BoxPx;

use crate::error::{refused, unpanicked};

/// Truths, crowd regions, and (confidence, box) of one image; boxes are left, top, right, bottom, px.
type Image = (Vec<[f64; 4]>, Vec<[f64; 4]>, Vec<(f64, [f64; 4])>);

/// AP and the recall reached, at an IoU or as the mean over COCO's ten; `None` without any truth.
#[pyfunction]
#[pyo3(signature = (images, definition, iou))]
pub fn ap(py: Python<'_>, images: Vec<Image>, definition: &str, iou: Option<f64>) -> PyResult<Option<(f64, f64)>> {
    let definition = ApDefinition::from_name(definition).map_err(refused)?;
    py.detach(|| {
        unpanicked(|| {
            let boxes = |all: Vec<[f64; 4]>| all.into_iter().map(BoxPx::from).collect();
            let image = |(truths, crowds, found): Image| ImageBoxes {
                truths: boxes(truths),
                crowds: boxes(crowds),
                detections: found.into_iter().map(|(score, b)| (score, b.into())).collect(),
            };
            let images: Vec<ImageBoxes> = images.into_iter().map(image).collect();
            let found = match iou {
                Some(iou) => average_precision_as(definition, &images, iou),
                None => over_ious(definition, &images),
            };
            found.map(|found| (found.ap, found.recall))
        })
    })
}
