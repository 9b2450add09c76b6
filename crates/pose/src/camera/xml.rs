//! OpenCV's FileStorage as XML.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use super::fields::{Fields, Value};
use super::{Camera, CameraFault, matrix_yaml};

/// FileStorage gives an element one attribute or two. The parser compares all of an element with each other.
const MOST_ATTRIBUTES: usize = 1000;

pub(super) fn read(text: &str) -> Result<Camera, CameraFault> {
    let syntax = |reason: String| CameraFault::Syntax {
        what: "an XML camera file",
        reason,
    };
    // Within an element's tag there is no other `<`.
    let attributes = text
        .split('<')
        .map(|tag| tag.bytes().filter(|byte| *byte == b'=').count());
    if attributes.max() > Some(MOST_ATTRIBUTES) {
        return Err(syntax(format!("an element has more than {MOST_ATTRIBUTES} attributes")));
    }
    // FileStorage has none, and the parser compares those of an element with those of all around it.
    if text.contains("xmlns") {
        return Err(syntax("it has namespaces".to_owned()));
    }
    let document = Document::parse(text).map_err(|e| syntax(e.to_string()))?;
    let root = document.root_element();
    if !root.has_tag_name("opencv_storage") {
        return Err(CameraFault::UnknownFormat);
    }
    matrix_yaml::read(Fields::new("", children(root)))
}

/// The elements of an element of FileStorage, by name; matrices have elements of their own, and nothing that is read lies deeper.
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

/// One word, or a list of them.
fn leaf(node: Node) -> Value {
    let words = node.text().unwrap_or_default().split_whitespace();
    let mut words: Vec<Value> = words.map(|word| Value::Text(word.to_owned())).collect();
    match words.len() {
        1 => words.remove(0),
        _ => Value::List(words),
    }
}
