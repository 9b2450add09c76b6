//! Operators that treat each number by itself: activations, roots, limits, casts.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_SQRT_PI};

use super::arithmetic;
use super::graph::Graph;
use super::operator::{Inputs, Operator, one};
use super::run::Work;
use super::term::{Kind, Numbers, Result, Term};
use crate::layers::{Activation, Each, Layer, Number, Operation, sigmoid};
use scaleproof_detect::onnx_model::Node;

/// Creates the operator of a function that returns its value and its slope, in the numbers of the layer.
fn each<'a, T: Number>(f: impl Fn(T) -> (T, T) + Clone + Send + Sync + 'static) -> Option<Operator<'a, T>> {
    of_layer(move || Each(f.clone()))
}

/// Creates the operator of a function that returns its value and its slope, in 64 bits.
fn wide<'a, T: Number>(f: impl Fn(f64) -> (f64, f64) + Clone + Send + Sync + 'static) -> Option<Operator<'a, T>> {
    each(move |x: T| {
        let (y, slope) = f(x.wide());
        (T::of(y), T::of(slope))
    })
}

fn of_layer<'a, T: Number, L: Layer<T> + 'static>(layer: impl Fn() -> L + 'a) -> Option<Operator<'a, T>> {
    one(move |graph, inputs| {
        let x = inputs.floats(0)?;
        graph.layer(layer(), &[x], x.shape.clone())
    })
}

fn sigmoid_of<T: Number>(graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let x = inputs.floats(0)?;
    graph.work(Work::Sigmoid, &[x], x.shape.clone())
}

/// To fractions, to whole numbers (towards zero), or to truth values.
fn cast<T: Number>(graph: &mut Graph<T>, x: &Term<T>, to: i64) -> Result<Term<T>> {
    let to_fractions = matches!(to, 1 | 10 | 11 | 16);
    if to_fractions && x.is_whole() {
        return graph.work(Work::Fractions, &[x], x.shape.clone());
    }
    if to_fractions || (x.is_whole() && to != 9) {
        return Ok(x.clone());
    }
    if x.kind() == Kind::Followed {
        return Err("it turns what it sees into whole numbers, and no gradient passes there".into());
    }
    graph.whole(&[x], x.shape.clone(), move |inputs| {
        let truth = |is_true: bool| i64::from(is_true);
        Ok(match &inputs[0] {
            Numbers::Floats(v) if to == 9 => v.iter().map(|v| truth(*v != T::ZERO)).collect(),
            Numbers::Floats(v) => v.iter().map(|v| v.wide() as i64).collect(),
            Numbers::Whole(v) => v.iter().map(|v| truth(*v != 0)).collect(),
        })
    })
}

/// Limits that are stated, computed or absent.
fn clip<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let limit = |name: &str, i: usize| -> Result<Option<T>> {
        match (node.float(name), inputs.optional(i)) {
            (Some(stated), _) => Ok(Some(T::of(stated.into()))),
            (None, Some(_)) => Ok(Some(*inputs.known_floats(i)?.first().ok_or("a limit is empty")?)),
            (None, None) => Ok(None),
        }
    };
    let (low, high) = (
        limit("min", 1)?.unwrap_or(T::LEAST),
        limit("max", 2)?.unwrap_or(-T::LEAST),
    );
    let x = inputs.floats(0)?;
    let clipped = Each(move |x: T| limited(x, [low, high]));
    graph.layer(clipped, &[x], x.shape.clone())
}

/// max(x, 0) + slope · min(x, 0)
fn prelu<T: Number>(graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, slope) = (inputs.floats(0)?, inputs.floats(1)?);
    let half = |is_upper: bool| {
        Each(move |x: T| {
            let is_kept = (x > T::ZERO) == is_upper;
            if is_kept { (x, T::ONE) } else { (T::ZERO, T::ZERO) }
        })
    };
    let upper = graph.layer(half(true), &[x], x.shape.clone())?;
    let lower = graph.layer(half(false), &[x], x.shape.clone())?;
    let lower = arithmetic::of_two(graph, Operation::Product, &lower, slope)?;
    arithmetic::of_two(graph, Operation::Sum, &upper, &lower)
}

/// A number between two limits, and the slope. What is not a number stays none.
#[inline(always)]
fn limited<T: Number>(x: T, [low, high]: [T; 2]) -> (T, T) {
    let raised = if x < low { low } else { x };
    let is_outside = x < low || x > high;
    (
        if raised > high { high } else { raised },
        if is_outside { T::ZERO } else { T::ONE },
    )
}

/// α·x + β between 0 and 1, and the slope.
#[inline(always)]
fn hard_sigmoid<T: Number>(x: T, [alpha, beta]: [T; 2]) -> (T, T) {
    let (y, slope) = limited(alpha * x + beta, [T::ZERO, T::ONE]);
    (y, alpha * slope)
}

fn softplus(x: f64) -> f64 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

/// (2/√π)·∫₀ˣ e^−t² dt: the series of Abramowitz & Stegun 7.1.6 near 0, the continued fraction of 7.1.14 further out.
fn erf(x: f64) -> f64 {
    let (a, square) = (x.abs(), x * x);
    if a > 6.0 {
        return x.signum();
    }
    if a > 2.5 {
        let fraction = (1..=60).rev().fold(a, |below, k| a + f64::from(k) / 2.0 / below);
        return x.signum() * (1.0 - (-square).exp() / fraction * (FRAC_2_SQRT_PI / 2.0));
    }
    let (mut term, mut sum) = (x, x);
    for n in 1..60 {
        term *= 2.0 * square / f64::from(2 * n + 1);
        sum += term;
    }
    FRAC_2_SQRT_PI * (-square).exp() * sum
}

/// x·Φ(x), exact or with the hyperbolic tangent (ONNX: Gelu, approximate).
fn gelu(x: f64, is_approximate: bool) -> (f64, f64) {
    let (below, density) = if is_approximate {
        let scale = FRAC_2_SQRT_PI * FRAC_1_SQRT_2;
        let t = (scale * (x + 0.044_715 * x.powi(3))).tanh();
        (
            0.5 * (1.0 + t),
            0.5 * (1.0 - t * t) * scale * (1.0 + 3.0 * 0.044_715 * x * x),
        )
    } else {
        let density = FRAC_2_SQRT_PI * FRAC_1_SQRT_2 / 2.0 * (-x * x / 2.0).exp();
        (0.5 * (1.0 + erf(x * FRAC_1_SQRT_2)), density)
    };
    (x * below, below + x * density)
}

pub(super) fn read<T: Number>(node: &Node) -> Option<Operator<'_, T>> {
    let number = |name: &str, usual: f64| node.float(name).map_or(usual, f64::from);
    let (alpha, beta) = (|usual: f64| number("alpha", usual), number("beta", 0.5));
    match node.operator.as_str() {
        "Sigmoid" => one(sigmoid_of),
        // Dropout is what only training does.
        "Identity" | "Dropout" => one(|_, inputs| inputs.term(0).cloned()),
        "Cast" => {
            let to = node.int("to")?;
            one(move |graph, inputs| cast(graph, inputs.term(0)?, to))
        }
        "Clip" => one(move |graph, inputs| clip(node, graph, inputs)),
        "PRelu" => one(prelu),
        "Relu" => of_layer(|| Activation::LeakyRelu(0.0)),
        "LeakyRelu" => {
            let below = alpha(0.01);
            of_layer(move || Activation::LeakyRelu(below))
        }
        "Elu" => {
            let alpha = alpha(1.0);
            wide(move |x| {
                if x > 0.0 {
                    (x, 1.0)
                } else {
                    (alpha * x.exp_m1(), alpha * x.exp())
                }
            })
        }
        "HardSigmoid" => {
            let line = [alpha(0.2), beta].map(T::of);
            each(move |x| hard_sigmoid(x, line))
        }
        "HardSwish" => {
            let line = [1.0 / 6.0, 0.5].map(T::of);
            each(move |x| {
                let (y, slope) = hard_sigmoid(x, line);
                (x * y, y + x * slope)
            })
        }
        "Swish" => {
            let alpha = T::of(alpha(1.0));
            each(move |x| {
                let s = sigmoid(alpha * x);
                (x * s, s * (T::ONE + alpha * x * (T::ONE - s)))
            })
        }
        "Mish" => wide(|x| {
            let (t, s) = (softplus(x).tanh(), sigmoid(x));
            (x * t, t + x * (1.0 - t * t) * s)
        }),
        "Gelu" => {
            let is_approximate = node.text("approximate") == Some("tanh");
            wide(move |x| gelu(x, is_approximate))
        }
        "Softplus" => wide(|x| (softplus(x), sigmoid(x))),
        "Tanh" => wide(|x| (x.tanh(), 1.0 - x.tanh().powi(2))),
        "Exp" => wide(|x| (x.exp(), x.exp())),
        "Log" => wide(|x| (x.ln(), 1.0 / x)),
        "Sqrt" => wide(|x| (x.sqrt(), 0.5 / x.sqrt())),
        "Reciprocal" => wide(|x| (1.0 / x, -1.0 / (x * x))),
        "Neg" => each(|x: T| (-x, -T::ONE)),
        "Abs" => each(|x: T| if x < T::ZERO { (-x, -T::ONE) } else { (x, T::ONE) }),
        "Erf" => wide(|x| (erf(x), FRAC_2_SQRT_PI * (-x * x).exp())),
        "Floor" => wide(|x| (x.floor(), 0.0)),
        "Ceil" => wide(|x| (x.ceil(), 0.0)),
        _ => None,
    }
}
