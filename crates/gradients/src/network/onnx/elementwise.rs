//! Operators that treat each number by itself: activations, roots, limits, casts.

use burn::tensor::{Tensor, activation};
use onnx_ir::Node;
use onnx_ir::node::clip::ClipInput;

use super::operator::{Inputs, Operator, Rearranged};
use super::value::{Floats, Integers, RANK, Result, Value, bounded, broadcast};
use crate::NetworkFault;
use crate::layers::Activation;

/// y = f(x).
fn each(f: impl Fn(Tensor<RANK>) -> Tensor<RANK> + Send + Sync + 'static) -> Operator {
    Operator::new(move |mut inputs| Ok(inputs.floats(0)?.map(&f)))
}

/// What a layer does on plain arrays.
fn each_as(activation: Activation, f: impl Fn(Tensor<RANK>) -> Tensor<RANK> + Send + Sync + 'static) -> Operator {
    each(f).with_layer(move |_, _| Some(Box::new(activation)))
}

/// To fractions, or to whole numbers (towards zero).
fn cast(to_fractions: bool) -> Operator {
    let cast = Operator::new(move |mut inputs| {
        let value = inputs.value(0)?;
        if value.requires_grad() && !to_fractions {
            return Err("it turns what it sees into whole numbers, and no gradient passes there".into());
        }
        Ok(match (value, to_fractions) {
            (Value::Floats(v), false) => {
                let data = v.values()?.iter().map(|x| *x as i64).collect();
                Value::Integers(Integers { shape: v.shape(), data })
            }
            (Value::Integers(v), true) => {
                let values = v.data.iter().map(|x| *x as f32).collect();
                Value::Floats(Floats::new(values, &v.shape, inputs.device)?)
            }
            (same, _) => same,
        })
    });
    if to_fractions {
        cast.rearranging(Rearranged::First)
    } else {
        cast
    }
}

/// One of two limits: given, computed or absent.
fn limit(written: &Option<ClipInput>, inputs: &mut Inputs) -> Result<Option<f64>> {
    match written {
        None => Ok(None),
        Some(ClipInput::Static(v)) => Ok(Some(*v)),
        Some(ClipInput::Runtime(input)) => {
            let values = inputs.floats(input.input_index)?.values()?;
            let first = values.first().ok_or(NetworkFault::Malformed("a limit is empty"))?;
            Ok(Some(f64::from(*first)))
        }
    }
}

fn clip(low: Option<ClipInput>, high: Option<ClipInput>) -> Operator {
    Operator::new(move |mut inputs| {
        let mut v = inputs.floats(0)?;
        if let Some(low) = limit(&low, &mut inputs)? {
            v = v.map(|x| x.clamp_min(low));
        }
        if let Some(high) = limit(&high, &mut inputs)? {
            v = v.map(|x| x.clamp_max(high));
        }
        Ok(v)
    })
}

fn prelu(mut inputs: Inputs) -> Result<Floats> {
    let (v, derivative) = (inputs.floats(0)?, inputs.floats(1)?);
    bounded(broadcast(&v.shape(), &derivative.shape())?)?;
    Ok(v.map(|x| activation::relu(x.clone()) - activation::relu(x.neg()) * derivative.x))
}

pub(super) fn read(node: &Node) -> Option<Operator> {
    Some(match node {
        Node::Sigmoid(_) => Operator {
            is_sigmoid: true,
            ..each_as(Activation::Sigmoid, activation::sigmoid)
        },
        // Dropout is what only training does.
        Node::Identity(_) | Node::Dropout(_) => Operator::moving(|mut inputs| inputs.value(0)),
        Node::Cast(n) => cast(n.config.to.is_float()),
        Node::Clip(n) => clip(n.config.min.clone(), n.config.max.clone()),
        Node::PRelu(_) => Operator::new(prelu),
        Node::Relu(_) => each_as(Activation::LeakyRelu(0.0), activation::relu),
        Node::LeakyRelu(n) => {
            let below = n.config.alpha;
            each_as(Activation::LeakyRelu(below as f32), move |x| {
                activation::leaky_relu(x, below)
            })
        }
        Node::Elu(n) => {
            let alpha = n.config.alpha;
            each(move |x| activation::elu(x, alpha))
        }
        Node::HardSigmoid(n) => {
            let (alpha, beta) = (n.config.alpha, n.config.beta);
            each(move |x| activation::hard_sigmoid(x, alpha, beta))
        }
        Node::Swish(n) => {
            let alpha = n.config.alpha;
            each(move |x| x.clone() * activation::sigmoid(x.mul_scalar(alpha)))
        }
        Node::HardSwish(_) => each(|x| x.clone() * activation::hard_sigmoid(x, 1.0 / 6.0, 0.5)),
        Node::Mish(_) => each(activation::mish),
        Node::Softplus(_) => each(|x| activation::softplus(x, 1.0)),
        Node::Tanh(_) => each(Tensor::tanh),
        Node::Exp(_) => each(Tensor::exp),
        Node::Log(_) => each(Tensor::log),
        Node::Sqrt(_) => each(Tensor::sqrt),
        Node::Reciprocal(_) => each(Tensor::recip),
        Node::Neg(_) => each(Tensor::neg),
        Node::Abs(_) => each(Tensor::abs),
        Node::Erf(_) => each(Tensor::erf),
        Node::Floor(_) => each(Tensor::floor),
        Node::Ceil(_) => each(Tensor::ceil),
        _ => return None,
    })
}
