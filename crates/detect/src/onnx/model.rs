//! An ONNX file as nodes and constants. Source: `onnx.proto3` of ONNX 1.19.

use std::collections::{BTreeMap, BTreeSet};

use super::wire::{Field, Fields};
use scaleproof_core::message::Message;

/// The error calls the file "it".
type Result<T> = std::result::Result<T, Message>;

fn fault<T>(sentence: impl Into<Message>) -> Result<T> {
    Err(sentence.into())
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// The version of ONNX's own operators.
    pub opset: i64,
    /// Names of the inputs, without those that are constants.
    pub inputs: Vec<String>,
    pub outputs: Vec<String>,
    /// In the order of the file, without constants.
    pub nodes: Vec<Node>,
    /// By name, those of `Constant` nodes among them.
    pub constants: BTreeMap<String, Tensor>,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Node {
    pub name: String,
    pub operator: String,
    domain: String,
    /// An input that is left out has an empty name.
    pub inputs: Vec<String>,
    pub outputs: Vec<String>,
    pub attributes: BTreeMap<String, Attribute>,
}

/// A single number or text is a list of one.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    Ints(Vec<i64>),
    Floats(Vec<f32>),
    Texts(Vec<String>),
    Tensor(Tensor),
    /// Nodes within a node, which are not read.
    Graphs,
}

/// Row-major; there are as many numbers as the shape says.
#[derive(Debug, Clone, PartialEq)]
pub struct Tensor {
    pub shape: Vec<usize>,
    pub numbers: Numbers,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    Floats(Vec<f32>),
    /// Truth values are 0 and 1.
    Whole(Vec<i64>),
}

impl Model {
    /// Reads a file's bytes. What is read takes a few times the memory of the bytes, whatever sizes they state.
    pub fn read(bytes: &[u8]) -> Result<Model> {
        let (mut opset, mut graph) = (1, None);
        for field in fields(bytes)? {
            match field {
                (7, Field::Bytes(message)) => graph = Some(message),
                (8, Field::Bytes(message)) => opset = own_version(message)?.unwrap_or(opset),
                _ => {}
            }
        }
        match graph {
            Some(graph) => read_graph(graph, opset),
            None => fault("it holds no graph"),
        }
    }
}

impl Node {
    pub fn int(&self, name: &str) -> Option<i64> {
        self.ints(name)?.first().copied()
    }

    pub fn ints(&self, name: &str) -> Option<&[i64]> {
        match self.attributes.get(name)? {
            Attribute::Ints(v) => Some(v),
            _ => None,
        }
    }

    pub fn float(&self, name: &str) -> Option<f32> {
        self.floats(name)?.first().copied()
    }

    pub fn floats(&self, name: &str) -> Option<&[f32]> {
        match self.attributes.get(name)? {
            Attribute::Floats(v) => Some(v),
            _ => None,
        }
    }

    pub fn text(&self, name: &str) -> Option<&str> {
        match self.attributes.get(name)? {
            Attribute::Texts(v) => v.first().map(String::as_str),
            _ => None,
        }
    }

    pub fn tensor(&self, name: &str) -> Option<&Tensor> {
        match self.attributes.get(name)? {
            Attribute::Tensor(v) => Some(v),
            _ => None,
        }
    }

    pub(super) fn read(message: &[u8]) -> Result<Node> {
        let mut node = Node::default();
        for field in fields(message)? {
            let (number, Field::Bytes(bytes)) = field else { continue };
            match number {
                1 => node.inputs.push(text(bytes)?),
                2 => node.outputs.push(text(bytes)?),
                3 => node.name = text(bytes)?,
                4 => node.operator = text(bytes)?,
                5 => node.attributes.extend([read_attribute(bytes)?]),
                7 => node.domain = text(bytes)?,
                _ => {}
            }
        }
        Ok(node)
    }

    /// The operator's name, where it is not ONNX's own or holds graphs.
    fn unknown(&self) -> Option<String> {
        if !is_own(&self.domain) {
            return Some(format!("{}.{}", self.domain, self.operator));
        }
        let holds_graphs = self.attributes.values().any(|value| *value == Attribute::Graphs);
        holds_graphs.then(|| self.operator.clone())
    }

    /// Returns the tensor of a `Constant`: numbers, in the one attribute that it has.
    pub(super) fn constant(&self) -> Option<Tensor> {
        let (name, value) = self.attributes.first_key_value()?;
        let (count, numbers) = match value.clone() {
            Attribute::Tensor(tensor) => return Some(tensor),
            Attribute::Floats(v) => (v.len(), Numbers::Floats(v)),
            Attribute::Ints(v) => (v.len(), Numbers::Whole(v)),
            _ => return None,
        };
        let is_list = name.ends_with('s') || count != 1;
        let shape = if is_list { vec![count] } else { Vec::new() };
        Some(Tensor { shape, numbers })
    }
}

fn whole<T>(read: Option<T>) -> Result<T> {
    read.ok_or(Message::from("it is no whole ONNX file"))
}

/// All fields of a message.
fn fields(message: &[u8]) -> Result<Vec<(u64, Field<'_>)>> {
    whole(Fields(message).all())
}

fn packed(bytes: &[u8]) -> Result<Vec<u64>> {
    whole(Fields(bytes).varints())
}

fn text(bytes: &[u8]) -> Result<String> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(_) => fault("it has a text that is not UTF-8"),
    }
}

/// Numbers of N bytes one after the other.
fn each<const N: usize, T>(bytes: &[u8], number: impl Fn([u8; N]) -> T) -> Result<Vec<T>> {
    match bytes.as_chunks() {
        (chunks, []) => Ok(chunks.iter().map(|chunk| number(*chunk)).collect()),
        _ => fault("a tensor of it ends within a number"),
    }
}

/// The version of an operator set, where that is ONNX's own.
fn own_version(message: &[u8]) -> Result<Option<i64>> {
    let (mut domain, mut version) = (String::new(), None);
    for field in fields(message)? {
        match field {
            (1, Field::Bytes(name)) => domain = text(name)?,
            (2, Field::Int(number)) => version = Some(number as i64),
            _ => {}
        }
    }
    Ok(version.filter(|_| is_own(&domain)))
}

fn is_own(domain: &str) -> bool {
    matches!(domain, "" | "ai.onnx")
}

fn read_graph(message: &[u8], opset: i64) -> Result<Model> {
    let mut model = Model {
        opset,
        ..Model::default()
    };
    let mut unknown = BTreeSet::new();
    for field in fields(message)? {
        match field {
            (1, Field::Bytes(message)) => {
                let mut node = Node::read(message)?;
                unknown.extend(node.unknown());
                if node.operator != "Constant" {
                    model.nodes.push(node);
                } else if let Some(tensor) = node.constant() {
                    model.constants.insert(node.outputs.pop().unwrap_or_default(), tensor);
                } else {
                    return fault("it has a constant that holds no numbers");
                }
            }
            (5, Field::Bytes(message)) => model.constants.extend([read_tensor(message)?]),
            (11, Field::Bytes(message)) => model.inputs.push(port(message)?),
            (12, Field::Bytes(message)) => model.outputs.push(port(message)?),
            (15, _) => return fault("it has sparse tensors"),
            _ => {}
        }
    }
    if !unknown.is_empty() {
        let unknown = Vec::from_iter(unknown).join(", ");
        return fault(format!(
            "it has operators that are not ONNX's own or hold graphs: {}",
            unknown.escape_debug()
        ));
    }
    model.inputs.retain(|name| !model.constants.contains_key(name));
    Ok(model)
}

/// The name of an input or output.
fn port(message: &[u8]) -> Result<String> {
    let mut fields = fields(message)?.into_iter();
    fields
        .find_map(|field| match field {
            (1, Field::Bytes(name)) => Some(text(name)),
            _ => None,
        })
        .unwrap_or_else(|| Ok(String::new()))
}

/// An attribute and its name.
fn read_attribute(message: &[u8]) -> Result<(String, Attribute)> {
    let (mut name, mut kind, mut tensor) = (String::new(), 0, None);
    let (mut floats, mut ints, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    for field in fields(message)? {
        match field {
            (1, Field::Bytes(bytes)) => name = text(bytes)?,
            (2 | 7, Field::Four(number)) => floats.push(f32::from_le_bytes(number)),
            (7, Field::Bytes(bytes)) => floats.extend(each(bytes, f32::from_le_bytes)?),
            (3 | 8, Field::Int(number)) => ints.push(number as i64),
            (8, Field::Bytes(bytes)) => ints.extend(packed(bytes)?.into_iter().map(|v| v as i64)),
            (4 | 9, Field::Bytes(bytes)) => texts.push(text(bytes)?),
            (5, Field::Bytes(bytes)) => tensor = Some(read_tensor(bytes)?.1),
            (20, Field::Int(number)) => kind = number,
            _ => {}
        }
    }
    // A number that is 0 and a text that is empty may be left out.
    match kind {
        1 => floats.resize(1, 0.0),
        2 => ints.resize(1, 0),
        3 => texts.resize(1, String::new()),
        _ => {}
    }
    let attribute = match (kind, tensor) {
        (1 | 6, _) => Attribute::Floats(floats),
        (2 | 7, _) => Attribute::Ints(ints),
        (3 | 8, _) => Attribute::Texts(texts),
        (4, Some(tensor)) => Attribute::Tensor(tensor),
        (5 | 10, _) => Attribute::Graphs,
        _ => return fault(format!("its attribute {name:?} is of an unknown kind")),
    };
    Ok((name, attribute))
}

/// A tensor and its name.
pub(super) fn read_tensor(message: &[u8]) -> Result<(String, Tensor)> {
    let (mut name, mut element, mut sides, mut raw, mut is_outside) = (String::new(), 0, Vec::new(), None, false);
    let (mut floats, mut whole) = (Vec::new(), Vec::new());
    for field in fields(message)? {
        match field {
            (1, Field::Int(side)) => sides.push(side),
            (1, Field::Bytes(bytes)) => sides.extend(packed(bytes)?),
            (2, Field::Int(number)) => element = number,
            (4, Field::Four(number)) => floats.push(f32::from_le_bytes(number)),
            (4, Field::Bytes(bytes)) => floats.extend(each(bytes, f32::from_le_bytes)?),
            (5 | 7 | 11, Field::Int(number)) => whole.push(number),
            (5 | 7 | 11, Field::Bytes(bytes)) => whole.extend(packed(bytes)?),
            (8, Field::Bytes(bytes)) => name = text(bytes)?,
            (9, Field::Bytes(bytes)) => raw = Some(bytes),
            (10, Field::Eight(number)) => floats.push(f64::from_le_bytes(number) as f32),
            (10, Field::Bytes(bytes)) => floats.extend(each(bytes, |v| f64::from_le_bytes(v) as f32)?),
            (13, _) | (14, Field::Int(1)) => is_outside = true,
            _ => {}
        }
    }
    if is_outside {
        return fault(format!("its tensor {name:?} lies in another file"));
    }
    match (element, raw) {
        (1, Some(raw)) => floats = each(raw, f32::from_le_bytes)?,
        (11, Some(raw)) => floats = each(raw, |v| f64::from_le_bytes(v) as f32)?,
        (2 | 9, Some(raw)) => whole = each(raw, |[v]| v.into())?,
        (3, Some(raw)) => whole = each(raw, |v| i8::from_le_bytes(v) as u64)?,
        (4 | 10 | 16, Some(raw)) => whole = each(raw, |v| u16::from_le_bytes(v).into())?,
        (5, Some(raw)) => whole = each(raw, |v| i16::from_le_bytes(v) as u64)?,
        (6, Some(raw)) => whole = each(raw, |v| i32::from_le_bytes(v) as u64)?,
        (12, Some(raw)) => whole = each(raw, |v| u32::from_le_bytes(v).into())?,
        (7 | 13, Some(raw)) => whole = each(raw, u64::from_le_bytes)?,
        _ => {}
    }
    let Some(numbers) = numbers(element, floats, whole) else {
        let kind = other_kind(element);
        return fault(format!("its tensor {name:?} holds {kind}, which are not followed"));
    };
    let shape: Option<Vec<usize>> = sides.into_iter().map(|side| side.try_into().ok()).collect();
    match shape.filter(|shape| count_of(shape) == Some(numbers.count())) {
        Some(shape) => Ok((name, Tensor { shape, numbers })),
        None => fault(format!("its tensor {name:?} has not as many numbers as its shape says")),
    }
}

fn count_of(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1_usize, |count, side| count.checked_mul(*side))
}

impl Numbers {
    fn count(&self) -> usize {
        match self {
            Numbers::Floats(v) => v.len(),
            Numbers::Whole(v) => v.len(),
        }
    }
}

/// The numbers of a tensor of floats or of whole numbers and bits; none for other kinds of elements.
fn numbers(element: u64, floats: Vec<f32>, whole: Vec<u64>) -> Option<Numbers> {
    let whole = whole.into_iter();
    Some(match element {
        1 | 11 => Numbers::Floats(floats),
        2..=7 | 12 => Numbers::Whole(whole.map(|v| v as i64).collect()),
        9 => Numbers::Whole(whole.map(|v| i64::from(v != 0)).collect()),
        10 => Numbers::Floats(whole.map(|bits| half(bits as u16)).collect()),
        // The highest where it is above.
        13 => Numbers::Whole(whole.map(|v| v.try_into().unwrap_or(i64::MAX)).collect()),
        16 => Numbers::Floats(whole.map(|bits| upper_half(bits as u16)).collect()),
        _ => return None,
    })
}

fn other_kind(element: u64) -> String {
    match element {
        8 => "texts".to_owned(),
        14 | 15 => "complex numbers".to_owned(),
        17..=20 | 24 => "floats of 8 bits".to_owned(),
        21 | 22 => "whole numbers of 4 bits".to_owned(),
        23 => "floats of 4 bits".to_owned(),
        other => format!("elements of the unknown type {other}"),
    }
}

/// A float of 16 bits (IEEE 754, binary16).
fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1F), f32::from(bits & 0x3FF));
    sign * match exponent {
        0 => fraction * 2_f32.powi(-24),
        31 if fraction == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + fraction / 1024.0) * 2_f32.powi(exponent - 15),
    }
}

/// A float of which only the upper 16 bits are kept (bfloat16).
fn upper_half(bits: u16) -> f32 {
    f32::from_bits(u32::from(bits) << 16)
}
