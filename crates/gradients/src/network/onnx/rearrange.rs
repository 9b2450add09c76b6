//! Operators that only put numbers elsewhere: reshape, transpose, concatenate, cut, select, repeat.

use burn::tensor::{Int, Slice, Tensor, TensorData};
use onnx_ir::Node;
use onnx_ir::expand::ExpandConfig;
use onnx_ir::reshape::ReshapeInput;
use onnx_ir::slice::{SliceConfig, SliceInput};
use onnx_ir::split::SplitSizesInput;
use onnx_ir::squeeze::SqueezeInput;
use onnx_ir::tile::TileInput;
use onnx_ir::unsqueeze::UnsqueezeConfig;

use super::operator::{Inputs, IntegerSetting, Operator, Rearranged, axes_of, axis_of, setting};
use super::value::{Floats, Integers, RANK, Result, Value, bounded, broadcast, full};
use crate::NetworkFault;

impl Value {
    fn reshaped(self, shape: &[usize]) -> Result<Value> {
        match self {
            Value::Floats(v) => v.reshaped(shape).map(Value::Floats),
            Value::Integers(v) if v.data.len() != shape.iter().product::<usize>() => {
                Err(NetworkFault::Reshape(v.shape, shape.to_vec()))
            }
            Value::Integers(Integers { data, .. }) => {
                let shape = shape.to_vec();
                Ok(Integers { shape, data }.into())
            }
        }
    }

    /// Some indices of an axis, in an order of their own.
    fn taken(self, axis: usize, indices: &[usize]) -> Result<Value> {
        let side = self.shape().get(axis).copied().unwrap_or(0);
        if indices.is_empty() || indices.iter().any(|p| *p >= side) {
            return Err(NetworkFault::Indices(indices.to_vec(), side));
        }
        Ok(match self {
            Value::Floats(v) => Value::Floats(v.taken(axis, indices)?),
            Value::Integers(v) => Value::Integers(v.taken(axis, indices)),
        })
    }
}

impl Floats {
    fn taken(self, axis: usize, indices: &[usize]) -> Result<Floats> {
        let axis = self.axis(axis)?;
        let (first, last) = (indices[0], indices[indices.len() - 1]);
        let step = indices.get(1).map_or(1, |second| second.saturating_sub(first)).max(1);
        let is_even = indices.iter().enumerate().all(|(i, p)| *p == first + i * step);
        if is_even {
            let slice = Slice::new(first as isize, Some(last as isize + 1), step as isize);
            return Ok(self.map(|x| x.slice_dim(axis, slice)));
        }
        let data: Vec<i64> = indices.iter().map(|p| *p as i64).collect();
        let indices = Tensor::<1, Int>::from_data(TensorData::new(data, [indices.len()]), &self.x.device());
        Ok(self.map(|x| x.select(axis, indices)))
    }
}

impl Integers {
    fn taken(mut self, axis: usize, indices: &[usize]) -> Integers {
        let after: usize = self.shape[axis + 1..].iter().product();
        let blocks = self.data.chunks((self.shape[axis] * after).max(1));
        let rows = blocks.flat_map(|block| indices.iter().map(move |p| &block[p * after..][..after]));
        self.data = rows.flatten().copied().collect();
        self.shape[axis] = indices.len();
        self
    }
}

/// To another shape, by the old one and the values of a setting, if there is one.
fn reshaping(
    setting: Option<IntegerSetting>,
    new_shape: impl Fn(Vec<usize>, Option<Vec<i64>>) -> Result<Vec<usize>> + Send + Sync + 'static,
) -> Operator {
    Operator::moving(move |mut inputs| {
        let wanted = IntegerSetting::optional(&setting, &inputs)?;
        let value = inputs.value(0)?;
        let shape = new_shape(value.shape(), wanted)?;
        value.reshaped(&shape)
    })
}

/// −1 stands for the rest, 0 for the side as it is.
fn reshape(old: Vec<usize>, wanted: Option<Vec<i64>>) -> Result<Vec<usize>> {
    let side = |(i, side): (usize, &i64)| -> Result<Option<usize>> {
        match side {
            -1 => Ok(None),
            0 => Ok(Some(*old.get(i).ok_or("it keeps a side that is not there")?)),
            ..0 => Err("a side of it is less than nothing".into()),
            side => Ok(usize::try_from(*side).ok()),
        }
    };
    let sides = wanted.iter().flatten().enumerate().map(side);
    let sides: Vec<Option<usize>> = sides.collect::<Result<_>>()?;
    let known: usize = sides.iter().flatten().product();
    let rest = old.iter().product::<usize>().checked_div(known).unwrap_or(0);
    Ok(sides.into_iter().map(|side| side.unwrap_or(rest)).collect())
}

/// Everything before an axis becomes the rows, the rest the columns.
fn flatten(axis: usize, old: &[usize]) -> Result<Vec<usize>> {
    let sides = old.split_at_checked(axis);
    let (rows, columns) = sides.ok_or(NetworkFault::NoAxis(old.len(), axis as i64))?;
    Ok(vec![rows.iter().product(), columns.iter().product()])
}

/// Axes of length 1 go; all of them when none is named.
fn squeeze(old: Vec<usize>, axes: Option<Vec<i64>>) -> Result<Vec<usize>> {
    let gone = match axes {
        Some(axes) => axes_of(&axes, old.len())?,
        None => (0..old.len()).filter(|i| old[*i] == 1).collect(),
    };
    Ok((0..old.len()).filter(|i| !gone.contains(i)).map(|i| old[i]).collect())
}

/// Axes of length 1 come in, numbered as in the result.
fn unsqueeze(mut shape: Vec<usize>, axes: Option<Vec<i64>>) -> Result<Vec<usize>> {
    let axes = axes.unwrap_or_default();
    let mut new = axes_of(&axes, shape.len() + axes.len())?;
    new.sort_unstable();
    for axis in new {
        if axis > shape.len() {
            return Err(NetworkFault::NoAxis(shape.len(), axis as i64));
        }
        shape.insert(axis, 1);
    }
    Ok(shape)
}

fn transpose(order: &[i64]) -> Operator {
    let order: Vec<usize> = (order.iter().map(|axis| usize::try_from(*axis).unwrap_or(RANK))).collect();
    Operator::moving(move |mut inputs| {
        let v = inputs.floats(0)?;
        let mut seen = order.clone();
        seen.sort_unstable();
        if seen != (0..v.rank).collect::<Vec<_>>() {
            return Err("its order of axes does not name each of them once".into());
        }
        let front = RANK - v.rank;
        let order: [usize; RANK] = std::array::from_fn(|i| i.checked_sub(front).map_or(i, |i| front + order[i]));
        Ok(v.map(|x| x.permute(order.map(|axis| axis as isize))))
    })
}

fn concat(axis: usize) -> Operator {
    let concat = Operator::new(move |mut inputs| {
        let first = inputs.values.first().and_then(Option::as_ref);
        let first = first.ok_or("it has no input")?;
        let shape = first.shape();
        if axis >= shape.len() {
            return Err(NetworkFault::NoAxis(shape.len(), axis as i64));
        }
        let fits = |v: &Value| {
            let other = v.shape();
            other.len() == shape.len() && (0..shape.len()).all(|i| i == axis || other[i] == shape[i])
        };
        if !inputs.values.iter().flatten().all(fits) {
            return Err("its inputs do not go together along its axis".into());
        }
        if matches!(first, Value::Integers(_)) {
            return concat_whole(axis, &inputs).map(Value::Integers);
        }
        let rank = shape.len();
        let tensors = (0..inputs.count()).map(|i| Ok(inputs.floats(i)?.x));
        let x = Tensor::cat(tensors.collect::<Result<_>>()?, RANK - rank + axis);
        Ok(Floats { x, rank }.into())
    });
    concat.rearranging(Rearranged::All)
}

fn concat_whole(axis: usize, inputs: &Inputs) -> Result<Integers> {
    let parts: Vec<&Integers> = (0..inputs.count()).map(|i| inputs.whole(i)).collect::<Result<_>>()?;
    let mut shape = parts[0].shape.clone();
    shape[axis] = parts.iter().map(|p| p.shape[axis]).sum();
    let before: usize = shape[..axis].iter().product();
    let (mut data, mut left) = (Vec::new(), parts.iter().map(|p| &p.data[..]).collect::<Vec<_>>());
    for _ in 0..before {
        for (part, rest) in parts.iter().zip(&mut left) {
            data.extend(rest.split_off(..part.data.len() / before).unwrap_or_default());
        }
    }
    Ok(Integers { shape, data })
}

/// Parts of some axes, with steps. Ends may lie beyond, and count from the end when negative.
fn slice(config: &SliceConfig) -> Operator {
    let numbers = |input: &SliceInput| setting!(SliceInput, input);
    let [starts, ends] = [&config.starts, &config.ends].map(numbers);
    let [axes, steps] = [&config.axes, &config.steps].map(|input| input.as_ref().map(numbers));
    Operator::moving(move |mut inputs| {
        let (starts, ends) = (starts.values(&inputs)?, ends.values(&inputs)?);
        let axes = IntegerSetting::optional(&axes, &inputs)?.unwrap_or_else(|| (0..starts.len() as i64).collect());
        let steps = IntegerSetting::optional(&steps, &inputs)?.unwrap_or_else(|| vec![1; starts.len()]);
        if [ends.len(), axes.len(), steps.len()].iter().any(|n| *n != starts.len()) {
            return Err("its starts, ends, axes and steps do not go together".into());
        }
        let mut value = inputs.value(0)?;
        for (i, axis) in axes.iter().enumerate() {
            let shape = value.shape();
            let axis = axis_of(*axis, shape.len())?;
            let indices = indices(starts[i], ends[i], steps[i], shape[axis]);
            if indices.len() < shape[axis] || steps[i] < 0 {
                value = value.taken(axis, &indices)?;
            }
        }
        Ok(value)
    })
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
        at += step;
    }
    indices
}

/// Into parts along an axis: of given sizes, or as even as can be, the last one the smallest.
fn split(axis: usize, sizes: Option<IntegerSetting>, parts: usize) -> Operator {
    let split = Operator::with_outputs(move |mut inputs| {
        let sizes = IntegerSetting::optional(&sizes, &inputs)?;
        let value = inputs.value(0)?;
        let shape = value.shape();
        let side = *shape.get(axis).ok_or("it splits an axis that is not there")?;
        let sizes = match sizes {
            Some(sizes) => sizes.iter().map(|s| usize::try_from(*s).unwrap_or(0)).collect(),
            None => vec![side.div_ceil(parts); parts],
        };
        let mut at = 0;
        let parts = sizes.iter().map(|size| {
            let end = (at + size).min(side);
            let indices: Vec<usize> = (at..end).collect();
            at = end;
            value.clone().taken(axis, &indices)
        });
        parts.collect()
    });
    split.rearranging(Rearranged::First)
}

/// Indices along an axis; the indices' own shape takes the axis' place.
fn gather(axis: usize) -> Operator {
    Operator::moving(move |mut inputs| {
        let named = inputs.whole(1)?.clone();
        let value = inputs.value(0)?;
        let shape = value.shape();
        let side = *shape.get(axis).ok_or("it selects from an axis that is not there")?;
        let taken = value.taken(axis, &axes_of(&named.data, side)?)?;
        taken.reshaped(&[&shape[..axis], &named.shape, &shape[axis + 1..]].concat())
    })
}

/// Repeated along axes of length 1 until a shape is met.
fn expand(wanted: IntegerSetting) -> Operator {
    Operator::new(move |mut inputs| {
        let wanted = wanted.values(&inputs)?;
        let wanted: Vec<usize> = wanted.iter().map(|side| usize::try_from(*side).unwrap_or(1)).collect();
        let v = inputs.floats(0)?;
        let shape = broadcast(&v.shape(), &wanted)?;
        bounded(shape.iter().copied())?;
        let (x, rank) = (v.x.expand(full(&shape)?), shape.len());
        Ok(Floats { x, rank })
    })
}

/// Repeated as often as said along each axis.
fn tile(times: IntegerSetting) -> Operator {
    Operator::new(move |mut inputs| {
        let times = times.values(&inputs)?;
        let value = inputs.value(0)?;
        let shape = value.shape();
        let times: Vec<usize> = times.iter().map(|t| usize::try_from(*t).unwrap_or(0)).collect();
        if times.len() != shape.len() || times.contains(&0) {
            return Err("it does not say for each axis how often to repeat it".into());
        }
        let sides = shape.iter().zip(&times);
        bounded(sides.map(|(side, times)| side.saturating_mul(*times)))?;
        match value {
            Value::Floats(v) => {
                let times = full(&times)?;
                Ok(v.map(|x| x.repeat(&times)).into())
            }
            whole => (0..shape.len()).try_fold(whole, |whole, axis| {
                let indices: Vec<usize> = (0..times[axis]).flat_map(|_| 0..shape[axis]).collect();
                whole.taken(axis, &indices)
            }),
        }
    })
}

pub(super) fn read(node: &Node) -> Option<Operator> {
    Some(match node {
        Node::Reshape(n) => reshaping(Some(setting!(ReshapeInput, &n.config.shape)), reshape),
        Node::Flatten(n) => {
            let axis = n.config.axis;
            reshaping(None, move |old, _| flatten(axis, &old))
        }
        Node::Squeeze(n) => {
            let axes = n.config.axes.as_ref().map(|axes| setting!(SqueezeInput, axes));
            reshaping(axes, squeeze)
        }
        Node::Unsqueeze(n) => reshaping(Some(setting!(UnsqueezeConfig, &n.config)), unsqueeze),
        Node::Transpose(n) => transpose(&n.config.perm),
        Node::Concat(n) => concat(n.config.axis),
        Node::Slice(n) => slice(&n.config),
        Node::Split(n) => {
            let c = &n.config;
            let sizes = c.split_sizes.as_ref().map(|sizes| setting!(SplitSizesInput, sizes));
            split(c.axis, sizes, n.outputs.len())
        }
        Node::Gather(n) => gather(n.config.axis),
        Node::Expand(n) => expand(setting!(ExpandConfig, &n.config)),
        Node::Tile(n) => tile(setting!(TileInput, &n.config.repeats)),
        _ => return None,
    })
}
