//! Operators that compute shapes.

use std::sync::Arc;

use onnx_ir::constant_of_shape::ConstantOfShapeShape;
use onnx_ir::range::RangeInput;
use onnx_ir::{Node, TensorData, TensorDataExt};

use super::operator::{AnyOperator, Inputs, IntegerSetting, Operator};
use super::value::{Floats, Integers, Value, bounded};
use crate::whitebox::NetworkFault;

/// The sides of a tensor, from one axis to another.
struct Shape {
    start: usize,
    end: usize,
}

impl Operator for Shape {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let shape = inputs.value(0)?.shape();
        let end = self.end.min(shape.len());
        let sides = shape.get(self.start..end).unwrap_or_default();
        Ok(vec![Value::Integers(Integers {
            shape: vec![sides.len()],
            data: sides.iter().map(|side| *side as i64).collect(),
        })])
    }
}

/// One number everywhere; 0 when none is named.
struct ConstantOfShape {
    shape: IntegerSetting,
    value: Option<TensorData>,
}

impl Operator for ConstantOfShape {
    fn run(&self, inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let sides = self.shape.of(&inputs)?;
        let shape: Vec<usize> = sides.iter().map(|side| usize::try_from(*side).unwrap_or(0)).collect();
        let count = bounded(shape.iter().copied())?;
        Ok(vec![match &self.value {
            Some(value) if !value.dtype().is_float() => {
                let value = value.iter::<i64>().next().unwrap_or(0);
                Value::Integers(Integers {
                    shape,
                    data: vec![value; count],
                })
            }
            value => {
                let value = value.as_ref().and_then(|v| v.scalar_f32().ok()).unwrap_or(0.0);
                Value::Floats(Floats::new(vec![value; count], &shape, inputs.device)?)
            }
        }])
    }
}

/// Whole numbers from start up to limit in steps.
struct Range([IntegerSetting; 3]);

impl Operator for Range {
    fn run(&self, inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let number = |i: usize| {
            self.0[i]
                .of(&inputs)?
                .first()
                .copied()
                .ok_or(NetworkFault::Malformed("a bound of it is empty"))
        };
        let (mut at, limit, step) = (number(0)?, number(1)?, number(2)?);
        if step == 0 || (limit - at) / step > 1 << 24 {
            return Err("it counts without end".into());
        }
        let mut data = Vec::new();
        while (step > 0 && at < limit) || (step < 0 && at > limit) {
            data.push(at);
            at += step;
        }
        Ok(vec![Value::Integers(Integers {
            shape: vec![data.len()],
            data,
        })])
    }
}

pub(super) fn read(node: &Node) -> Option<AnyOperator> {
    Some(match node {
        Node::Shape(n) => Arc::new(Shape {
            start: n.config.start,
            end: n.config.end,
        }),
        Node::ConstantOfShape(n) => Arc::new(ConstantOfShape {
            shape: match &n.config.shape {
                ConstantOfShapeShape::Static(v) => IntegerSetting::Known(v.clone()),
                ConstantOfShapeShape::Runtime(r) => IntegerSetting::input(r),
            },
            value: n.config.value.clone(),
        }),
        Node::Range(n) => {
            let bound = |input: &RangeInput| match input {
                RangeInput::Static(v) => Some(IntegerSetting::Known(vec![*v])),
                RangeInput::Runtime(r) => Some(IntegerSetting::input(r)),
                _ => None,
            };
            Arc::new(Range([
                bound(&n.config.start)?,
                bound(&n.config.limit)?,
                bound(&n.config.delta)?,
            ]))
        }
        _ => return None,
    })
}
