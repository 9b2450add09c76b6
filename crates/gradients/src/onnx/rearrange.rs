//! Operators that only put numbers elsewhere: reshape, transpose, concatenate, cut, select, repeat.

use super::graph::Graph;
use super::operator::{Inputs, Operator, missing, one, several};
use super::term::{Result, Term, axes_of, axis_of, bounded, broadcast, no_axis};
use super::view::View;
use crate::layers::Number;
use scaleproof_detect::onnx_model::Node;

/// −1 stands for the rest, 0 for the side as it is, unless that is allowed to be 0.
fn reshape(old: &[usize], wanted: &[i64], allows_zero: bool) -> Result<Vec<usize>> {
    let side = |(i, side): (usize, &i64)| -> Result<Option<usize>> {
        match side {
            -1 => Ok(None),
            0 if !allows_zero => Ok(Some(*old.get(i).ok_or("it keeps a side that is not there")?)),
            ..0 => Err("a side of it is less than nothing".into()),
            _ => Ok(Some(usize::try_from(*side).unwrap_or(usize::MAX))),
        }
    };
    let sides: Vec<Option<usize>> = wanted.iter().enumerate().map(side).collect::<Result<_>>()?;
    let known = bounded(sides.iter().flatten().copied())?;
    let rest = old.iter().product::<usize>().checked_div(known).unwrap_or(0);
    Ok(sides.into_iter().map(|side| side.unwrap_or(rest)).collect())
}

/// Everything before an axis becomes the rows, the rest the columns.
fn flatten(old: &[usize], axis: i64) -> Result<Vec<usize>> {
    let rank = old.len();
    let at = if axis == rank as i64 {
        rank
    } else {
        axis_of(axis, rank)?
    };
    let (rows, columns) = old.split_at(at);
    Ok(vec![rows.iter().product(), columns.iter().product()])
}

/// Axes of length 1 go; all of them when none is named.
fn squeeze(old: &[usize], axes: Option<&[i64]>) -> Result<Vec<usize>> {
    let gone = match axes {
        Some(axes) => axes_of(axes, old.len())?,
        None => (0..old.len()).filter(|i| old[*i] == 1).collect(),
    };
    Ok((0..old.len()).filter(|i| !gone.contains(i)).map(|i| old[i]).collect())
}

/// Axes of length 1 come in, numbered as in the result.
fn unsqueeze(old: &[usize], axes: &[i64]) -> Result<Vec<usize>> {
    let (mut shape, mut new) = (old.to_vec(), axes_of(axes, old.len() + axes.len())?);
    new.sort_unstable();
    for axis in new {
        if axis > shape.len() {
            return Err(no_axis(shape.len(), axis as i64));
        }
        shape.insert(axis, 1);
    }
    Ok(shape)
}

fn transpose<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let x = inputs.term(0)?;
    let rank = x.shape.len();
    let order: Vec<usize> = match node.ints("perm") {
        Some(order) => order
            .iter()
            .map(|axis| usize::try_from(*axis).unwrap_or(rank))
            .collect(),
        None => (0..rank).rev().collect(),
    };
    let mut seen = order.clone();
    seen.sort_unstable();
    if seen != (0..rank).collect::<Vec<_>>() {
        return Err("its order of axes does not name each of them once".into());
    }
    graph.viewed(x, View::of(&x.shape).turned(&order))
}

fn concat<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let parts: Vec<&Term<T>> = (0..inputs.count()).map(|i| inputs.term(i)).collect::<Result<_>>()?;
    let first = *parts.first().ok_or("it has no input")?;
    let axis = axis_of(node.int("axis").unwrap_or(1), first.shape.len())?;
    let fits = |other: &&Term<T>| {
        let (a, b) = (&first.shape, &other.shape);
        a.len() == b.len() && (0..a.len()).all(|i| i == axis || a[i] == b[i]) && other.is_whole() == first.is_whole()
    };
    if !parts.iter().all(fits) {
        return Err("its inputs do not go together along its axis".into());
    }
    let mut shape = first.shape.clone();
    shape[axis] = 0;
    for part in &parts {
        shape[axis] += part.shape[axis];
        bounded(shape.iter().copied())?;
    }
    let before: usize = shape[..axis].iter().product();
    let (mut at, mut from) = (Vec::new(), 0);
    let counted = parts.iter().map(|part| {
        let (first, block) = (from, part.count().checked_div(before).unwrap_or(0));
        from += part.count();
        (first, block)
    });
    let blocks: Vec<(usize, usize)> = counted.collect();
    for row in 0..before {
        blocks
            .iter()
            .for_each(|(first, block)| at.extend((0..*block).map(|i| first + row * block + i)));
    }
    graph.moved(&parts, shape, &at)
}

/// Parts of some axes, with steps. Ends may lie beyond, and count from the end when negative.
fn slice<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let x = inputs.term(0)?;
    let stated = |name: &str, i: usize| inputs.setting(node, name, i)?.ok_or_else(|| missing(i));
    let (starts, ends) = (stated("starts", 1)?, stated("ends", 2)?);
    let all: Vec<i64> = (0..starts.len() as i64).collect();
    let ones = vec![1; starts.len()];
    let axes = inputs.setting(node, "axes", 3)?.unwrap_or(&all);
    let steps = inputs.setting(node, "steps", 4)?.unwrap_or(&ones);
    if [ends.len(), axes.len(), steps.len()].iter().any(|n| *n != starts.len()) {
        return Err("its starts, ends, axes and steps do not go together".into());
    }
    let mut view = View::of(&x.shape);
    for (i, axis) in axes_of(axes, x.shape.len())?.into_iter().enumerate() {
        let indices = indices(starts[i], ends[i], steps[i], view.shape[axis]);
        view = view.taken(axis, &indices)?;
    }
    graph.viewed(x, view)
}

/// The indices a slice names, as NumPy counts.
fn indices(start: i64, end: i64, step: i64, side: usize) -> Vec<usize> {
    let side = side as i64;
    let from_start = |v: i64| if v < 0 { v.saturating_add(side) } else { v };
    let (low, high) = if step < 0 { (-1, side - 1) } else { (0, side) };
    let (mut at, end) = (from_start(start).clamp(low, high), from_start(end).clamp(low, high));
    // An end further left than the first index, counted from the end, means "to the first".
    let mut indices = Vec::new();
    while (step > 0 && at < end) || (step < 0 && at > end) {
        indices.push(at as usize);
        at = at.saturating_add(step);
    }
    indices
}

/// Into parts along an axis: of given sizes, or as even as can be, the last one the smallest.
fn split<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Vec<Term<T>>> {
    let x = inputs.term(0)?;
    let axis = axis_of(node.int("axis").unwrap_or(0), x.shape.len())?;
    let (side, parts) = (x.shape[axis], node.outputs.len().max(1));
    let sizes = match inputs.setting(node, "split", 1)? {
        Some(sizes) => sizes.iter().map(|s| usize::try_from(*s).unwrap_or(0)).collect(),
        None => vec![side.div_ceil(parts); parts],
    };
    let mut at = 0_usize;
    let parts = sizes.into_iter().map(|size| {
        let end = at.saturating_add(size).min(side);
        let indices: Vec<usize> = (at..end).collect();
        at = end;
        graph.viewed(x, View::of(&x.shape).taken(axis, &indices)?)
    });
    parts.collect()
}

/// Repeated along axes of length 1 until a shape is met.
fn expand<T: Number>(graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, wanted) = (inputs.term(0)?, inputs.known(1)?);
    let wanted: Vec<usize> = wanted.iter().map(|side| usize::try_from(*side).unwrap_or(1)).collect();
    let shape = broadcast(&x.shape, &wanted)?;
    graph.expanded(x, &shape)
}

/// Repeated as often as said along each axis.
fn tile<T: Number>(graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, times) = (inputs.term(0)?, inputs.known(1)?);
    let times: Vec<usize> = times.iter().map(|t| usize::try_from(*t).unwrap_or(0)).collect();
    if times.len() != x.shape.len() || times.contains(&0) {
        return Err("it does not say for each axis how often to repeat it".into());
    }
    let mut view = View::of(&x.shape);
    for (axis, times) in times.into_iter().enumerate().filter(|(_, times)| *times > 1) {
        bounded([view.at.len(), times])?;
        let indices: Vec<usize> = (0..times).flat_map(|_| 0..view.shape[axis]).collect();
        view = view.taken(axis, &indices)?;
    }
    graph.viewed(x, view)
}

/// Channels into blocks of pixels, or back.
fn depth_and_space<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, [images, channels, rows, columns]) = inputs.planes(0)?;
    let side = node
        .int("blocksize")
        .and_then(|side| usize::try_from(side).ok())
        .filter(|side| *side > 0);
    let side = side.ok_or("its blocks make no sense")?;
    let area = bounded([side, side])?;
    let to_space = node.operator == "DepthToSpace";
    let depth = channels / area;
    let fits = if to_space {
        channels % area == 0
    } else {
        rows % side == 0 && columns % side == 0
    };
    if !fits {
        return Err("its blocks do not divide its input".into());
    }
    let (sides, order, shape) = match (to_space, node.text("mode")) {
        (false, _) => (
            vec![images, channels, rows / side, side, columns / side, side],
            [0, 3, 5, 1, 2, 4],
            vec![images, channels * area, rows / side, columns / side],
        ),
        (true, mode) => {
            let is_crd = mode == Some("CRD");
            let sides = if is_crd {
                [depth, side, side]
            } else {
                [side, side, depth]
            };
            (
                [&[images], &sides[..], &[rows, columns]].concat(),
                if is_crd { [0, 1, 4, 2, 5, 3] } else { [0, 3, 4, 1, 5, 2] },
                vec![images, depth, rows * side, columns * side],
            )
        }
    };
    let turned = graph.viewed(x, View::of(&sides).turned(&order))?;
    turned.shaped(shape)
}

pub(super) fn read<T: Number>(node: &Node) -> Option<Operator<'_, T>> {
    let new_shape = |inputs: &Inputs<T>| -> Result<Vec<usize>> {
        let old = &inputs.term(0)?.shape;
        match node.operator.as_str() {
            "Reshape" => reshape(
                old,
                inputs.setting(node, "shape", 1)?.unwrap_or_default(),
                node.int("allowzero") == Some(1),
            ),
            "Flatten" => flatten(old, node.int("axis").unwrap_or(1)),
            "Squeeze" => squeeze(old, inputs.setting(node, "axes", 1)?),
            _ => unsqueeze(old, inputs.setting(node, "axes", 1)?.unwrap_or_default()),
        }
    };
    match node.operator.as_str() {
        "Reshape" | "Flatten" | "Squeeze" | "Unsqueeze" => {
            one(move |_, inputs| inputs.term(0)?.shaped(new_shape(inputs)?))
        }
        "Transpose" => one(|graph, inputs| transpose(node, graph, inputs)),
        "Concat" => one(|graph, inputs| concat(node, graph, inputs)),
        "Slice" => one(|graph, inputs| slice(node, graph, inputs)),
        "Split" => several(|graph, inputs| split(node, graph, inputs)),
        "Expand" => one(expand),
        "Tile" => one(tile),
        "DepthToSpace" | "SpaceToDepth" => one(|graph, inputs| depth_and_space(node, graph, inputs)),
        _ => None,
    }
}
