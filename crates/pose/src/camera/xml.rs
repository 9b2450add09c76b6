//! OpenCV's FileStorage as XML.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use super::fields::{Fields, Value};
use super::{Camera, matrix_yaml};
use scaleproof_core::message::{Message, bail, message};

/// FileStorage gives an element one attribute or two. The parser compares all of an element with each other.
const MOST_ATTRIBUTES: usize = 1000;

pub(super) fn read(text: &str) -> Result<Camera, Message> {
    let syntax = |reason: String| message!("not {what}: {reason}", what = "an XML camera file");
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
        bail!(
            "not a camera file: give one of OpenCV, ROS, Kalibr, EuRoC, mrcal, COLMAP (cameras.txt) or a NeRF program (transforms.json)"
        );
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
