//! Operators that combine the numbers along axes: softmax, sums, matrix products.

use super::arithmetic::of_two;
use super::graph::Graph;
use super::operator::{Inputs, Operator, one};
use super::term::{Result, Term, axes_of, axis_of, bounded, broadcast, mismatch};
use super::view::View;
use crate::layers::{Each, Lines, Number, Operation, Product, Reduced, Softmax, Summary};
use scaleproof_detect::onnx_model::Node;

/// The lines of a shape along one of its axes, or along several from one to another as one.
fn lines(shape: &[usize], axes: std::ops::Range<usize>) -> Lines {
    Lines {
        step: shape[axes.end..].iter().product(),
        side: shape[axes].iter().product(),
    }
}

/// Along one axis; before opset 13 along all from there on, as one.
fn softmax<T: Number>(node: &Node, opset: i64, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let x = inputs.floats(0)?;
    let joins_axes = opset < 13;
    let axis = node.int("axis").unwrap_or(if joins_axes { 1 } else { -1 });
    let first = axis_of(axis, x.shape.len())?;
    let end = if joins_axes { x.shape.len() } else { first + 1 };
    graph.layer(Softmax(lines(&x.shape, first..end)), &[x], x.shape.clone())
}

/// One number for each line along an axis, which keeps the length 1.
pub(super) fn reduced<T: Number>(graph: &mut Graph<T>, x: &Term<T>, axis: usize, summary: Summary) -> Result<Term<T>> {
    let mut shape = x.shape.clone();
    shape[axis] = 1;
    graph.layer(Reduced(lines(&x.shape, axis..axis + 1), summary), &[x], shape)
}

/// Along the named axes, or along all when none is named.
fn reduce<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>, summary: Summary) -> Result<Term<T>> {
    let x = inputs.floats(0)?;
    let named = inputs.setting(node, "axes", 1)?.unwrap_or_default();
    let axes = match named {
        [] if node.int("noop_with_empty_axes") == Some(1) => Vec::new(),
        [] => (0..x.shape.len()).collect(),
        _ => axes_of(named, x.shape.len())?,
    };
    let result = axes
        .iter()
        .try_fold(x.clone(), |x, axis| reduced(graph, &x, *axis, summary))?;
    if node.int("keepdims") != Some(0) {
        return Ok(result);
    }
    let left = (0..x.shape.len()).filter(|i| !axes.contains(i)).map(|i| x.shape[i]);
    result.shaped(left.collect())
}

/// Product of matrices, or of stacks of them; stored turned where said.
fn product<T: Number>(graph: &mut Graph<T>, a: &Term<T>, b: &Term<T>, turned: [bool; 2]) -> Result<Term<T>> {
    let fault = || mismatch("matrices", &a.shape, &b.shape);
    let sides = |term: &Term<T>, turned: bool| match term.shape[..] {
        [.., rows, columns] => Ok(if turned { [columns, rows] } else { [rows, columns] }),
        _ => Err(fault()),
    };
    let ([rows, inner], [other, columns]) = (sides(a, turned[0])?, sides(b, turned[1])?);
    if inner != other {
        return Err(fault());
    }
    let stacks = [a, b].map(|term| &term.shape[..term.shape.len() - 2]);
    let stack = broadcast(stacks[0], stacks[1])?;
    let shape = [&stack[..], &[rows, columns]].concat();
    let count = bounded(shape.iter().copied())?;
    let (mut pairs, mut sides) = (vec![[0, 0]], [rows, columns, inner]);
    // Matrices on the left below each other are one.
    let is_one = b.count() == inner * columns && !turned[0] && count > 0;
    if is_one {
        sides[0] = count / columns;
    } else {
        let [left, right] = stacks.map(|own| View::of(own).expanded(&stack));
        pairs = left?.at.into_iter().zip(right?.at).map(|(a, b)| [a, b]).collect();
    }
    let constants = [a, b].map(|term| term.constant_floats().cloned());
    let (constants, inputs) = match constants {
        [_, Some(b)] => ([None, Some(b)], vec![a]),
        [Some(a), None] => ([Some(a), None], vec![b]),
        [None, None] => ([None, None], vec![a, b]),
    };
    if a.count() == 0 || b.count() == 0 {
        return Err(fault());
    }
    let layer = Product {
        constants,
        pairs,
        sides,
        turned,
    };
    graph.layer(layer, &inputs, shape)
}

/// √(variance + ε)
pub(super) fn deviation<T: Number>(node: &Node, graph: &mut Graph<T>, variance: &Term<T>) -> Result<Term<T>> {
    let epsilon = node.float("epsilon").map_or(1e-5, f64::from);
    let root = Each(move |v: T| {
        let root = (v.wide() + epsilon).sqrt();
        (T::of(root), T::of(0.5 / root))
    });
    graph.layer(root, &[variance], variance.shape.clone())
}

/// (x − mean) / √(variance + ε) · scale + shift, over all axes from one on.
fn layer_norm<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, scale) = (inputs.floats(0)?, inputs.floats(1)?);
    let first = axis_of(node.int("axis").unwrap_or(-1), x.shape.len())?;
    let mut in_lines = x.shape[..first].to_vec();
    in_lines.push(x.shape[first..].iter().product());
    let lines = x.shaped(in_lines)?;
    let mean = reduced(graph, &lines, first, Summary::Mean)?;
    let centred = of_two(graph, Operation::Difference, &lines, &mean)?;
    let squares = of_two(graph, Operation::Product, &centred, &centred)?;
    let variance = reduced(graph, &squares, first, Summary::Mean)?;
    let deviation = deviation(node, graph, &variance)?;
    let scaled = of_two(graph, Operation::Quotient, &centred, &deviation)?.shaped(x.shape.clone())?;
    let scaled = of_two(graph, Operation::Product, &scaled, scale)?;
    match inputs.optional_floats(2)? {
        Some(shift) => of_two(graph, Operation::Sum, &scaled, shift),
        None => Ok(scaled),
    }
}

/// Multiplies as NumPy does: a vector on the left is a row, one on the right a column, and its axis is gone afterwards.
fn matmul<T: Number>(graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (a, b) = (inputs.floats(0)?, inputs.floats(1)?);
    let (is_row, is_column) = (a.shape.len() == 1, b.shape.len() == 1);
    let row = if is_row {
        a.shaped(vec![1, a.count()])?
    } else {
        a.clone()
    };
    let column = if is_column {
        b.shaped(vec![b.count(), 1])?
    } else {
        b.clone()
    };
    let result = product(graph, &row, &column, [false; 2])?;
    let mut shape = result.shape.clone();
    if is_column {
        shape.pop();
    }
    if is_row {
        shape.remove(shape.len() - if is_column { 1 } else { 2 });
    }
    result.shaped(shape)
}

/// α·A·B + β·C of matrices, A and B turned where said.
fn gemm<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let turned = ["transA", "transB"].map(|name| node.int(name).unwrap_or(0) != 0);
    let scaled = |graph: &mut Graph<T>, x: Term<T>, name: &str| match node.float(name) {
        None | Some(1.0) => Ok(x),
        Some(factor) => of_two(graph, Operation::Product, &x, &Term::number(factor.into())),
    };
    let result = product(graph, inputs.floats(0)?, inputs.floats(1)?, turned)?;
    let result = scaled(graph, result, "alpha")?;
    match inputs.optional_floats(2)? {
        None => Ok(result),
        Some(added) => {
            let added = scaled(graph, added.clone(), "beta")?;
            of_two(graph, Operation::Sum, &result, &added)
        }
    }
}

pub(super) fn read<T: Number>(node: &Node, opset: i64) -> Option<Operator<'_, T>> {
    let summary = match node.operator.as_str() {
        "ReduceSum" => Summary::Sum,
        "ReduceMean" => Summary::Mean,
        "ReduceMax" => Summary::Largest,
        "ReduceMin" => Summary::Smallest,
        "Softmax" => return one(move |graph, inputs| softmax(node, opset, graph, inputs)),
        "MatMul" => return one(matmul),
        "Gemm" => return one(|graph, inputs| gemm(node, graph, inputs)),
        "LayerNormalization" if node.outputs.len() == 1 => {
            return one(|graph, inputs| layer_norm(node, graph, inputs));
        }
        _ => return None,
    };
    one(move |graph, inputs| reduce(node, graph, inputs, summary))
}
