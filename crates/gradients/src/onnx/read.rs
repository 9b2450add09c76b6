//! Nodes of an ONNX file as steps.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::Graph;
use super::operator::{Inputs, Operator};
use super::term::{IMAGE, Kind, NEVER_COMPUTED, Result, Term, Value};
use super::{arithmetic, choice, combine, convolution, elementwise, rearrange, resize, shapes};
use crate::layers::Number;
use scaleproof_core::message::message;
use scaleproof_detect::onnx_model::{Model, Node};

/// The operators of a file in its order; `file` is only named in errors.
pub(super) fn operators<'a, T: Number>(model: &'a Model, file: &str) -> Result<Vec<Operator<'a, T>>> {
    let (mut operators, mut unknown) = (Vec::new(), BTreeSet::new());
    for node in &model.nodes {
        match operator(node, model.opset) {
            Some(operator) => operators.push(operator),
            None => _ = unknown.insert(node.operator.escape_debug().to_string()),
        }
    }
    if unknown.is_empty() {
        return Ok(operators);
    }
    let names = Vec::from_iter(unknown).join(", ");
    Err(message!(
        "{file} has operators that cannot be differentiated here: {names}; attack another detector"
    ))
}

fn operator<T: Number>(node: &Node, opset: i64) -> Option<Operator<'_, T>> {
    elementwise::read(node)
        .or_else(|| arithmetic::read(node))
        .or_else(|| convolution::read(node))
        .or_else(|| rearrange::read(node))
        .or_else(|| resize::read(node, opset))
        .or_else(|| combine::read(node, opset))
        .or_else(|| choice::read(node))
        .or_else(|| shapes::read(node))
}

/// A file's network for images of some shape, and its outputs. `photo_size` is what a second input holds.
pub(super) fn graph<T: Number>(
    model: &Model,
    operators: &[Operator<T>],
    shape: &[usize],
    photo_size: Option<[u32; 2]>,
) -> Result<(Graph<T>, Vec<Term<T>>)> {
    let (shape, value) = (shape.to_vec(), Value::Image(IMAGE, Kind::Followed));
    let mut graph = Graph::new(shape.iter().product());
    let mut terms: BTreeMap<&str, Term<T>> = BTreeMap::new();
    for (name, tensor) in &model.constants {
        terms.insert(name, graph.kept(Term::of_file(tensor))?);
    }
    match (&model.inputs[..], photo_size) {
        ([image], _) => _ = terms.insert(image, Term { shape, value }),
        ([image, size], Some(photo_size)) => {
            terms.insert(image, Term { shape, value });
            terms.insert(size, Term::whole(vec![1, 2], photo_size.map(i64::from).to_vec()));
        }
        (more, _) => return Err(message!("it takes {} inputs and gets 1", more.len())),
    }
    for (node, operator) in model.nodes.iter().zip(operators) {
        graph.node = node.name.as_str().into();
        let inputs = node
            .inputs
            .iter()
            .map(|name| match (name.as_str(), terms.get(name.as_str())) {
                ("", _) => Ok(None),
                (_, Some(term)) => Ok(Some(term.clone())),
                (_, None) => Err(NEVER_COMPUTED.into()),
            });
        let outputs = inputs
            .collect::<Result<_>>()
            .and_then(|inputs| operator(&mut graph, &Inputs(inputs)));
        let outputs = outputs.map_err(|fault| message!("at {}: {fault}", node.name))?;
        terms.extend(node.outputs.iter().map(String::as_str).zip(outputs));
    }
    let outputs = model
        .outputs
        .iter()
        .map(|name| terms.get(name.as_str()).cloned().ok_or(NEVER_COMPUTED.into()));
    let outputs = outputs.collect::<Result<_>>()?;
    Ok((graph, outputs))
}
