//! DEIM, D-FINE, RT-DETR exports with `orig_target_sizes`: labels, boxes (x1 y1 x2 y2 in photo pixels) and scores; no
//! suppression needed.

use super::super::nms::Candidate;
use super::{Data, Tensor, from_corners, misfit};
use crate::geometry::BoxPx;

pub(super) fn decode(outputs: &[Tensor], labels: usize) -> Result<Vec<Candidate>, String> {
    let expected = || misfit("deim", "labels 1×n, boxes 1×n×4, scores 1×n".into(), outputs);
    let [label_tensor, box_tensor, score_tensor] = outputs else {
        return Err(expected());
    };
    let (Data::I64(numbers), Some(boxes), Some(scores)) =
        (&label_tensor.data, box_tensor.floats(), score_tensor.floats())
    else {
        return Err(expected());
    };
    if boxes.len() != 4 * scores.len() || numbers.len() != scores.len() {
        return Err(expected());
    }
    let rows = numbers.iter().zip(boxes.chunks_exact(4)).zip(scores);
    let mut found: Vec<Candidate> = rows
        .filter_map(|((label, b), score)| {
            let label = usize::try_from(*label).ok().filter(|l| *l < labels)?;
            let [x1, y1, x2, y2] = [b[0], b[1], b[2], b[3]].map(f64::from);
            from_corners(label, *score, BoxPx::new(x1, y1, x2, y2))
        })
        .collect();
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outputs(labels: Vec<i64>, scores: Vec<f32>) -> Vec<Tensor> {
        let n = scores.len();
        let boxes = (0..n).flat_map(|i| [i as f32, 2.0, i as f32 + 30.0, 40.0]).collect();
        vec![
            Tensor {
                shape: vec![1, n],
                data: Data::I64(labels),
            },
            Tensor {
                shape: vec![1, n, 4],
                data: Data::F32(boxes),
            },
            Tensor {
                shape: vec![1, n],
                data: Data::F32(scores),
            },
        ]
    }

    #[test]
    fn rows_come_back_best_first_without_strange_labels() {
        let found = decode(&outputs(vec![2, 7, 91, -1], vec![0.2, 0.9, 0.99, 0.99]), 80).unwrap();
        assert_eq!(
            found.iter().map(|c| (c.label, c.b.x1)).collect::<Vec<_>>(),
            [(7, 1.0), (2, 0.0)]
        );
        assert!(decode(&outputs(vec![2], vec![0.2, 0.9]), 80).is_err());
    }
}
