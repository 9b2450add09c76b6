//! What flows along the edges of a network: tensors, and the whole numbers that shapes are computed with.

use std::sync::Arc;

use crate::NetworkFault;
use crate::layers::Array;
use burn::tensor::{Tensor, TensorData};
use onnx_ir::TensorDataExt;

pub(super) type Result<T> = std::result::Result<T, NetworkFault>;

pub(super) const NEVER_COMPUTED: &str = "a value is never computed";

impl NetworkFault {
    /// What the parser or the tensor framework says.
    pub(super) fn framework(said: impl std::fmt::Display) -> NetworkFault {
        NetworkFault::Framework(said.to_string())
    }
}

/// So many axes every tensor has here, those in front of its own with length 1.
///
/// The framework's types carry the rank; one rank for all keeps each operator one function, and broadcasting as ONNX does it is the
/// framework's own.
pub(super) const RANK: usize = 6;

// Nearly all values are tensors.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone)]
pub(super) enum Value {
    Floats(Floats),
    Integers(Integers),
}

#[derive(Debug, Clone)]
pub(super) struct Floats {
    pub x: Tensor<RANK>,
    /// The ONNX tensor's own rank, at most [`RANK`].
    pub rank: usize,
}

/// Whole numbers, row-major; truth values are 0 and 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Integers {
    pub shape: Vec<usize>,
    pub data: Vec<i64>,
}

/// What a slot holds while an image is looked at.
#[derive(Debug, Clone)]
pub(super) enum Held {
    Floats { shape: Vec<usize>, numbers: Array },
    Whole(Integers),
}

impl Held {
    pub(super) fn from_value(value: &Value) -> Result<Held> {
        Ok(match value {
            Value::Floats(v) => Held::Floats {
                shape: v.shape(),
                numbers: Arc::new(v.values()?),
            },
            Value::Integers(v) => Held::Whole(v.clone()),
        })
    }
}

impl From<Floats> for Value {
    fn from(v: Floats) -> Value {
        Value::Floats(v)
    }
}

impl From<Integers> for Value {
    fn from(v: Integers) -> Value {
        Value::Integers(v)
    }
}

impl Value {
    /// Does it change with the image?
    pub(super) fn requires_grad(&self) -> bool {
        matches!(self, Value::Floats(v) if v.x.is_tracked())
    }

    pub(super) fn shape(&self) -> Vec<usize> {
        match self {
            Value::Floats(v) => v.shape(),
            Value::Integers(v) => v.shape.clone(),
        }
    }

    pub(super) fn constant(data: &TensorData, device: &burn::tensor::Device) -> Result<Value> {
        let shape = data.shape().to_vec();
        if data.dtype().is_float() {
            let unreadable = |e| NetworkFault::Framework(format!("a constant of it cannot be read: {e}"));
            let values = data.to_f32_vec().map_err(unreadable)?;
            return Floats::new(values, &shape, device).map(Value::Floats);
        }
        let data = data.iter::<i64>().collect();
        Ok(Value::Integers(Integers { shape, data }))
    }
}

impl Floats {
    pub(super) fn new(values: Vec<f32>, shape: &[usize], device: &burn::tensor::Device) -> Result<Floats> {
        let x = Tensor::from_data(TensorData::new(values, full(shape)?), device);
        Ok(Floats { x, rank: shape.len() })
    }

    pub(super) fn shape(&self) -> Vec<usize> {
        self.x.dims()[RANK - self.rank..].to_vec()
    }

    /// The framework's number of an axis of the ONNX tensor.
    pub(super) fn axis(&self, axis: usize) -> Result<usize> {
        let is_there = (axis < self.rank).then_some(RANK - self.rank + axis);
        is_there.ok_or(NetworkFault::NoAxis(self.rank, axis as i64))
    }

    pub(super) fn reshaped(self, shape: &[usize]) -> Result<Floats> {
        let wanted: usize = shape.iter().product();
        if self.x.shape().num_elements() != wanted {
            return Err(NetworkFault::Reshape(self.shape(), shape.to_vec()));
        }
        let (x, rank) = (self.x.reshape(full(shape)?), shape.len());
        Ok(Floats { x, rank })
    }

    /// With its own rank in its type; `R` must be that rank.
    pub(super) fn of_rank<const R: usize>(self) -> Result<Tensor<R>> {
        let shape = self.shape();
        let sides: [usize; R] = shape.try_into().map_err(|shape| NetworkFault::Rank(shape, R))?;
        Ok(self.x.reshape(sides))
    }

    pub(super) fn from_rank<const R: usize>(x: Tensor<R>) -> Result<Floats> {
        let shape = full(&x.dims())?;
        let (x, rank) = (x.reshape(shape), R);
        Ok(Floats { x, rank })
    }

    pub(super) fn map(self, f: impl FnOnce(Tensor<RANK>) -> Tensor<RANK>) -> Floats {
        let (x, rank) = (f(self.x), self.rank);
        Floats { x, rank }
    }

    /// The numbers, row-major.
    pub(super) fn values(&self) -> Result<Vec<f32>> {
        self.x.try_to_vec_as::<f32>().map_err(NetworkFault::framework)
    }
}

/// A shape with ones in front, [`RANK`] axes in all.
pub(super) fn full(shape: &[usize]) -> Result<[usize; RANK]> {
    let mut sides = [1; RANK];
    let from = RANK.checked_sub(shape.len());
    sides[from.ok_or_else(|| NetworkFault::TooManyAxes(shape.to_vec(), RANK))?..].copy_from_slice(shape);
    Ok(sides)
}

/// A larger tensor is no part of a detector: it is refused before it takes memory, which would end the program.
const MOST_NUMBERS: usize = 1 << 28;

/// How many numbers a tensor of these sides has.
pub(super) fn bounded(sides: impl IntoIterator<Item = usize>) -> Result<usize> {
    let count = (sides.into_iter()).try_fold(1_usize, |count, side| count.checked_mul(side));
    let count = count.filter(|count| *count <= MOST_NUMBERS);
    count.ok_or(NetworkFault::TooLarge(MOST_NUMBERS))
}

/// The shape two shapes broadcast to (ONNX: Multidirectional Broadcasting).
pub(super) fn broadcast(a: &[usize], b: &[usize]) -> Result<Vec<usize>> {
    let rank = a.len().max(b.len());
    let side = |shape: &[usize], i: usize| (i + shape.len()).checked_sub(rank).map_or(1, |i| shape[i]);
    (0..rank)
        .map(|i| match (side(a, i), side(b, i)) {
            (x, y) if x == y || y == 1 => Ok(x),
            (1, y) => Ok(y),
            _ => Err(NetworkFault::Mismatch("tensors", a.to_vec(), b.to_vec())),
        })
        .collect()
}
