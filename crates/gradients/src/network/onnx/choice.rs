//! Operators that choose by what they see: the largest numbers, numbers at computed indices, pixels at computed places.
//!
//! A gradient passes to what was chosen, and none through the choice itself, as in the frameworks these networks come from.

use burn::tensor::{Int, Tensor, TensorData};
use onnx_ir::Node;
use onnx_ir::grid_sample::{GridSampleMode, GridSamplePaddingMode};
use onnx_ir::topk::{TopKConfig, TopKInput};

use super::operator::{IntegerSetting, Operator, Rearranged, axes_of};
use super::value::{Floats, Integers, RANK, Result, Value, bounded, full};
use crate::NetworkFault;

/// The row-major index of the first number of each line along an axis, and the step from one number of a line to the next.
fn lines(shape: &[usize], axis: usize) -> (Vec<usize>, usize) {
    let step: usize = shape[axis + 1..].iter().product();
    let block = step * shape[axis];
    let before: usize = shape[..axis].iter().product();
    let starts = (0..before).flat_map(|i| (0..step).map(move |k| i * block + k));
    (starts.collect(), step)
}

/// The largest or smallest numbers along an axis, best first, and their indices; of equals, the first comes first.
fn top_k(config: &TopKConfig) -> Operator {
    let (axis, largest) = (config.axis, config.largest);
    let count = match &config.k {
        TopKInput::Static(k) => IntegerSetting::known(&[*k]),
        TopKInput::Runtime(r) => IntegerSetting::Input(r.input_index),
    };
    let chosen = Operator::with_outputs(move |mut inputs| {
        let count = count.values(&inputs)?;
        let v = inputs.floats(0)?;
        let mut shape = v.shape();
        let side = *shape.get(axis).ok_or(NetworkFault::NoAxis(shape.len(), axis as i64))?;
        let count = match count[..] {
            [k] => usize::try_from(k).ok().filter(|k| (1..=side).contains(k)),
            _ => None,
        };
        let count = count.ok_or("it asks for more numbers than there are")?;
        // −0 and 0 are equals.
        let numbers: Vec<f32> = v.values()?.into_iter().map(|number| number + 0.0).collect();
        let (starts, step) = lines(&shape, axis);
        shape[axis] = count;
        let mut data = vec![0; shape.iter().product()];
        let (new_starts, _) = lines(&shape, axis);
        let mut order: Vec<usize> = Vec::new();
        for (start, new_start) in starts.into_iter().zip(new_starts) {
            order.clear();
            order.extend(0..side);
            let ascending = |a: usize, b: usize| numbers[start + a * step].total_cmp(&numbers[start + b * step]);
            order.sort_by(|a, b| if largest { ascending(*b, *a) } else { ascending(*a, *b) });
            for (k, index) in order[..count].iter().enumerate() {
                data[new_start + k * step] = *index as i64;
            }
        }
        let indices = Integers { shape, data };
        Ok(vec![gathered(v, axis, &indices)?.into(), indices.into()])
    });
    chosen.rearranging(Rearranged::Ordered)
}

/// For each index the number at that index of its own line along the axis.
fn gathered(v: Floats, axis: usize, indices: &Integers) -> Result<Floats> {
    let (along, sides) = (v.axis(axis)?, full(&indices.shape)?);
    let indices = Tensor::<RANK, Int>::from_data(TensorData::new(indices.data.clone(), sides), &v.x.device());
    Ok(v.map(|x| x.gather(along, indices)))
}

fn gather_elements(axis: usize) -> Operator {
    Operator::moving(move |mut inputs| {
        let named = inputs.whole(1)?.clone();
        let value = inputs.value(0)?;
        let shape = value.shape();
        let fits = |i: usize| i == axis || shape.get(i) == named.shape.get(i);
        if axis >= shape.len() || named.shape.len() != shape.len() || !(0..shape.len()).all(fits) {
            return Err(NetworkFault::Mismatch("numbers and indices", shape, named.shape));
        }
        let data = axes_of(&named.data, shape[axis])?.into_iter().map(|i| i as i64);
        let (shape, data) = (named.shape, data.collect());
        let indices = Integers { shape, data };
        Ok(match value {
            Value::Floats(v) => Value::Floats(gathered(v, axis, &indices)?),
            Value::Integers(v) => Value::Integers(gathered_whole(&v, axis, indices)),
        })
    })
}

fn gathered_whole(v: &Integers, axis: usize, mut indices: Integers) -> Integers {
    let (starts, step) = lines(&v.shape, axis);
    let (new_starts, _) = lines(&indices.shape, axis);
    for (start, new_start) in starts.into_iter().zip(new_starts) {
        for k in 0..indices.shape[axis] {
            let index = &mut indices.data[new_start + k * step];
            *index = v.data[start + *index as usize * step];
        }
    }
    indices
}

/// Images looked at between their pixels, at places that −1 to 1 stand for (ONNX: GridSample, bilinear).
fn grid_sample(align_corners: bool, clamps: bool) -> Operator {
    Operator::new(move |mut inputs| {
        let images = inputs.floats(0)?.of_rank::<4>()?;
        let grid = inputs.floats(1)?.of_rank::<4>()?;
        let [count, channels, rows, columns] = images.dims();
        let [grids, new_rows, new_columns, coordinates] = grid.dims();
        if grids != count || coordinates != 2 || rows == 0 || columns == 0 {
            let (images, grid) = (images.dims().to_vec(), grid.dims().to_vec());
            return Err(NetworkFault::Mismatch("images and places", images, grid));
        }
        let places = new_rows * new_columns;
        bounded([channels, count, places])?;
        let device = images.device();
        let place = |axis: usize, side: usize| {
            let g = grid.clone().slice_dim(3, axis..axis + 1).reshape([1, count * places]);
            let side = side as f64;
            let at = if align_corners {
                (g + 1.0) * ((side - 1.0) / 2.0)
            } else {
                ((g + 1.0) * side - 1.0) / 2.0
            };
            if clamps { at.clamp(0.0, side - 1.0) } else { at }
        };
        let (x, y) = (place(0, columns), place(1, rows));
        let floors = |t: &Tensor<2>| -> Result<Vec<f32>> {
            let numbers = t.try_to_vec_as::<f32>().map_err(NetworkFault::framework)?;
            Ok(numbers.into_iter().map(f32::floor).collect())
        };
        let (left, top) = (floors(&x)?, floors(&y)?);
        let constant =
            |numbers: Vec<f32>| Tensor::<2>::from_data(TensorData::new(numbers, [1, count * places]), &device);
        let (right_share, lower_share) = (x - constant(left.clone()), y - constant(top.clone()));
        // All images beside each other, a row a channel.
        let pixels = images.swap_dims(0, 1).reshape([channels, count * rows * columns]);
        let parts = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| {
            let (mut indices, mut inside) = (Vec::new(), Vec::new());
            for (i, (left, top)) in left.iter().zip(&top).enumerate() {
                let (column, row) = (left + dx as f32, top + dy as f32);
                let is_inside = (0.0..columns as f32).contains(&column) && (0.0..rows as f32).contains(&row);
                inside.push(f32::from(u8::from(is_inside)));
                let pixel = if is_inside {
                    row as usize * columns + column as usize
                } else {
                    0
                };
                indices.push((i / places * rows * columns + pixel) as i64);
            }
            let indices = Tensor::<1, Int>::from_data(TensorData::new(indices, [count * places]), &device);
            let share = |share: &Tensor<2>, far: i32| if far == 1 { share.clone() } else { 1.0 - share.clone() };
            let weight = share(&right_share, dx) * share(&lower_share, dy) * constant(inside);
            pixels.clone().select(1, indices) * weight
        });
        let [first, others @ ..] = parts;
        let sum = others.into_iter().fold(first, |sum, part| sum + part);
        let sampled = sum.reshape([channels, count, new_rows, new_columns]).swap_dims(0, 1);
        Floats::from_rank(sampled)
    })
}

pub(super) fn read(node: &Node) -> Option<Operator> {
    match node {
        Node::TopK(n) => Some(top_k(&n.config)),
        Node::GatherElements(n) => Some(gather_elements(n.config.axis)),
        Node::GridSample(n) if n.config.mode == GridSampleMode::Bilinear => match n.config.padding_mode {
            GridSamplePaddingMode::Zeros => Some(grid_sample(n.config.align_corners, false)),
            GridSamplePaddingMode::Border => Some(grid_sample(n.config.align_corners, true)),
            GridSamplePaddingMode::Reflection => None,
        },
        _ => None,
    }
}
