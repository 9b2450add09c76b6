//! The tensors of a network while it is read: numbers, and what will follow from an image.

use std::sync::Arc;

use crate::layers::tape::Slot;
use crate::layers::{Array, Number};
use scaleproof_core::message::{Message, message};
use scaleproof_detect::onnx_model;

/// Slot of the image's numbers.
pub(super) const IMAGE: Slot = 0;

pub(super) type Result<T> = std::result::Result<T, Message>;

/// Row-major; truth values are 0 and 1.
#[derive(Debug, Clone)]
pub(super) enum Numbers<T> {
    Floats(Array<T>),
    Whole(Array<i64>),
}

#[derive(Debug, Clone)]
pub(super) struct Term<T> {
    pub shape: Vec<usize>,
    pub value: Value<T>,
}

#[derive(Debug, Clone)]
pub(super) enum Value<T> {
    Constant(Numbers<T>),
    /// Follows from the image.
    Image(Slot, Kind),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Fractions that a gradient passes.
    Followed,
    /// Fractions made of whole numbers alone.
    Free,
    Whole,
}

impl<T: Number> Numbers<T> {
    pub(super) fn count(&self) -> usize {
        match self {
            Numbers::Floats(v) => v.len(),
            Numbers::Whole(v) => v.len(),
        }
    }

    pub(super) fn whole(&self) -> Result<&[i64]> {
        match self {
            Numbers::Whole(v) => Ok(v),
            Numbers::Floats(_) => Err(NEVER_COMPUTED.into()),
        }
    }

    pub(super) fn floats(self) -> Result<Array<T>> {
        match self {
            Numbers::Floats(v) => Ok(v),
            Numbers::Whole(_) => Err(NEVER_COMPUTED.into()),
        }
    }
}

pub(super) const NEVER_COMPUTED: &str = "a value is never computed";

impl<T: Number> Term<T> {
    pub(super) fn floats(shape: Vec<usize>, numbers: Vec<T>) -> Term<T> {
        let value = Value::Constant(Numbers::Floats(Arc::new(numbers)));
        Term { shape, value }
    }

    pub(super) fn whole(shape: Vec<usize>, numbers: Vec<i64>) -> Term<T> {
        let value = Value::Constant(Numbers::Whole(Arc::new(numbers)));
        Term { shape, value }
    }

    /// A single fraction.
    pub(super) fn number(v: f64) -> Term<T> {
        Term::floats(Vec::new(), vec![T::of(v)])
    }

    pub(super) fn of_file(tensor: &onnx_model::Tensor) -> Term<T> {
        let shape = tensor.shape.clone();
        match &tensor.numbers {
            onnx_model::Numbers::Floats(v) => Term::floats(shape, v.iter().map(|v| T::of((*v).into())).collect()),
            onnx_model::Numbers::Whole(v) => Term::whole(shape, v.clone()),
        }
    }

    /// The same numbers in another shape.
    pub(super) fn shaped(&self, shape: Vec<usize>) -> Result<Term<T>> {
        if bounded(shape.iter().copied())? != self.count() {
            return Err(message!("a tensor {:?} cannot become {shape:?}", self.shape));
        }
        let value = self.value.clone();
        Ok(Term { shape, value })
    }

    pub(super) fn count(&self) -> usize {
        self.shape.iter().product()
    }

    pub(super) fn constant(&self) -> Option<&Numbers<T>> {
        match &self.value {
            Value::Constant(numbers) => Some(numbers),
            Value::Image(..) => None,
        }
    }

    pub(super) fn constant_floats(&self) -> Option<&Array<T>> {
        match self.constant()? {
            Numbers::Floats(v) => Some(v),
            Numbers::Whole(_) => None,
        }
    }

    pub(super) fn slot(&self) -> Option<Slot> {
        match self.value {
            Value::Constant(_) => None,
            Value::Image(slot, _) => Some(slot),
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match self.value {
            Value::Constant(Numbers::Floats(_)) => Kind::Free,
            Value::Constant(Numbers::Whole(_)) => Kind::Whole,
            Value::Image(_, kind) => kind,
        }
    }

    pub(super) fn is_whole(&self) -> bool {
        self.kind() == Kind::Whole
    }
}

/// A larger tensor is no part of a detector: it is refused before it takes memory, which would end the program.
const MOST_NUMBERS: usize = 1 << 28;

/// Returns the number of elements of a tensor with these sides, or an error above 2²⁸, also where a side of 0 would make the product 0.
pub(super) fn bounded(sides: impl IntoIterator<Item = usize>) -> Result<usize> {
    let (mut count, mut is_empty) = (1_usize, false);
    for side in sides {
        is_empty |= side == 0;
        count = count.saturating_mul(side.max(1));
    }
    match count {
        ..=MOST_NUMBERS => Ok(if is_empty { 0 } else { count }),
        _ => Err(too_large(MOST_NUMBERS)),
    }
}

pub(super) fn too_large(most: usize) -> Message {
    message!("its tensors would have more than {most} numbers")
}

pub(super) fn mismatch(what: &str, a: &[usize], b: &[usize]) -> Message {
    message!("{what} {a:?} and {b:?} do not go together")
}

pub(super) fn no_axis(rank: usize, axis: i64) -> Message {
    message!("a tensor of rank {rank} has no axis {axis}")
}

/// The shape two shapes broadcast to (ONNX: Multidirectional Broadcasting).
pub(super) fn broadcast(a: &[usize], b: &[usize]) -> Result<Vec<usize>> {
    let rank = a.len().max(b.len());
    let side = |shape: &[usize], i: usize| (i + shape.len()).checked_sub(rank).map_or(1, |i| shape[i]);
    let shape = (0..rank).map(|i| match (side(a, i), side(b, i)) {
        (x, y) if x == y || y == 1 => Ok(x),
        (1, y) => Ok(y),
        _ => Err(mismatch("tensors", a, b)),
    });
    let shape = shape.collect::<Result<Vec<_>>>()?;
    bounded(shape.iter().copied())?;
    Ok(shape)
}

/// An axis that may count from the end.
pub(super) fn axis_of(axis: i64, rank: usize) -> Result<usize> {
    let from_start = usize::try_from(if axis < 0 {
        axis.saturating_add(rank as i64)
    } else {
        axis
    });
    let axis_there = from_start.ok().filter(|a| *a < rank);
    axis_there.ok_or_else(|| no_axis(rank, axis))
}

/// Several axes that may count from the end.
pub(super) fn axes_of(axes: &[i64], rank: usize) -> Result<Vec<usize>> {
    axes.iter().map(|axis| axis_of(*axis, rank)).collect()
}
