//! Files beside an ONNX file that hold its larger tensors. Source: `onnx.proto3` of ONNX 1.19, "External Data".

use std::collections::BTreeSet;

use super::wire::{Field, Fields};

/// Graphs within graphs beyond which nothing is looked for: loops in loops are a few deep.
const DEEPEST: usize = 32;

/// The kinds of messages that tensors may lie in.
#[derive(Clone, Copy)]
enum Kind {
    Model,
    Graph,
    Node,
    Attribute,
    Sparse,
    Function,
    Tensor,
}

impl Kind {
    fn within(self, field: u64) -> Option<Kind> {
        Some(match (self, field) {
            (Kind::Model, 7) | (Kind::Attribute, 6 | 11) => Kind::Graph,
            (Kind::Model, 25) => Kind::Function,
            (Kind::Graph, 1) | (Kind::Function, 7) => Kind::Node,
            (Kind::Node, 5) => Kind::Attribute,
            (Kind::Graph, 5) | (Kind::Attribute, 5 | 10) | (Kind::Sparse, 1 | 2) => Kind::Tensor,
            (Kind::Graph, 15) | (Kind::Attribute, 22 | 23) => Kind::Sparse,
            _ => return None,
        })
    }
}

/// The files that the tensors of an ONNX file name, as paths from its folder, in alphabetical order.
pub(crate) fn external_files(bytes: &[u8]) -> BTreeSet<&str> {
    let mut found = BTreeSet::new();
    collect(Kind::Model, bytes, DEEPEST, &mut found);
    found
}

fn collect<'a>(kind: Kind, message: &'a [u8], depth: usize, found: &mut BTreeSet<&'a str>) {
    for field in Fields(message) {
        let (number, Field::Bytes(bytes)) = field else { continue };
        match (kind, kind.within(number), number) {
            (Kind::Tensor, _, 13) => found.extend(location(bytes)),
            (_, Some(inner), _) if depth > 0 => {
                let is_graph = matches!(inner, Kind::Graph);
                collect(inner, bytes, depth - usize::from(is_graph), found);
            }
            _ => {}
        }
    }
}

/// The value of an entry with the key `location`.
fn location(entry: &[u8]) -> Option<&str> {
    let text = |number: u64| {
        Fields(entry).find_map(|field| match field {
            (n, Field::Bytes(bytes)) if n == number => std::str::from_utf8(bytes).ok(),
            _ => None,
        })
    };
    text(2).filter(|_| text(1) == Some("location"))
}
