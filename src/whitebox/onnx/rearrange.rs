//! Operators that only put numbers elsewhere: reshape, transpose, concatenate, cut, select, repeat.

use std::sync::Arc;

use burn::tensor::{Int, Slice, Tensor, TensorData};
use onnx_ir::Node;
use onnx_ir::expand::ExpandConfig;
use onnx_ir::reshape::ReshapeInput;
use onnx_ir::slice::SliceInput;
use onnx_ir::split::SplitSizesInput;
use onnx_ir::squeeze::SqueezeInput;
use onnx_ir::tile::TileInput;
use onnx_ir::unsqueeze::UnsqueezeConfig;

use super::operator::{AnyOperator, Inputs, IntegerSetting, Operator, Rearranged, axis_of};
use super::value::{Floats, Integers, RANK, Value, bounded, broadcast, full};
use crate::whitebox::NetworkFault;

impl Value {
    fn reshaped(self, shape: &[usize]) -> Result<Value, NetworkFault> {
        match self {
            Value::Floats(v) => v.reshaped(shape).map(Value::Floats),
            Value::Integers(v) if v.data.len() == shape.iter().product::<usize>() => Ok(Value::Integers(Integers {
                shape: shape.to_vec(),
                data: v.data,
            })),
            Value::Integers(v) => Err(NetworkFault::Reshape(v.shape, shape.to_vec())),
        }
    }

    /// Some indices of an axis, in an order of their own.
    fn taken(self, axis: usize, indices: &[usize]) -> Result<Value, NetworkFault> {
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
    fn taken(self, axis: usize, indices: &[usize]) -> Result<Floats, NetworkFault> {
        let (rank, axis) = (self.rank, self.axis(axis)?);
        let (first, last) = (indices[0], indices[indices.len() - 1]);
        let step = indices.get(1).map_or(1, |second| second.saturating_sub(first)).max(1);
        let is_even = indices.iter().enumerate().all(|(i, p)| *p == first + i * step);
        let x = if is_even {
            let slice = Slice::new(first as isize, Some(last as isize + 1), step as isize);
            self.x.slice_dim(axis, slice)
        } else {
            let data: Vec<i64> = indices.iter().map(|p| *p as i64).collect();
            let indices = Tensor::<1, Int>::from_data(TensorData::new(data, [indices.len()]), &self.x.device());
            self.x.select(axis, indices)
        };
        Ok(Floats { x, rank })
    }
}

impl Integers {
    fn taken(&self, axis: usize, indices: &[usize]) -> Integers {
        let after: usize = self.shape[axis + 1..].iter().product();
        let block = self.shape[axis] * after;
        let data = self.data.chunks(block.max(1)).flat_map(|block| {
            let rows = indices.iter().map(|p| &block[p * after..(p + 1) * after]);
            rows.flatten().copied().collect::<Vec<_>>()
        });
        let data = data.collect();
        let mut shape = self.shape.clone();
        shape[axis] = indices.len();
        Integers { shape, data }
    }
}

/// To a shape in which −1 stands for the rest, 0 for the side as it is.
struct Reshape(IntegerSetting);

impl Operator for Reshape {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let wanted = self.0.of(&inputs)?;
        let value = inputs.value(0)?;
        let old = value.shape();
        let sides: Result<Vec<Option<usize>>, NetworkFault> = wanted
            .iter()
            .enumerate()
            .map(|(i, side)| match side {
                -1 => Ok(None),
                0 => old
                    .get(i)
                    .copied()
                    .map(Some)
                    .ok_or(NetworkFault::Malformed("it keeps a side that is not there")),
                side => usize::try_from(*side)
                    .map(Some)
                    .map_err(|_| NetworkFault::Malformed("a side of it is less than nothing")),
            })
            .collect();
        let sides = sides?;
        let known: usize = sides.iter().flatten().product();
        let rest = old.iter().product::<usize>().checked_div(known).unwrap_or(0);
        let shape: Vec<usize> = sides.into_iter().map(|side| side.unwrap_or(rest)).collect();
        Ok(vec![value.reshaped(&shape)?])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

/// Everything before an axis becomes the rows, the rest the columns.
struct Flatten(usize);

impl Operator for Flatten {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let value = inputs.value(0)?;
        let shape = value.shape();
        if self.0 > shape.len() {
            return Err(NetworkFault::NoAxis(shape.len(), self.0 as i64));
        }
        let (rows, columns) = shape.split_at(self.0);
        let shape = [rows.iter().product(), columns.iter().product()];
        Ok(vec![value.reshaped(&shape)?])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

/// Axes of length 1 go; all of them when none is named.
struct Squeeze(Option<IntegerSetting>);

impl Operator for Squeeze {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let axes = self.0.as_ref().map(|axes| axes.of(&inputs)).transpose()?;
        let value = inputs.value(0)?;
        let shape = value.shape();
        let gone: Result<Vec<usize>, NetworkFault> = match axes {
            Some(axes) => axes.iter().map(|a| axis_of(*a, shape.len())).collect(),
            None => Ok((0..shape.len()).filter(|i| shape[*i] == 1).collect()),
        };
        let gone = gone?;
        let left: Vec<usize> = (0..shape.len())
            .filter(|i| !gone.contains(i))
            .map(|i| shape[i])
            .collect();
        Ok(vec![value.reshaped(&left)?])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

/// Axes of length 1 come in, numbered as in the result.
struct Unsqueeze(IntegerSetting);

impl Operator for Unsqueeze {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let axes = self.0.of(&inputs)?;
        let value = inputs.value(0)?;
        let mut shape = value.shape();
        let rank = shape.len() + axes.len();
        let new: Result<Vec<usize>, NetworkFault> = axes.iter().map(|a| axis_of(*a, rank)).collect();
        let mut new = new?;
        new.sort_unstable();
        for axis in new {
            if axis > shape.len() {
                return Err(NetworkFault::NoAxis(shape.len(), axis as i64));
            }
            shape.insert(axis, 1);
        }
        Ok(vec![value.reshaped(&shape)?])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

struct Transpose(Vec<usize>);

impl Operator for Transpose {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let Floats { x, rank } = inputs.floats(0)?;
        let mut seen = self.0.clone();
        seen.sort_unstable();
        if seen != (0..rank).collect::<Vec<_>>() {
            return Err("its order of axes does not name each of them once".into());
        }
        let front = RANK - rank;
        let order: [usize; RANK] = std::array::from_fn(|i| match i.checked_sub(front) {
            Some(i) => front + self.0[i],
            None => i,
        });
        Ok(vec![Value::Floats(Floats {
            x: x.permute(order.map(|axis| axis as isize)),
            rank,
        })])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

struct Concat(usize);

impl Operator for Concat {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let first = inputs
            .values
            .first()
            .and_then(Option::as_ref)
            .ok_or("it has no input")?;
        let shape = first.shape();
        if self.0 >= shape.len() {
            return Err(NetworkFault::NoAxis(shape.len(), self.0 as i64));
        }
        let fits = |v: &Value| {
            let other = v.shape();
            other.len() == shape.len() && (0..shape.len()).all(|i| i == self.0 || other[i] == shape[i])
        };
        if !inputs.values.iter().flatten().all(fits) {
            return Err("its inputs do not go together along its axis".into());
        }
        if matches!(first, Value::Integers(_)) {
            return self.whole(&inputs);
        }
        let rank = shape.len();
        let tensors: Result<Vec<_>, NetworkFault> = (0..inputs.count()).map(|i| Ok(inputs.floats(i)?.x)).collect();
        let x = Tensor::cat(tensors?, RANK - rank + self.0);
        Ok(vec![Value::Floats(Floats { x, rank })])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::All
    }
}

impl Concat {
    fn whole(&self, inputs: &Inputs) -> Result<Vec<Value>, NetworkFault> {
        let parts: Result<Vec<&Integers>, NetworkFault> = (0..inputs.count()).map(|i| inputs.whole(i)).collect();
        let parts = parts?;
        let mut shape = parts[0].shape.clone();
        shape[self.0] = parts.iter().map(|p| p.shape[self.0]).sum();
        let before: usize = shape[..self.0].iter().product();
        let data = (0..before).flat_map(|i| {
            let blocks = parts.iter().map(move |p| {
                let block = p.data.len() / before;
                &p.data[i * block..(i + 1) * block]
            });
            blocks.flatten().copied()
        });
        let data = data.collect();
        Ok(vec![Value::Integers(Integers { shape, data })])
    }
}

/// Parts of some axes, with steps. Ends may lie beyond, and count from the end when negative.
struct Cut {
    starts: IntegerSetting,
    ends: IntegerSetting,
    axes: Option<IntegerSetting>,
    steps: Option<IntegerSetting>,
}

impl Operator for Cut {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let (starts, ends) = (self.starts.of(&inputs)?, self.ends.of(&inputs)?);
        let axes = match &self.axes {
            Some(axes) => axes.of(&inputs)?,
            None => (0..starts.len() as i64).collect(),
        };
        let steps = match &self.steps {
            Some(steps) => steps.of(&inputs)?,
            None => vec![1; starts.len()],
        };
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
        Ok(vec![value])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
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
struct Split {
    axis: usize,
    sizes: Option<IntegerSetting>,
    parts: usize,
}

impl Operator for Split {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let sizes = self.sizes.as_ref().map(|sizes| sizes.of(&inputs)).transpose()?;
        let value = inputs.value(0)?;
        let side = *value
            .shape()
            .get(self.axis)
            .ok_or("it splits an axis that is not there")?;
        let sizes = match sizes {
            Some(sizes) => sizes.iter().map(|s| usize::try_from(*s).unwrap_or(0)).collect(),
            None => vec![side.div_ceil(self.parts); self.parts],
        };
        let mut at = 0;
        let parts = sizes.iter().map(|size| {
            let end = (at + size).min(side);
            let indices: Vec<usize> = (at..end).collect();
            at = end;
            value.clone().taken(self.axis, &indices)
        });
        parts.collect()
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

/// Indices along an axis; the indices' own shape takes the axis' place.
struct Gather(usize);

impl Operator for Gather {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let named = inputs.whole(1)?.clone();
        let value = inputs.value(0)?;
        let shape = value.shape();
        let side = *shape.get(self.0).ok_or("it selects from an axis that is not there")?;
        let indices: Result<Vec<usize>, NetworkFault> = named.data.iter().map(|index| axis_of(*index, side)).collect();
        let taken = value.taken(self.0, &indices?)?;
        let shape = [&shape[..self.0], &named.shape, &shape[self.0 + 1..]].concat();
        Ok(vec![taken.reshaped(&shape)?])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

/// Repeated along axes of length 1 until a shape is met.
struct Expand(IntegerSetting);

impl Operator for Expand {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let wanted = self.0.of(&inputs)?;
        let wanted: Vec<usize> = wanted.iter().map(|side| usize::try_from(*side).unwrap_or(1)).collect();
        let Floats { x, rank } = inputs.floats(0)?;
        let shape = broadcast(&x.dims()[RANK - rank..], &wanted)?;
        bounded(shape.iter().copied())?;
        let x = x.expand(full(&shape)?);
        let rank = shape.len();
        Ok(vec![Value::Floats(Floats { x, rank })])
    }
}

/// Repeated as often as said along each axis.
struct Tile(IntegerSetting);

impl Operator for Tile {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let times = self.0.of(&inputs)?;
        let Floats { x, rank } = inputs.floats(0)?;
        let times: Vec<usize> = times.iter().map(|t| usize::try_from(*t).unwrap_or(0)).collect();
        if times.len() != rank || times.contains(&0) {
            return Err("it does not say for each axis how often to repeat it".into());
        }
        let times = full(&times)?;
        bounded(
            x.dims()
                .iter()
                .zip(&times)
                .map(|(side, times)| side.saturating_mul(*times)),
        )?;
        let x = x.repeat(&times);
        Ok(vec![Value::Floats(Floats { x, rank })])
    }
}

fn cut_numbers(input: &SliceInput) -> IntegerSetting {
    match input {
        SliceInput::Static(v) => IntegerSetting::Known(v.clone()),
        SliceInput::Runtime(r) => IntegerSetting::input(r),
    }
}

pub(super) fn read(node: &Node) -> Option<AnyOperator> {
    Some(match node {
        Node::Reshape(n) => Arc::new(Reshape(match &n.config.shape {
            ReshapeInput::Static(v) => IntegerSetting::Known(v.clone()),
            ReshapeInput::Runtime(r) => IntegerSetting::input(r),
        })),
        Node::Flatten(n) => Arc::new(Flatten(n.config.axis)),
        Node::Squeeze(n) => Arc::new(Squeeze(n.config.axes.as_ref().map(|axes| match axes {
            SqueezeInput::Static(v) => IntegerSetting::Known(v.clone()),
            SqueezeInput::Runtime(r) => IntegerSetting::input(r),
        }))),
        Node::Unsqueeze(n) => Arc::new(Unsqueeze(match &n.config {
            UnsqueezeConfig::Static(v) => IntegerSetting::Known(v.clone()),
            UnsqueezeConfig::Runtime(r) => IntegerSetting::input(r),
        })),
        Node::Transpose(n) => Arc::new(Transpose(
            n.config
                .perm
                .iter()
                .map(|axis| usize::try_from(*axis).unwrap_or(RANK))
                .collect(),
        )),
        Node::Concat(n) => Arc::new(Concat(n.config.axis)),
        Node::Slice(n) => Arc::new(Cut {
            starts: cut_numbers(&n.config.starts),
            ends: cut_numbers(&n.config.ends),
            axes: n.config.axes.as_ref().map(cut_numbers),
            steps: n.config.steps.as_ref().map(cut_numbers),
        }),
        Node::Split(n) => Arc::new(Split {
            axis: n.config.axis,
            sizes: n.config.split_sizes.as_ref().map(|sizes| match sizes {
                SplitSizesInput::Static(v) => IntegerSetting::known(v),
                SplitSizesInput::Runtime(r) => IntegerSetting::input(r),
            }),
            parts: n.outputs.len(),
        }),
        Node::Gather(n) => Arc::new(Gather(n.config.axis)),
        Node::Expand(n) => Arc::new(Expand(match &n.config {
            ExpandConfig::Static(v) => IntegerSetting::Known(v.clone()),
            ExpandConfig::Runtime(r) => IntegerSetting::input(r),
        })),
        Node::Tile(n) => Arc::new(Tile(match &n.config.repeats {
            TileInput::Static(v) => IntegerSetting::known(v),
            TileInput::Runtime(r) => IntegerSetting::input(r),
        })),
        _ => return None,
    })
}
