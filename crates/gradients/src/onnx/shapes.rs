//! Operators that compute shapes.

use super::operator::{Inputs, Operator, one};
use super::term::{Result, Term, bounded};
use crate::layers::Number;
use scaleproof_core::message::Message;
use scaleproof_detect::onnx_model::{Node, Numbers};

/// The sides of a tensor, from one axis to another, which may count from the end.
fn shape<T: Number>(node: &Node, inputs: &Inputs<T>) -> Result<Term<T>> {
    let shape = &inputs.term(0)?.shape;
    let rank = shape.len() as i64;
    let at = |name: &str, usual: i64| {
        let at = node.int(name).unwrap_or(usual);
        let from_start = if at < 0 { at.saturating_add(rank) } else { at };
        from_start.clamp(0, rank) as usize
    };
    let sides = shape.get(at("start", 0)..at("end", rank)).unwrap_or_default();
    Ok(listed(sides.iter().map(|side| *side as i64).collect()))
}

fn listed<T: Number>(numbers: Vec<i64>) -> Term<T> {
    Term::whole(vec![numbers.len()], numbers)
}

/// One number everywhere; 0 when none is named.
fn constant_of_shape<T: Number>(node: &Node, inputs: &Inputs<T>) -> Result<Term<T>> {
    let sides = inputs.known(0)?;
    let shape: Vec<usize> = sides.iter().map(|side| usize::try_from(*side).unwrap_or(0)).collect();
    let count = bounded(shape.iter().copied())?;
    Ok(match node.tensor("value").map(|value| &value.numbers) {
        Some(Numbers::Whole(v)) => Term::whole(shape, vec![v.first().copied().unwrap_or(0); count]),
        Some(Numbers::Floats(v)) => {
            let value = v.first().copied().unwrap_or(0.0);
            Term::floats(shape, vec![T::of(value.into()); count])
        }
        None => Term::floats(shape, vec![T::ZERO; count]),
    })
}

/// Whole numbers from start up to limit in steps.
fn range<T: Number>(inputs: &Inputs<T>) -> Result<Term<T>> {
    let number = |i: usize| {
        let first = inputs.known(i)?.first().copied();
        first.ok_or(Message::from("a bound of it is empty"))
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
}

pub(super) fn read<T: Number>(node: &Node) -> Option<Operator<'_, T>> {
    match node.operator.as_str() {
        "Shape" => one(move |_, inputs| shape(node, inputs)),
        "ConstantOfShape" => one(move |graph, inputs| graph.kept(constant_of_shape(node, inputs)?)),
        "Range" => one(|_, inputs| range(inputs)),
        _ => None,
    }
}
