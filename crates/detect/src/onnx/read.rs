//! The maker of an ONNX file, and the preparation of the image by its first nodes. Source: `onnx.proto3` of ONNX 1.19.

use std::collections::BTreeMap;

use super::model::{Node, Numbers, Tensor, read_tensor};
use super::wire::{Field, Fields};

#[derive(Debug, Default, PartialEq)]
pub(crate) struct OnnxFile {
    /// The exporter's name and the graph's, in lower case, a space between them.
    pub made_by: String,
    /// The change of each channel by the first nodes of the image before anything looks at it; `None` where they do nothing of that kind.
    pub prepares: Option<Affine>,
    /// True where it looks at places of its features that it computes itself (`GridSample`), as deformable attention does.
    pub samples: bool,
}

/// value · scale + offset; of all channels, in the order of the network's input, the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Affine {
    pub scale: f32,
    pub offset: f32,
}

impl Affine {
    /// Returns the divisor of values from 0 to 255 for it: it brings either these or those from 0 to 1 to the range of the network.
    pub(crate) fn std(self) -> f32 {
        if self.scale.abs() < 0.1 { 1.0 } else { 255.0 }
    }
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap_or_default()
}

impl OnnxFile {
    /// Reads the bytes of a file, of which `image` is the input that photos go into. What is no ONNX file says nothing.
    pub(crate) fn read(bytes: &[u8], image: &str) -> OnnxFile {
        let (mut made_by, mut graph, mut functions) = (String::new(), &[][..], Vec::new());
        for field in Fields(bytes) {
            match field {
                (2, Field::Bytes(name)) => made_by += text(name),
                (7, Field::Bytes(bytes)) => graph = bytes,
                (25, Field::Bytes(function)) => functions.push(function),
                _ => {}
            }
        }
        let (mut nodes, mut constants) = (Vec::new(), BTreeMap::new());
        for field in Fields(graph) {
            match field {
                (1, Field::Bytes(node)) => nodes.extend(Node::read(node)),
                (2, Field::Bytes(name)) => made_by = format!("{made_by} {}", text(name)),
                (5, Field::Bytes(tensor)) => {
                    let tensor = read_tensor(tensor).ok();
                    constants.extend(tensor.and_then(|(name, tensor)| Some((name, first_number(&tensor)?))));
                }
                _ => {}
            }
        }
        let of_functions = functions.iter().flat_map(|function| Fields(function));
        let of_functions: Vec<Node> = of_functions
            .filter_map(|field| match field {
                (7, Field::Bytes(node)) => Node::read(node).ok(),
                _ => None,
            })
            .collect();
        let of_nodes = nodes.iter().filter(|node| node.operator == "Constant");
        constants.extend(
            of_nodes.filter_map(|node| Some((node.outputs.first()?.clone(), first_number(&node.constant()?)?))),
        );
        OnnxFile {
            made_by: made_by.to_lowercase(),
            samples: nodes
                .iter()
                .chain(&of_functions)
                .any(|node| node.operator == "GridSample"),
            prepares: prepares(&nodes, &constants, image),
        }
    }
}

/// The first number of a tensor, where its numbers are floats and for a channel or for all.
fn first_number(tensor: &Tensor) -> Option<f32> {
    match &tensor.numbers {
        Numbers::Floats(v) if matches!(v.len(), 1 | 3) => v.first().copied(),
        _ => None,
    }
}

/// Follows the image through the nodes that change its numbers by constants or only move them.
fn prepares(nodes: &[Node], constants: &BTreeMap<String, f32>, image: &str) -> Option<Affine> {
    let (mut at, mut done) = (
        image,
        Affine {
            scale: 1.0,
            offset: 0.0,
        },
    );
    // A node leads to a later one, so that the way ends.
    for _ in nodes {
        let mut readers = nodes
            .iter()
            .filter(|node| node.inputs.iter().any(|input| input == at) && node.operator != "Shape");
        let (Some(node), None) = (readers.next(), readers.next()) else {
            break;
        };
        let constant = node.inputs.iter().find_map(|name| constants.get(name)).copied();
        let Affine { scale, offset } = done;
        done = match (node.operator.as_str(), constant) {
            ("Mul", Some(by)) => Affine {
                scale: scale * by,
                offset: offset * by,
            },
            ("Div", Some(by)) if node.inputs[0] == at => Affine {
                scale: scale / by,
                offset: offset / by,
            },
            ("Add", Some(by)) => Affine {
                scale,
                offset: offset + by,
            },
            ("Sub", Some(by)) if node.inputs[0] == at => Affine {
                scale,
                offset: offset - by,
            },
            ("Cast" | "Identity" | "Transpose" | "Reshape" | "Squeeze" | "Unsqueeze" | "Resize" | "Pad", _) => done,
            _ => break,
        };
        at = node.outputs.last().map_or("", String::as_str);
    }
    let is_something = done.scale.is_finite() && done.scale != 0.0 && (done.scale, done.offset) != (1.0, 0.0);
    is_something.then_some(done)
}
