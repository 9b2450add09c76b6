//! Inputs and outputs of operators. One file per group of operators makes them.

use super::graph::Graph;
use super::term::{Numbers, Result, Term};
use crate::layers::Number;
use scaleproof_core::message::{Message, message};
use scaleproof_detect::onnx_model::Node;

/// Refusal of an operator whose settings are computed from the image.
const NOT_KNOWN: &str = "what it is to do depends on what is in the image";

pub(super) fn missing(input: usize) -> Message {
    message!("its input {input} is missing")
}

/// Adds an operator's steps to a graph and answers with its outputs, in ONNX's order.
pub(super) type Operator<'a, T> = Box<dyn Fn(&mut Graph<T>, &Inputs<T>) -> Result<Vec<Term<T>>> + 'a>;

/// An operator with several outputs.
pub(super) fn several<'a, T>(
    work: impl Fn(&mut Graph<T>, &Inputs<T>) -> Result<Vec<Term<T>>> + 'a,
) -> Option<Operator<'a, T>> {
    Some(Box::new(work))
}

/// An operator with one output.
pub(super) fn one<'a, T: 'a>(
    work: impl Fn(&mut Graph<T>, &Inputs<T>) -> Result<Term<T>> + 'a,
) -> Option<Operator<'a, T>> {
    several(move |graph, inputs| Ok(vec![work(graph, inputs)?]))
}

/// Those left out are `None`.
pub(super) struct Inputs<T>(pub Vec<Option<Term<T>>>);

impl<T: Number> Inputs<T> {
    /// Counts them without those left out at the end.
    pub(super) fn count(&self) -> usize {
        self.0.iter().rposition(Option::is_some).map_or(0, |last| last + 1)
    }

    pub(super) fn optional(&self, i: usize) -> Option<&Term<T>> {
        self.0.get(i)?.as_ref()
    }

    pub(super) fn term(&self, i: usize) -> Result<&Term<T>> {
        self.optional(i).ok_or_else(|| missing(i))
    }

    pub(super) fn floats(&self, i: usize) -> Result<&Term<T>> {
        self.optional_floats(i)?.ok_or_else(|| missing(i))
    }

    pub(super) fn optional_floats(&self, i: usize) -> Result<Option<&Term<T>>> {
        match self.optional(i) {
            Some(term) if term.is_whole() => Err(message!("its input {i} holds whole numbers where fractions belong")),
            other => Ok(other),
        }
    }

    /// Fractions with four axes.
    pub(super) fn planes(&self, i: usize) -> Result<(&Term<T>, [usize; 4])> {
        let term = self.floats(i)?;
        match term.shape[..] {
            [a, b, c, d] => Ok((term, [a, b, c, d])),
            _ => Err(message!("a tensor {:?} came where rank 4 belongs", term.shape)),
        }
    }

    pub(super) fn whole(&self, i: usize) -> Result<&Term<T>> {
        let term = self.term(i)?;
        if term.is_whole() {
            Ok(term)
        } else {
            Err(message!("its input {i} holds fractions where whole numbers belong"))
        }
    }

    /// Whole numbers that are the same for every image.
    pub(super) fn known(&self, i: usize) -> Result<&[i64]> {
        match self.whole(i)?.constant() {
            Some(Numbers::Whole(v)) => Ok(v),
            _ => Err(NOT_KNOWN.into()),
        }
    }

    /// Fractions that are the same for every image.
    pub(super) fn known_floats(&self, i: usize) -> Result<&[T]> {
        Ok(self.floats(i)?.constant_floats().ok_or(NOT_KNOWN)?)
    }

    /// A setting that older files state and newer ones compute; `None` where it is left out.
    pub(super) fn setting<'s>(&'s self, node: &'s Node, name: &str, i: usize) -> Result<Option<&'s [i64]>> {
        match (node.ints(name), self.optional(i)) {
            (Some(stated), _) => Ok(Some(stated)),
            (None, Some(_)) => self.known(i).map(Some),
            (None, None) => Ok(None),
        }
    }
}
