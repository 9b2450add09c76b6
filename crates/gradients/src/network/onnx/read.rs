//! From an ONNX file to our own graph.

use std::collections::{BTreeMap, BTreeSet};

use burn::tensor::Device;
use onnx_ir::{Argument, Message, ModelProto, Node, OnnxGraph, OnnxGraphBuilder};

use super::graph::{Graph, GraphStep, Slot};
use super::operator::Operator;
use super::value::{Integers, Value};
use super::{arithmetic, choice, combine, convolution, elementwise, rearrange, resize, shapes};
use crate::{NetworkFault, WhiteBoxError};

/// Reads a file's bytes; `file` is only named in errors.
pub(super) fn read(
    bytes: &[u8],
    file: &str,
    photo_size: Option<[u32; 2]>,
    device: &Device,
) -> Result<Graph, WhiteBoxError> {
    let unreadable = |reason: NetworkFault| WhiteBoxError::OnnxNetwork {
        file: file.to_owned(),
        reason,
    };
    let not_parsed = |said: String| unreadable(NetworkFault::Framework(said.replace('\n', " ")));
    let mut model = ModelProto::parse_from_bytes(bytes).map_err(|e| not_parsed(e.to_string()))?;
    let own = model.opset_import.iter().find(|opset| opset.domain.is_empty());
    let opset = own.map_or(1, |opset| opset.version);
    // Simplified, it would have operators of the parser's own.
    let builder = OnnxGraphBuilder::new().simplify(false);
    // Before opset 11 the second input is the scales.
    let parsed = if opset >= 11 && drop_unused_regions(&mut model) {
        let without = model.write_to_bytes().map_err(|e| not_parsed(e.to_string()))?;
        builder.parse_bytes(&without)
    } else {
        builder.parse_bytes(bytes)
    };
    let parsed = parsed.map_err(|e| not_parsed(e.to_string()))?;
    let operators: Vec<Option<Operator>> = parsed.nodes.iter().map(|node| operator(node, opset)).collect();
    let nodes = parsed.nodes.iter().zip(&operators);
    let unknown = nodes.filter(|(node, operator)| operator.is_none() && !matches!(node, Node::Constant(_)));
    let names: BTreeSet<String> = unknown.map(|(node, _)| kind(node)).collect();
    if !names.is_empty() {
        let names: Vec<String> = names.iter().map(|name| name.escape_debug().to_string()).collect();
        let (file, names) = (file.to_owned(), names.join(", "));
        return Err(WhiteBoxError::Operators { file, names });
    }
    let builder = Builder {
        named: BTreeMap::new(),
        graph: Graph {
            device: device.clone(),
            steps: Vec::new(),
            constants: BTreeMap::new(),
            input: 0,
            outputs: Vec::new(),
            slots: 0,
        },
    };
    let mut graph = builder.graph(&parsed, photo_size, operators).map_err(unreadable)?;
    // The parser gives outputs names of its own.
    for ((name, _), written) in graph.outputs.iter_mut().zip(&model.graph.output) {
        name.clone_from(&written.name);
    }
    Ok(graph)
}

/// Takes the region of interest from each `Resize` that does not look at it, as only `tf_crop_and_resize` does (ONNX: Resize, roi): Paddle writes one, and
/// the parser refuses it. True where there was one.
fn drop_unused_regions(model: &mut ModelProto) -> bool {
    let mut has_any = false;
    for node in model.graph.as_mut().into_iter().flat_map(|graph| &mut graph.node) {
        let looks_at_it = node.attribute.iter().any(|a| &a.s[..] == b"tf_crop_and_resize");
        if node.op_type == "Resize"
            && !looks_at_it
            && let Some(region) = node.input.get_mut(1)
        {
            has_any |= !region.is_empty();
            region.clear();
        }
    }
    has_any
}

fn operator(node: &Node, opset: i64) -> Option<Operator> {
    elementwise::read(node)
        .or_else(|| arithmetic::read(node))
        .or_else(|| convolution::read(node))
        .or_else(|| rearrange::read(node))
        .or_else(|| resize::read(node))
        .or_else(|| combine::read(node, opset))
        .or_else(|| choice::read(node))
        .or_else(|| shapes::read(node))
}

/// The operator's name, for people.
fn kind(node: &Node) -> String {
    match node {
        Node::Custom(n) => n.op_type.clone(),
        other => other.node_type().to_string(),
    }
}

/// A graph that is being filled.
struct Builder {
    named: BTreeMap<String, Slot>,
    graph: Graph,
}

impl Builder {
    fn graph(
        mut self,
        parsed: &OnnxGraph,
        photo_size: Option<[u32; 2]>,
        operators: Vec<Option<Operator>>,
    ) -> Result<Graph, NetworkFault> {
        let image = match (&parsed.inputs[..], photo_size) {
            ([image], _) => image,
            ([image, size], Some(photo_size)) => {
                let (shape, data) = (vec![1, 2], photo_size.map(i64::from).to_vec());
                let slot = self.named_slot(&size.name);
                self.graph.constants.insert(slot, Integers { shape, data }.into());
                image
            }
            (more, _) => return Err(NetworkFault::Count("inputs", more.len(), 1)),
        };
        self.graph.input = self.named_slot(&image.name);
        for (node, operator) in parsed.nodes.iter().zip(operators) {
            let Some(operator) = operator else { continue };
            let step = GraphStep {
                name: node.name().to_owned(),
                operator,
                inputs: node.inputs().iter().map(|a| self.slot(a)).collect::<Result<_, _>>()?,
                outputs: node.outputs().iter().map(|a| self.named_slot(&a.name)).collect(),
            };
            self.graph.steps.push(step);
        }
        for output in &parsed.outputs {
            let slot = self.slot(output)?.ok_or("an output has no name")?;
            self.graph.outputs.push((output.name.clone(), slot));
        }
        Ok(self.graph)
    }

    /// Where an argument's value will be; its constant is put there.
    fn slot(&mut self, argument: &Argument) -> Result<Option<Slot>, NetworkFault> {
        if argument.is_optional() {
            return Ok(None);
        }
        let Some(data) = argument.value() else {
            return Ok(Some(self.named_slot(&argument.name)));
        };
        let value = Value::constant(&data, &self.graph.device)?;
        if argument.name.is_empty() {
            self.named.remove(""); // each constant without a name is another
        }
        let slot = self.named_slot(&argument.name);
        self.graph.constants.insert(slot, value);
        Ok(Some(slot))
    }

    fn named_slot(&mut self, name: &str) -> Slot {
        *self
            .named
            .entry(name.to_owned())
            .or_insert_with(|| self.graph.new_slot())
    }
}
