//! TensorFlow Object Detection API (SSD, EfficientDet, Faster R-CNN): `detection_boxes` 1×n×4 (y1 x1 y2 x2 as shares of the
//! photo), `detection_classes` 1×n (floats, counted from 1), `detection_scores` 1×n, `num_detections` 1. Source: the API's
//! `exporter`.

use super::super::nms::CandidateBox;
use super::rows::Rows;
use super::{Data, HeadError, Tensor, misfit, scaled};
use scaleproof_core::geometry::BoxPx;

pub(super) fn decode(
    outputs: &[Tensor],
    size: [u32; 2],
    first_label: i64,
    labels: usize,
) -> Result<Vec<CandidateBox>, HeadError> {
    let rows = rows(outputs).ok_or_else(|| {
        let expected = "detection_boxes 1×n×4, detection_classes 1×n, detection_scores 1×n";
        misfit("tf_od", expected.into(), outputs)
    })?;
    rows.candidates(first_label, labels, |[y1, x1, y2, x2]| {
        scaled(BoxPx::new(x1, y1, x2, y2), size)
    })
}

/// Classes and scores are alike in type and size, so the lists are picked by name; converters append `:0`.
fn rows(outputs: &[Tensor]) -> Option<Rows<'_>> {
    let named = |name: &str| outputs.iter().find(|t| t.name.split(':').next() == Some(name));
    let classes = whole(named("detection_classes")?)?;
    let (boxes, scores) = (
        named("detection_boxes")?.floats()?,
        named("detection_scores")?.floats()?,
    );
    if scores.len() != classes.len() || boxes.len() != 4 * classes.len() {
        return None;
    }
    let count = named("num_detections")
        .and_then(whole)
        .and_then(|v| usize::try_from(*v.first()?).ok());
    let count = count.unwrap_or(classes.len()).min(classes.len());
    Some(Rows {
        labels: classes[..count].to_vec(),
        boxes: &boxes[..4 * count],
        scores: &scores[..count],
    })
}

/// Whole numbers, which the API writes as floats.
fn whole(t: &Tensor) -> Option<Vec<i64>> {
    Some(match &t.data {
        Data::I64(v) => v.clone(),
        // A NaN is no label; -1 is in no list.
        Data::F32(v) => v
            .iter()
            .map(|v| if v.is_finite() { v.round() as i64 } else { -1 })
            .collect(),
    })
}
