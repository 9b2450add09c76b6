//! Operators that compute shapes.

use onnx_ir::constant_of_shape::ConstantOfShapeShape;
use onnx_ir::range::RangeInput;
use onnx_ir::{Node, TensorData, TensorDataExt};

use super::operator::{IntegerSetting, Operator, setting};
use super::value::{Floats, Integers, Value, bounded};
use crate::NetworkFault;

/// The sides of a tensor, from one axis to another.
fn shape(start: usize, end: usize) -> Operator {
    let shape = Operator::new(move |mut inputs| {
        let shape = inputs.value(0)?.shape();
        let sides = shape.get(start..end.min(shape.len())).unwrap_or_default();
        Ok(listed(sides.iter().map(|side| *side as i64).collect()))
    });
    Operator {
        reads_shapes_only: true,
        ..shape
    }
}

fn listed(data: Vec<i64>) -> Integers {
    let shape = vec![data.len()];
    Integers { shape, data }
}

/// One number everywhere; 0 when none is named.
fn constant_of_shape(sides: IntegerSetting, value: Option<TensorData>) -> Operator {
    Operator::new(move |inputs| {
        let sides = sides.values(&inputs)?;
        let shape: Vec<usize> = sides.iter().map(|side| usize::try_from(*side).unwrap_or(0)).collect();
        let count = bounded(shape.iter().copied())?;
        match &value {
            Some(value) if !value.dtype().is_float() => {
                let data = vec![value.iter::<i64>().next().unwrap_or(0); count];
                Ok(Value::Integers(Integers { shape, data }))
            }
            value => {
                let value = value.as_ref().and_then(|v| v.scalar_f32().ok()).unwrap_or(0.0);
                Floats::new(vec![value; count], &shape, inputs.device).map(Value::Floats)
            }
        }
    })
}

/// Whole numbers from start up to limit in steps.
fn range(bounds: [IntegerSetting; 3]) -> Operator {
    Operator::new(move |inputs| {
        let number = |i: usize| {
            let first = bounds[i].values(&inputs)?.first().copied();
            first.ok_or(NetworkFault::Malformed("a bound of it is empty"))
        };
        let (start, limit, step) = (number(0)?, number(1)?, number(2)?);
        if step == 0 {
            return Err("it counts without end".into());
        }
        // In 128 bits, where nothing of 64 overflows.
        let (span, by) = (i128::from(limit) - i128::from(start), i128::from(step));
        let count = usize::try_from(((span + by - by.signum()) / by).max(0)).unwrap_or(usize::MAX);
        let count = bounded([count])?;
        Ok(listed((0..count as i64).map(|i| start + i * step).collect()))
    })
}

pub(super) fn read(node: &Node) -> Option<Operator> {
    Some(match node {
        Node::Shape(n) => shape(n.config.start, n.config.end),
        Node::ConstantOfShape(n) => {
            constant_of_shape(setting!(ConstantOfShapeShape, &n.config.shape), n.config.value.clone())
        }
        Node::Range(n) => {
            let bound = |input: &RangeInput| match input {
                RangeInput::Static(v) => Some(IntegerSetting::Known(vec![*v])),
                RangeInput::Runtime(r) => Some(IntegerSetting::Input(r.input_index)),
                _ => None,
            };
            let config = &n.config;
            range([bound(&config.start)?, bound(&config.limit)?, bound(&config.delta)?])
        }
        _ => return None,
    })
}
