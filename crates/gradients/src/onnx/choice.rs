//! Operators that choose: the largest numbers, numbers at indices, pixels at computed places.
//!
//! A gradient passes to what was chosen, and none through the choice itself, as in the frameworks these networks come from.

use std::sync::Arc;

use super::graph::Graph;
use super::operator::{Inputs, Operator, one, several};
use super::run::{ToWhole, Work};
use super::term::{Numbers, Result, Term, axes_of, axis_of, bounded, mismatch};
use super::view::View;
use crate::layers::{Number, Sampled};
use scaleproof_detect::onnx_model::Node;

/// The row-major index of the first number of each line along an axis, and the step from one number of a line to the next.
fn lines(shape: &[usize], axis: usize) -> (Vec<usize>, usize) {
    let step: usize = shape[axis + 1..].iter().product();
    let block = step * shape[axis];
    let before: usize = shape[..axis].iter().product();
    let starts = (0..before).flat_map(|i| (0..step).map(move |k| i * block + k));
    (starts.collect(), step)
}

/// For each line along an axis the indices of so many of its numbers, best first; of equals, the first comes first.
fn order<T: Number>(shape: Vec<usize>, axis: usize, count: usize, largest: bool) -> Arc<ToWhole<T>> {
    let mut new_shape = shape.clone();
    new_shape[axis] = count;
    Arc::new(move |inputs| {
        // Whole numbers of indices and counts are exact in 64 bits; −0 and 0 are equals.
        let numbers: Vec<f64> = match &inputs[0] {
            Numbers::Floats(v) => v.iter().map(|v| v.wide() + 0.0).collect(),
            Numbers::Whole(v) => v.iter().map(|v| *v as f64).collect(),
        };
        let ((starts, step), (new_starts, _)) = (lines(&shape, axis), lines(&new_shape, axis));
        let mut found = vec![0; new_shape.iter().product()];
        let mut order: Vec<usize> = Vec::new();
        for (start, new_start) in starts.into_iter().zip(new_starts) {
            order.clear();
            order.extend(0..shape[axis]);
            let ascending = |a: usize, b: usize| numbers[start + a * step].total_cmp(&numbers[start + b * step]);
            order.sort_by(|a, b| if largest { ascending(*b, *a) } else { ascending(*a, *b) });
            for (k, index) in order[..count].iter().enumerate() {
                found[new_start + k * step] = *index as i64;
            }
        }
        Ok(found)
    })
}

/// The largest or smallest numbers along an axis, best first, and their indices.
fn top_k<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Vec<Term<T>>> {
    let x = inputs.term(0)?;
    let axis = axis_of(node.int("axis").unwrap_or(-1), x.shape.len())?;
    let stated = node.int("k").map(|k| vec![k]);
    let count = match stated.as_deref().map_or_else(|| inputs.known(1), Ok)? {
        [k] => usize::try_from(*k).ok().filter(|k| (1..=x.shape[axis]).contains(k)),
        _ => None,
    };
    let count = count.ok_or("it asks for more numbers than there are")?;
    let mut shape = x.shape.clone();
    shape[axis] = count;
    let order = order(x.shape.clone(), axis, count, node.int("largest") != Some(0));
    let order = graph.work(Work::Order(order), &[x], shape)?;
    Ok(vec![gathered(graph, x, axis, &order)?, order])
}

/// The index of the largest or smallest number along an axis; of equals the first.
fn arg_best<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let x = inputs.term(0)?;
    let axis = axis_of(node.int("axis").unwrap_or(0), x.shape.len())?;
    if x.shape[axis] == 0 {
        return Err("it looks for the best of nothing".into());
    }
    let mut shape = x.shape.clone();
    shape[axis] = 1;
    let order = order(x.shape.clone(), axis, 1, node.operator == "ArgMax");
    let found = graph.work(Work::Order(order), &[x], shape.clone())?;
    if node.int("keepdims") == Some(0) {
        shape.remove(axis);
    }
    found.shaped(shape)
}

/// For each index the number at that index of its own line along the axis.
fn gathered<T: Number>(graph: &mut Graph<T>, x: &Term<T>, axis: usize, indices: &Term<T>) -> Result<Term<T>> {
    let (side, shape) = (x.shape[axis], indices.shape.clone());
    // Other axes may be shorter there: of them the first lines are taken.
    let mut full = x.shape.clone();
    full[axis] = 1;
    let starts = (0..shape.len())
        .filter(|i| *i != axis)
        .try_fold(View::of(&full), |view, i| {
            let first: Vec<usize> = (0..shape[i]).collect();
            view.taken(i, &first)
        })?;
    let mut lines = shape.clone();
    lines[axis] = 1;
    let step: usize = x.shape[axis + 1..].iter().product();
    let starts = View::of(&lines).expanded(&shape)?.at.into_iter().map(|line| {
        let start = starts.at[line];
        start / step * step * side + start % step
    });
    let starts: Vec<usize> = starts.collect();
    graph.picked([x, indices], shape, move |indices| {
        let indices = axes_of(indices, side)?;
        Ok(starts
            .iter()
            .zip(indices)
            .map(|(start, index)| start + index * step)
            .collect())
    })
}

fn gather_elements<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, indices) = (inputs.term(0)?, inputs.whole(1)?);
    let axis = axis_of(node.int("axis").unwrap_or(0), x.shape.len())?;
    let fits = |i: usize| i == axis || indices.shape[i] <= x.shape[i];
    if indices.shape.len() != x.shape.len() || !(0..x.shape.len()).all(fits) {
        return Err(mismatch("numbers and indices", &x.shape, &indices.shape));
    }
    gathered(graph, x, axis, indices)
}

/// Indices along an axis; the indices' own shape takes the axis' place.
fn gather<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, indices) = (inputs.term(0)?, inputs.whole(1)?);
    let axis = axis_of(node.int("axis").unwrap_or(0), x.shape.len())?;
    let side = x.shape[axis];
    let shape = [&x.shape[..axis], &indices.shape, &x.shape[axis + 1..]].concat();
    if let Some(Numbers::Whole(known)) = indices.constant() {
        let view = View::of(&x.shape).taken(axis, &axes_of(known, side)?)?;
        return graph.viewed(x, view)?.shaped(shape);
    }
    let [before, after] = [&x.shape[..axis], &x.shape[axis + 1..]].map(|sides| sides.iter().product::<usize>());
    graph.picked([x, indices], shape, move |indices| {
        let indices = axes_of(indices, side)?;
        let rows = (0..before).flat_map(|i| indices.iter().map(move |index| (i * side + index) * after));
        Ok(rows.flat_map(|row| row..row + after).collect())
    })
}

/// Rows of indices, each naming one place along all axes from some on; what is left of the axes is taken whole.
fn gather_nd<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, indices) = (inputs.term(0)?, inputs.whole(1)?);
    let batch = usize::try_from(node.int("batch_dims").unwrap_or(0)).unwrap_or(usize::MAX);
    let refused = || mismatch("numbers and indices", &x.shape, &indices.shape);
    let (Some((depth, rows)), true) = (indices.shape.split_last(), indices.shape.len() > batch) else {
        return Err(refused());
    };
    let end = batch.saturating_add(*depth);
    if *depth == 0 || end > x.shape.len() || x.shape[..batch] != rows[..batch] {
        return Err(refused());
    }
    let shape = [rows, &x.shape[end..]].concat();
    bounded(shape.iter().copied())?;
    let (sides, depth) = (x.shape[batch..end].to_vec(), *depth);
    let after: usize = x.shape[end..].iter().product();
    let of_batch: usize = rows[batch..].iter().product();
    graph.picked([x, indices], shape, move |indices| {
        let mut places = Vec::new();
        for (i, row) in indices.chunks_exact(depth).enumerate() {
            let from = i / of_batch;
            let place = row.iter().zip(&sides).try_fold(from, |place, (index, side)| {
                axis_of(*index, *side).map(|index| place * side + index)
            })?;
            places.extend(place * after..(place + 1) * after);
        }
        Ok(places)
    })
}

/// Images looked at between their pixels, at places that −1 to 1 stand for (ONNX: GridSample, bilinear).
fn grid_sample<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (images, [count, channels, rows, columns]) = inputs.planes(0)?;
    let (grid, [grids, new_rows, new_columns, coordinates]) = inputs.planes(1)?;
    if grids != count || coordinates != 2 || rows == 0 || columns == 0 {
        return Err(mismatch("images and places", &images.shape, &grid.shape));
    }
    let layer = Sampled {
        images: count,
        channels,
        image: [rows, columns],
        places: new_rows * new_columns,
        aligns_corners: node.int("align_corners").unwrap_or(0) != 0,
        clamps: node.text("padding_mode") == Some("border"),
    };
    graph.layer(layer, &[images, grid], vec![count, channels, new_rows, new_columns])
}

pub(super) fn read<T: Number>(node: &Node) -> Option<Operator<'_, T>> {
    match node.operator.as_str() {
        "TopK" => several(|graph, inputs| top_k(node, graph, inputs)),
        "ArgMax" | "ArgMin" if node.int("select_last_index") != Some(1) => {
            one(|graph, inputs| arg_best(node, graph, inputs))
        }
        "Gather" => one(|graph, inputs| gather(node, graph, inputs)),
        "GatherElements" => one(|graph, inputs| gather_elements(node, graph, inputs)),
        "GatherND" => one(|graph, inputs| gather_nd(node, graph, inputs)),
        "GridSample"
            if matches!(node.text("mode"), None | Some("bilinear" | "linear"))
                && node.text("padding_mode") != Some("reflection") =>
        {
            one(|graph, inputs| grid_sample(node, graph, inputs))
        }
        _ => None,
    }
}
