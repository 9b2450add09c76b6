//! Operators on two or more tensors, number by number, with broadcasting.

use onnx_ir::Node;

use super::operator::{Argument, Operator};
use super::value::{Floats, Integers, Result, Value, bounded, broadcast, full};
use crate::layers::{Layer, Operation, Pairwise};

#[derive(Debug, Clone, Copy)]
enum Arithmetic {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Max,
    Min,
}

impl Arithmetic {
    fn floats(self, a: Floats, b: Floats) -> Result<Floats> {
        let rank = a.rank.max(b.rank);
        bounded(broadcast(&a.shape(), &b.shape())?)?;
        let (a, b) = (a.x, b.x);
        let x = match self {
            Arithmetic::Add => a + b,
            Arithmetic::Sub => a - b,
            Arithmetic::Mul => a * b,
            Arithmetic::Div => a / b,
            Arithmetic::Max => a.max_pair(b),
            Arithmetic::Min => a.min_pair(b),
            Arithmetic::Pow => match (Floats { x: b, rank }).values()?[..] {
                [exponent] => a.powf_scalar(exponent),
                _ => return Err("only a single number as an exponent is known".into()),
            },
        };
        Ok(Floats { x, rank })
    }

    /// ONNX divides whole numbers as C does, towards zero.
    fn whole(self, a: i64, b: i64) -> Option<i64> {
        match self {
            Arithmetic::Add => a.checked_add(b),
            Arithmetic::Sub => a.checked_sub(b),
            Arithmetic::Mul => a.checked_mul(b),
            Arithmetic::Div => a.checked_div(b),
            Arithmetic::Pow => a.checked_pow(u32::try_from(b).ok()?),
            Arithmetic::Max => Some(a.max(b)),
            Arithmetic::Min => Some(a.min(b)),
        }
    }

    fn values(self, a: Value, b: Value) -> Result<Value> {
        match (a, b) {
            (Value::Floats(a), Value::Floats(b)) => self.floats(a, b).map(Value::Floats),
            (Value::Integers(a), Value::Integers(b)) => pairwise(&a, &b, |a, b| {
                let whole = self.whole(a, b);
                whole.ok_or("a result of it is no whole number of 64 bits".into())
            })
            .map(Value::Integers),
            _ => Err("it mixes fractions with whole numbers".into()),
        }
    }

    /// For two tensors of one shape, or one with a constant that does not make it larger.
    fn layer(self, arguments: &[Argument], shape: &[usize]) -> Option<Box<dyn Layer>> {
        use Argument::{Constant, Image};
        let (operation, sign) = match self {
            Arithmetic::Add => (Operation::Sum, 1.0),
            Arithmetic::Sub => (Operation::Sum, -1.0),
            Arithmetic::Mul => (Operation::Product, 1.0),
            _ => return None,
        };
        let commutes = sign > 0.0;
        let constant = match arguments {
            [Image(a), Image(b)] if commutes && [a, b] == [shape; 2] => None,
            [Image(a), Constant(Value::Floats(c))] if a == shape => Some(c),
            [Constant(Value::Floats(c)), Image(a)] if commutes && a == shape => Some(c),
            _ => return None,
        };
        let everywhere = |c: &Floats| -> Result<Vec<f32>> {
            let x = c.x.clone().expand(full(shape)?).mul_scalar(sign);
            Floats { x, rank: shape.len() }.values()
        };
        let constant = constant.map(everywhere).transpose().ok()?;
        Some(Box::new(Pairwise { operation, constant }))
    }
}

/// Two arrays of whole numbers, broadcast.
fn pairwise(a: &Integers, b: &Integers, f: impl Fn(i64, i64) -> Result<i64>) -> Result<Integers> {
    let shape = broadcast(&a.shape, &b.shape)?;
    let count = bounded(shape.iter().copied())?;
    let at = |v: &Integers, i: usize| {
        let (mut rest, mut index, mut step) = (i, 0, 1);
        for (k, side) in shape.iter().enumerate().rev() {
            let own = (k + v.shape.len()).checked_sub(shape.len()).map_or(1, |k| v.shape[k]);
            index += if own == 1 { 0 } else { (rest % side) * step };
            step *= own;
            rest /= side;
        }
        v.data[index]
    };
    let data = (0..count).map(|i| f(at(a, i), at(b, i))).collect::<Result<_>>()?;
    Ok(Integers { shape, data })
}

pub(super) fn read(node: &Node) -> Option<Operator> {
    let kind = match node {
        Node::Add(_) | Node::Sum(_) => Arithmetic::Add,
        Node::Sub(_) => Arithmetic::Sub,
        Node::Mul(_) => Arithmetic::Mul,
        Node::Div(_) => Arithmetic::Div,
        Node::Pow(_) => Arithmetic::Pow,
        Node::Max(_) => Arithmetic::Max,
        Node::Min(_) => Arithmetic::Min,
        _ => return None,
    };
    // Max, Min and Sum take any number of tensors.
    let operator = Operator::new(move |mut inputs| {
        let first = inputs.value(0)?;
        (1..inputs.values.len()).try_fold(first, |result, i| kind.values(result, inputs.value(i)?))
    });
    Some(Operator {
        is_product: matches!(kind, Arithmetic::Mul),
        ..operator.with_layer(move |arguments, shape| kind.layer(arguments, shape))
    })
}
