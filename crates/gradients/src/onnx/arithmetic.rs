//! Operators on two or more tensors, number by number, with broadcasting.

use super::graph::Graph;
use super::operator::{Inputs, Operator, one};
use super::run::Work;
use super::term::{Result, Term, broadcast};
use crate::layers::{Activation, Number, Operation, Pairwise};
use scaleproof_detect::onnx_model::Node;

/// ONNX divides whole numbers as C does, towards zero; the sign of a remainder is the divisor's.
fn on_whole(operator: &str) -> Option<fn(i64, i64) -> Option<i64>> {
    Some(match operator {
        "Add" | "Sum" => i64::checked_add,
        "Sub" => i64::checked_sub,
        "Mul" => i64::checked_mul,
        "Div" => i64::checked_div,
        "Mod" => |a, b| Some(a.checked_rem(b)?.checked_add(b)?.wrapping_rem(b)),
        "Pow" => |a, b| a.checked_pow(u32::try_from(b).ok()?),
        "Max" => |a, b| Some(a.max(b)),
        "Min" => |a, b| Some(a.min(b)),
        "Less" => |a, b| Some(i64::from(a < b)),
        "Greater" => |a, b| Some(i64::from(a > b)),
        "Equal" => |a, b| Some(i64::from(a == b)),
        _ => return None,
    })
}

fn on_fractions(operator: &str) -> Option<Operation> {
    Some(match operator {
        "Add" | "Sum" => Operation::Sum,
        "Sub" => Operation::Difference,
        "Mul" => Operation::Product,
        "Div" => Operation::Quotient,
        "Pow" => Operation::Power,
        "Max" => Operation::Largest,
        "Min" => Operation::Smallest,
        _ => return None,
    })
}

/// Adds an operation on fractions, in the shape that both broadcast to.
pub(super) fn of_two<T: Number>(
    graph: &mut Graph<T>,
    operation: Operation,
    a: &Term<T>,
    b: &Term<T>,
) -> Result<Term<T>> {
    if operation == Operation::Product
        && let Some(silu) = silu(graph, a, b)
    {
        return silu;
    }
    let shape = broadcast(&a.shape, &b.shape)?;
    let [a, b] = [graph.expanded(a, &shape)?, graph.expanded(b, &shape)?];
    let (constants, inputs) = match (a.constant_floats(), b.constant_floats()) {
        (_, Some(b)) => ([None, Some(b.clone())], vec![&a]),
        (Some(a), None) => ([Some(a.clone()), None], vec![&b]),
        (None, None) => ([None, None], vec![&a, &b]),
    };
    graph.layer(Pairwise { operation, constants }, &inputs, shape)
}

/// x·σ(x), which is one layer.
fn silu<T: Number>(graph: &mut Graph<T>, a: &Term<T>, b: &Term<T>) -> Option<Result<Term<T>>> {
    let is_sigmoid_of = |s: &Term<T>, x: &Term<T>| {
        let made = graph.maker(s).filter(|step| matches!(step.work, Work::Sigmoid));
        s.shape == x.shape && made.is_some_and(|step| Some(step.inputs[0]) == x.slot())
    };
    let x = match (is_sigmoid_of(b, a), is_sigmoid_of(a, b)) {
        (true, _) => a,
        (_, true) => b,
        _ => return None,
    };
    Some(graph.layer(Activation::Silu, &[x], x.shape.clone()))
}

fn of_whole<T: Number>(
    graph: &mut Graph<T>,
    operation: fn(i64, i64) -> Option<i64>,
    a: &Term<T>,
    b: &Term<T>,
) -> Result<Term<T>> {
    let shape = broadcast(&a.shape, &b.shape)?;
    let [a, b] = [graph.expanded(a, &shape)?, graph.expanded(b, &shape)?];
    graph.whole(&[&a, &b], shape, move |inputs| {
        let pairs = inputs[0].whole()?.iter().zip(inputs[1].whole()?);
        let results = pairs.map(|(a, b)| operation(*a, *b));
        let results: Option<Vec<i64>> = results.collect();
        results.ok_or("a result of it is no whole number of 64 bits".into())
    })
}

fn arithmetic<T: Number>(operator: &str, graph: &mut Graph<T>, a: &Term<T>, b: &Term<T>) -> Result<Term<T>> {
    match (a.is_whole(), b.is_whole(), on_fractions(operator), on_whole(operator)) {
        (true, true, _, Some(operation)) => of_whole(graph, operation, a, b),
        (false, false, Some(Operation::Power), _) => power(graph, a, b),
        (false, false, Some(operation), _) => of_two(graph, operation, a, b),
        (false, false, None, _) => Err("it compares or divides fractions, and no gradient passes there".into()),
        _ => Err("it mixes fractions with whole numbers".into()),
    }
}

/// A square is a product.
fn power<T: Number>(graph: &mut Graph<T>, a: &Term<T>, b: &Term<T>) -> Result<Term<T>> {
    match b.constant_floats() {
        None => Err("only a constant exponent is known".into()),
        Some(exponents) if exponents.iter().all(|e| *e == T::of(2.0)) => {
            let shape = broadcast(&a.shape, &b.shape)?;
            let a = graph.expanded(a, &shape)?;
            of_two(graph, Operation::Product, &a, &a)
        }
        Some(_) => of_two(graph, Operation::Power, a, b),
    }
}

pub(super) fn read<T: Number>(node: &Node) -> Option<Operator<'_, T>> {
    let operator = node.operator.as_str();
    if on_whole(operator).is_none() || node.int("fmod") == Some(1) {
        return None;
    }
    // Max, Min and Sum take any number of tensors.
    one(move |graph: &mut Graph<T>, inputs: &Inputs<T>| {
        let first = inputs.term(0)?.clone();
        (1..inputs.count()).try_fold(first, |result, i| arithmetic(operator, graph, &result, inputs.term(i)?))
    })
}
