//! Operators that treat each number by itself: activations, roots, limits, casts.

use std::sync::Arc;

use burn::tensor::{Tensor, activation};
use onnx_ir::Node;
use onnx_ir::node::clip::ClipInput;

use super::operator::{AnyOperator, Inputs, Operator, Rearranged};
use super::value::{Floats, Integers, RANK, Value};
use crate::whitebox::NetworkFault;

type Function = dyn Fn(Tensor<RANK>) -> Tensor<RANK> + Send + Sync;

/// y = f(x).
struct Each(Box<Function>);

impl Operator for Each {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let Floats { x, rank } = inputs.floats(0)?;
        Ok(vec![Value::Floats(Floats { x: (self.0)(x), rank })])
    }
}

struct Sigmoid;

impl Operator for Sigmoid {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let Floats { x, rank } = inputs.floats(0)?;
        let x = activation::sigmoid(x);
        Ok(vec![Value::Floats(Floats { x, rank })])
    }

    fn is_sigmoid(&self) -> bool {
        true
    }
}

/// Identity, and dropout, which only training does.
pub(super) struct Identity;

impl Operator for Identity {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        Ok(vec![inputs.value(0)?])
    }

    fn rearranged(&self) -> Rearranged {
        Rearranged::First
    }
}

/// To fractions, or to whole numbers (towards zero).
struct Cast {
    to_fractions: bool,
}

impl Operator for Cast {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let value = inputs.value(0)?;
        if value.requires_grad() && !self.to_fractions {
            return Err("it turns what it sees into whole numbers, and no gradient passes there".into());
        }
        Ok(vec![match (value, self.to_fractions) {
            (Value::Floats(v), false) => {
                let data = v.values()?.iter().map(|x| *x as i64).collect();
                Value::Integers(Integers { shape: v.shape(), data })
            }
            (Value::Integers(v), true) => {
                let values = v.data.iter().map(|x| *x as f32).collect();
                Value::Floats(Floats::new(values, &v.shape, inputs.device)?)
            }
            (same, _) => same,
        }])
    }

    fn rearranged(&self) -> Rearranged {
        if self.to_fractions {
            Rearranged::First
        } else {
            Rearranged::Nothing
        }
    }
}

/// Between two limits, each given, computed or absent.
struct Clip {
    low: Option<Limit>,
    high: Option<Limit>,
}

enum Limit {
    Known(f64),
    Input(usize),
}

impl Limit {
    fn new(written: &Option<ClipInput>) -> Option<Limit> {
        Some(match written.as_ref()? {
            ClipInput::Static(v) => Limit::Known(*v),
            ClipInput::Runtime(input) => Limit::Input(input.input_index),
        })
    }

    fn of(&self, inputs: &mut Inputs) -> Result<f64, NetworkFault> {
        match self {
            Limit::Known(v) => Ok(*v),
            Limit::Input(i) => {
                let values = inputs.floats(*i)?.values()?;
                values
                    .first()
                    .map(|v| f64::from(*v))
                    .ok_or(NetworkFault::Malformed("a limit is empty"))
            }
        }
    }
}

impl Operator for Clip {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let Floats { mut x, rank } = inputs.floats(0)?;
        if let Some(low) = &self.low {
            x = x.clamp_min(low.of(&mut inputs)?);
        }
        if let Some(high) = &self.high {
            x = x.clamp_max(high.of(&mut inputs)?);
        }
        Ok(vec![Value::Floats(Floats { x, rank })])
    }
}

/// A derivative per channel for what is below zero.
struct PRelu;

impl Operator for PRelu {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let Floats { x, rank } = inputs.floats(0)?;
        let derivative = inputs.floats(1)?;
        let x = activation::relu(x.clone()) - activation::relu(x.neg()) * derivative.x;
        Ok(vec![Value::Floats(Floats { x, rank })])
    }
}

pub(super) fn read(node: &Node) -> Option<AnyOperator> {
    let each = |f: Box<Function>| -> Option<AnyOperator> { Some(Arc::new(Each(f))) };
    match node {
        Node::Sigmoid(_) => Some(Arc::new(Sigmoid)),
        Node::Identity(_) | Node::Dropout(_) => Some(Arc::new(Identity)),
        Node::Cast(n) => Some(Arc::new(Cast {
            to_fractions: n.config.to.is_float(),
        })),
        Node::Clip(n) => Some(Arc::new(Clip {
            low: Limit::new(&n.config.min),
            high: Limit::new(&n.config.max),
        })),
        Node::PRelu(_) => Some(Arc::new(PRelu)),
        Node::Relu(_) => each(Box::new(activation::relu)),
        Node::LeakyRelu(n) => {
            let derivative = n.config.alpha;
            each(Box::new(move |x| activation::leaky_relu(x, derivative)))
        }
        Node::Elu(n) => {
            let alpha = n.config.alpha;
            each(Box::new(move |x| activation::elu(x, alpha)))
        }
        Node::HardSigmoid(n) => {
            let (alpha, beta) = (n.config.alpha, n.config.beta);
            each(Box::new(move |x| activation::hard_sigmoid(x, alpha, beta)))
        }
        Node::Swish(n) => {
            let alpha = n.config.alpha;
            each(Box::new(move |x| x.clone() * activation::sigmoid(x.mul_scalar(alpha))))
        }
        Node::HardSwish(_) => each(Box::new(|x| x.clone() * activation::hard_sigmoid(x, 1.0 / 6.0, 0.5))),
        Node::Mish(_) => each(Box::new(activation::mish)),
        Node::Softplus(_) => each(Box::new(|x| activation::softplus(x, 1.0))),
        Node::Tanh(_) => each(Box::new(Tensor::tanh)),
        Node::Exp(_) => each(Box::new(Tensor::exp)),
        Node::Log(_) => each(Box::new(Tensor::log)),
        Node::Sqrt(_) => each(Box::new(Tensor::sqrt)),
        Node::Reciprocal(_) => each(Box::new(Tensor::recip)),
        Node::Neg(_) => each(Box::new(Tensor::neg)),
        Node::Abs(_) => each(Box::new(Tensor::abs)),
        Node::Erf(_) => each(Box::new(Tensor::erf)),
        Node::Floor(_) => each(Box::new(Tensor::floor)),
        Node::Ceil(_) => each(Box::new(Tensor::ceil)),
        _ => None,
    }
}
