//! Writes an ONNX file node by node. Source: `onnx.proto3` of ONNX 1.19.

use super::wire::{bytes, int, single};

/// Element types of `TensorProto`.
const FLOAT: u64 = 1;
const INT64: u64 = 7;

pub(crate) enum Attribute<'a> {
    Int(i64),
    Ints(&'a [i64]),
    Float(f32),
    Text(&'a str),
}

/// A graph with one image as its input and one table as its output.
#[derive(Default)]
pub(crate) struct GraphWriter {
    nodes: Vec<u8>,
    constants: Vec<u8>,
    names: usize,
}

impl GraphWriter {
    fn new_name(&mut self) -> String {
        self.names += 1;
        format!("v{}", self.names)
    }

    pub(crate) fn floats(&mut self, shape: &[usize], values: &[f32]) -> String {
        let raw: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.constant(FLOAT, shape, &raw)
    }

    /// The name of some constant whole numbers.
    pub(crate) fn whole(&mut self, values: &[i64]) -> String {
        let raw: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.constant(INT64, &[values.len()], &raw)
    }

    fn constant(&mut self, element: u64, shape: &[usize], raw: &[u8]) -> String {
        let name = self.new_name();
        let sides: Vec<u8> = shape.iter().flat_map(|side| int(1, *side as u64)).collect();
        let tensor = [sides, int(2, element), bytes(8, name.as_bytes()), bytes(9, raw)].concat();
        self.constants.extend(bytes(5, &tensor));
        name
    }

    /// Adds a node with one output, and answers with that output's name.
    pub(crate) fn node(&mut self, operator: &str, inputs: &[&str], attributes: &[(&str, Attribute)]) -> String {
        let output = self.new_name();
        self.named_node(operator, inputs, attributes, &output);
        output
    }

    fn named_node(&mut self, operator: &str, inputs: &[&str], attributes: &[(&str, Attribute)], output: &str) {
        let mut node: Vec<u8> = inputs.iter().flat_map(|input| bytes(1, input.as_bytes())).collect();
        node.extend(bytes(2, output.as_bytes()));
        node.extend(bytes(4, operator.as_bytes()));
        for (name, value) in attributes {
            // The last number is the attribute's type.
            let value = match value {
                Attribute::Float(v) => [single(2, *v), int(20, 1)].concat(),
                Attribute::Int(v) => [int(3, *v as u64), int(20, 2)].concat(),
                Attribute::Text(v) => [bytes(4, v.as_bytes()), int(20, 3)].concat(),
                Attribute::Ints(v) => {
                    let all: Vec<u8> = v.iter().flat_map(|v| int(8, *v as u64)).collect();
                    [all, int(20, 7)].concat()
                }
            };
            node.extend(bytes(5, &[bytes(1, name.as_bytes()), value].concat()));
        }
        self.nodes.extend(bytes(1, &node));
    }

    /// The file: `output` becomes the table `output`, opset 13. `made_by`: what made it, and what it was made from.
    pub(crate) fn finish(
        mut self,
        made_by: [&str; 2],
        (image, image_shape): (&str, &[usize]),
        (output, shape): (&str, &[usize]),
    ) -> Vec<u8> {
        self.named_node("Identity", &[output], &[], "output");
        let port = |field: u64, name: &str, shape: &[usize]| {
            let sides: Vec<u8> = shape.iter().flat_map(|side| bytes(1, &int(1, *side as u64))).collect();
            let tensor = [int(1, FLOAT), bytes(2, &sides)].concat();
            bytes(
                field,
                &[bytes(1, name.as_bytes()), bytes(2, &bytes(1, &tensor))].concat(),
            )
        };
        let graph = [
            self.nodes,
            bytes(2, made_by[1].as_bytes()),
            self.constants,
            port(11, image, image_shape),
            port(12, "output", shape),
        ];
        let opset = bytes(8, &int(2, 13));
        [
            int(1, 8),
            bytes(2, made_by[0].as_bytes()),
            bytes(7, &graph.concat()),
            opset,
        ]
        .concat()
    }
}
