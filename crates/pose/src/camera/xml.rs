//! OpenCV's FileStorage as XML.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use super::fields::{Fields, Value};
use super::{Camera, CameraFault, matrix_yaml};

pub(super) fn read(text: &str) -> Result<Camera, CameraFault> {
    let document = Document::parse(text).map_err(|e| CameraFault::Syntax {
        what: "an XML camera file",
        reason: e.to_string(),
    })?;
    let root = document.root_element();
    if !root.has_tag_name("opencv_storage") {
        return Err(CameraFault::UnknownFormat);
    }
    matrix_yaml::read(Fields::new("", children(root)))
}

/// Returns the child elements of a FileStorage element, by name; only matrices have children of their own, one level deep.
fn children(of: Node) -> BTreeMap<String, Value> {
    let value = |node: Node| match inner(node).next() {
        None => leaf(node),
        Some(_) => Value::Map(inner(node).map(|node| named(node, leaf)).collect()),
    };
    inner(of).map(|node| named(node, value)).collect()
}

fn inner<'a, 'input>(of: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    of.children().filter(Node::is_element)
}

fn named(node: Node, value: impl Fn(Node) -> Value) -> (String, Value) {
    (node.tag_name().name().to_owned(), value(node))
}

/// Reads an element's text as one word, or a list of words.
fn leaf(node: Node) -> Value {
    let words = node.text().unwrap_or_default().split_whitespace();
    let mut words: Vec<Value> = words.map(|word| Value::Text(word.to_owned())).collect();
    match words.len() {
        1 => words.remove(0),
        _ => Value::List(words),
    }
}
