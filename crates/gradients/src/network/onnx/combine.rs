//! Operators that combine the numbers along axes: softmax, sums, matrix products.

use burn::tensor::{Tensor, activation};
use onnx_ir::Node;
use onnx_ir::reduce::{ReduceAxes, ReduceConfig};

use super::operator::{Inputs, IntegerSetting, Operator, axes_of, axis_of, setting};
use super::value::{Floats, RANK, Result, bounded, broadcast};
use crate::NetworkFault;

/// Along one axis; before opset 13 along all from there on, as one.
fn softmax(first: usize, joins_axes: bool) -> Operator {
    Operator::new(move |mut inputs| {
        let v = inputs.floats(0)?;
        let (axis, shape) = (v.axis(first)?, v.shape());
        if !joins_axes {
            return Ok(v.map(|x| activation::softmax(x, axis)));
        }
        let rows = [shape[..first].iter().product(), shape[first..].iter().product()];
        let joined = v.reshaped(&rows)?.map(|x| activation::softmax(x, RANK - 1));
        joined.reshaped(&shape)
    })
}

/// Along the named axes, or along all when none is named.
fn reduce(config: &ReduceConfig, along: fn(Tensor<RANK>, usize) -> Tensor<RANK>) -> Operator {
    let named = setting!(ReduceAxes, &config.axes);
    let (keeps_axes, none_means_none) = (config.keepdims, config.noop_with_empty_axes);
    Operator::new(move |mut inputs| {
        let named = named.values(&inputs)?;
        let v = inputs.floats(0)?;
        let axes = match named[..] {
            [] if none_means_none => Vec::new(),
            [] => (0..v.rank).collect(),
            _ => axes_of(&named, v.rank)?,
        };
        let (shape, front) = (v.shape(), RANK - v.rank);
        let reduced = v.map(|x| axes.iter().fold(x, |x, axis| along(x, front + axis)));
        if keeps_axes {
            return Ok(reduced);
        }
        let left = (0..shape.len()).filter(|i| !axes.contains(i)).map(|i| shape[i]);
        reduced.reshaped(&left.collect::<Vec<_>>())
    })
}

/// Product of matrices, or of stacks of them.
fn product(a: Floats, b: Floats) -> Result<Floats> {
    let (left, right) = (a.shape(), b.shape());
    let fit = matches!((&left[..], &right[..]), ([_, .., inner], [.., rows, _]) if inner == rows);
    if !fit {
        return Err(NetworkFault::Mismatch("matrices", left, right));
    }
    let (rows, columns) = (left[left.len() - 2], right[right.len() - 1]);
    let stack = broadcast(&left[..left.len() - 2], &right[..right.len() - 2])?;
    bounded(stack.into_iter().chain([rows, columns]))?;
    let (x, rank) = (a.x.matmul(b.x), a.rank.max(b.rank));
    Ok(Floats { x, rank })
}

/// (x − mean) / √(variance + ε) · scale + shift, over all axes from one on.
fn layer_norm(first: i64, epsilon: f64) -> Operator {
    Operator::new(move |mut inputs| {
        let v = inputs.floats(0)?;
        let scale = inputs.floats(1)?;
        let shift = inputs.optional_floats(2)?;
        let axes = RANK - v.rank + axis_of(first, v.rank)?..RANK;
        for other in [Some(&scale), shift.as_ref()].into_iter().flatten() {
            bounded(broadcast(&v.shape(), &other.shape())?)?;
        }
        let mean = |x: Tensor<RANK>| axes.clone().fold(x, Tensor::mean_dim);
        Ok(v.map(|x| {
            let centred = x.clone() - mean(x);
            let variance = mean(centred.clone() * centred.clone());
            let scaled = centred / variance.add_scalar(epsilon).sqrt() * scale.x;
            match shift {
                Some(shift) => scaled + shift.x,
                None => scaled,
            }
        }))
    })
}

/// As NumPy multiplies: a vector on the left is a row, one on the right a column, and its axis is gone afterwards.
fn matmul(mut inputs: Inputs) -> Result<Floats> {
    let (a, b) = (inputs.floats(0)?, inputs.floats(1)?);
    let (left, right) = (a.shape(), b.shape());
    let (is_row, is_column) = (left.len() == 1, right.len() == 1);
    let row = if is_row { a.reshaped(&[1, left[0]])? } else { a };
    let column = if is_column { b.reshaped(&[right[0], 1])? } else { b };
    let result = product(row, column)?;
    let mut shape = result.shape();
    if is_column {
        shape.pop();
    }
    if is_row {
        shape.remove(shape.len() - if is_column { 1 } else { 2 });
    }
    result.reshaped(&shape)
}

/// α·A·B + β·C of matrices, A and B turned where said.
fn gemm(alpha: f32, beta: f32, turns: [bool; 2]) -> Operator {
    Operator::new(move |mut inputs| {
        let turned = |v: Floats, turn: bool| {
            if turn {
                v.map(|x| x.swap_dims(RANK - 2, RANK - 1))
            } else {
                v
            }
        };
        let (a, b) = (inputs.floats(0)?, inputs.floats(1)?);
        let added = inputs.optional_floats(2)?;
        let mut result = product(turned(a, turns[0]), turned(b, turns[1]))?;
        if alpha != 1.0 {
            result = result.map(|x| x.mul_scalar(alpha));
        }
        if let Some(c) = added {
            bounded(broadcast(&result.shape(), &c.shape())?)?;
            result = result.map(|x| x + c.x.mul_scalar(beta));
        }
        Ok(result)
    })
}

pub(super) fn read(node: &Node, opset: i64) -> Option<Operator> {
    Some(match node {
        Node::Softmax(n) => softmax(n.config.axis, opset < 13),
        Node::ReduceSum(n) => reduce(&n.config, |x, axis| x.sum_dim(axis)),
        Node::ReduceMean(n) => reduce(&n.config, |x, axis| x.mean_dim(axis)),
        Node::ReduceMax(n) => reduce(&n.config, |x, axis| x.max_dim(axis)),
        Node::ReduceMin(n) => reduce(&n.config, |x, axis| x.min_dim(axis)),
        Node::MatMul(_) => Operator::new(matmul),
        Node::Gemm(n) => {
            let c = &n.config;
            gemm(c.alpha, c.beta, [c.trans_a != 0, c.trans_b != 0])
        }
        Node::LayerNormalization(n) if n.outputs.len() == 1 => layer_norm(n.config.axis, n.config.epsilon),
        // Made by the parser of Gemm, or of MatMul and Add.
        Node::Linear(n) => gemm(1.0, 1.0, [false, n.config.transpose_weight]),
        _ => return None,
    })
}
