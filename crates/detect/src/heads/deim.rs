//! DEIM, D-FINE, RT-DETR exports with `orig_target_sizes`: labels, boxes (x1 y1 x2 y2 in photo pixels) and scores; no
//! suppression needed.

use super::super::nms::CandidateBox;
use super::rows::Rows;
use super::{Anchors, HeadError, Tensor, misfit};
use scaleproof_core::geometry::BoxPx;

pub(super) fn decode(outputs: &[Tensor], labels: usize) -> Result<Vec<CandidateBox>, HeadError> {
    rows(outputs)?.candidates(0, labels, BoxPx::from)
}

/// Its rows as anchors: each has one label.
pub(super) fn anchors(outputs: &[Tensor], labels: usize) -> Result<Anchors, HeadError> {
    Ok(Anchors::new(rows(outputs)?.anchors(outputs, labels)))
}

fn rows(outputs: &[Tensor]) -> Result<Rows<'_>, HeadError> {
    Rows::pick(outputs).ok_or_else(|| misfit("deim", "labels 1×n, boxes 1×n×4, scores 1×n".into(), outputs))
}

#[cfg(test)]
mod tests {
    use super::super::Data;
    use super::*;

    fn outputs(labels: Vec<i64>, scores: Vec<f32>) -> Vec<Tensor> {
        let n = scores.len();
        let boxes = (0..n).flat_map(|i| [i as f32, 2.0, i as f32 + 30.0, 40.0]).collect();
        vec![
            Tensor {
                name: "labels".into(),
                shape: vec![1, n],
                data: Data::I64(labels),
            },
            Tensor::of_floats(&[1, n, 4], boxes),
            Tensor::of_floats(&[1, n], scores),
        ]
    }

    #[test]
    fn rows_come_back_and_a_strange_label_is_named() {
        let found = decode(&outputs(vec![2, 7, 91, -1], vec![0.2, 0.9, 0.0, 0.0]), 80).unwrap();
        assert_eq!(
            found.iter().map(|c| (c.label, c.b.x1)).collect::<Vec<_>>(),
            [(2, 0.0), (7, 1.0)]
        );
        for strange in [91, 80, -1, i64::MIN] {
            let error = decode(&outputs(vec![2, strange], vec![0.2, 0.01]), 80)
                .unwrap_err()
                .to_string();
            assert!(
                error.contains(&format!("label {strange}, which is not among the 80")),
                "{error}"
            );
        }
        assert!(decode(&outputs(vec![2], vec![0.2, 0.9]), 80).is_err());
    }
}
