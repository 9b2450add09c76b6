//! Operators that combine the numbers along axes: softmax, sums, matrix products.

use std::sync::Arc;

use burn::tensor::activation;
use onnx_ir::Node;
use onnx_ir::reduce::{ReduceAxes, ReduceConfig};

use super::operator::{AnyOperator, Inputs, IntegerSetting, Operator, axis_of};
use super::value::{Floats, RANK, Value};
use crate::whitebox::NetworkFault;

struct Softmax(usize);

impl Operator for Softmax {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let v = inputs.floats(0)?;
        let (axis, rank) = (v.axis(self.0)?, v.rank);
        let x = activation::softmax(v.x, axis);
        Ok(vec![Value::Floats(Floats { x, rank })])
    }
}

#[derive(Clone, Copy)]
enum Kind {
    Sum,
    Mean,
    Max,
    Min,
}

struct Reduce {
    kind: Kind,
    /// All when none is named.
    axes: IntegerSetting,
    keeps_axes: bool,
    none_means_none: bool,
}

impl Reduce {
    fn new(kind: Kind, config: &ReduceConfig) -> Reduce {
        Reduce {
            kind,
            axes: match &config.axes {
                ReduceAxes::Static(v) => IntegerSetting::known(v),
                ReduceAxes::Runtime(r) => IntegerSetting::input(r),
            },
            keeps_axes: config.keepdims,
            none_means_none: config.noop_with_empty_axes,
        }
    }
}

impl Operator for Reduce {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let named = self.axes.of(&inputs)?;
        let v = inputs.floats(0)?;
        let axes: Result<Vec<usize>, NetworkFault> = match named[..] {
            [] if self.none_means_none => Ok(Vec::new()),
            [] => Ok((0..v.rank).collect()),
            _ => named.iter().map(|axis| axis_of(*axis, v.rank)).collect(),
        };
        let axes = axes?;
        let mut shape = v.shape();
        let Floats { mut x, rank } = v;
        for axis in &axes {
            let at = RANK - rank + axis;
            x = match self.kind {
                Kind::Sum => x.sum_dim(at),
                Kind::Mean => x.mean_dim(at),
                Kind::Max => x.max_dim(at),
                Kind::Min => x.min_dim(at),
            };
            shape[*axis] = 1;
        }
        let reduced = Floats { x, rank };
        if self.keeps_axes {
            return Ok(vec![Value::Floats(reduced)]);
        }
        let left: Vec<usize> = (0..rank).filter(|i| !axes.contains(i)).map(|i| shape[i]).collect();
        Ok(vec![Value::Floats(reduced.reshaped(&left)?)])
    }
}

/// Product of matrices, or of stacks of them.
struct MatMul;

impl Operator for MatMul {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let (a, b) = (inputs.floats(0)?, inputs.floats(1)?);
        product(a, b).map(|v| vec![Value::Floats(v)])
    }
}

fn product(a: Floats, b: Floats) -> Result<Floats, NetworkFault> {
    let (left, right) = (a.shape(), b.shape());
    let fit = matches!((&left[..], &right[..]), ([_, .., inner], [.., rows, _]) if inner == rows);
    if !fit {
        return Err(NetworkFault::Mismatch("matrices", left, right));
    }
    let rank = a.rank.max(b.rank);
    Ok(Floats {
        x: a.x.matmul(b.x),
        rank,
    })
}

/// α·A·B + β·C of matrices, A and B turned where said.
struct Gemm {
    alpha: f32,
    beta: f32,
    turns: [bool; 2],
}

impl Operator for Gemm {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let turned = |v: Floats, turn: bool| match turn {
            true => Floats {
                x: v.x.swap_dims(RANK - 2, RANK - 1),
                rank: v.rank,
            },
            false => v,
        };
        let (a, b) = (inputs.floats(0)?, inputs.floats(1)?);
        let added = inputs.optional_floats(2)?;
        let Floats { mut x, rank } = product(turned(a, self.turns[0]), turned(b, self.turns[1]))?;
        if self.alpha != 1.0 {
            x = x.mul_scalar(self.alpha);
        }
        if let Some(c) = added {
            x = x + c.x.mul_scalar(self.beta);
        }
        Ok(vec![Value::Floats(Floats { x, rank })])
    }
}

pub(super) fn read(node: &Node) -> Option<AnyOperator> {
    Some(match node {
        Node::Softmax(n) => Arc::new(Softmax(n.config.axis)),
        Node::ReduceSum(n) => Arc::new(Reduce::new(Kind::Sum, &n.config)),
        Node::ReduceMean(n) => Arc::new(Reduce::new(Kind::Mean, &n.config)),
        Node::ReduceMax(n) => Arc::new(Reduce::new(Kind::Max, &n.config)),
        Node::ReduceMin(n) => Arc::new(Reduce::new(Kind::Min, &n.config)),
        Node::MatMul(_) => Arc::new(MatMul),
        Node::Gemm(n) => Arc::new(Gemm {
            alpha: n.config.alpha,
            beta: n.config.beta,
            turns: [n.config.trans_a != 0, n.config.trans_b != 0],
        }),
        // Made by the parser of Gemm, or of MatMul and Add.
        Node::Linear(n) => Arc::new(Gemm {
            alpha: 1.0,
            beta: 1.0,
            turns: [false, n.config.transpose_weight],
        }),
        _ => return None,
    })
}
