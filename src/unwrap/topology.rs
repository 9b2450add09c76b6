//! Which faces lie beside each other.

use std::collections::BTreeMap;

use super::surface::{Surface, edges};

#[derive(Debug)]
pub(super) struct Topology {
    /// The face across each edge of each face. `None` at a border and where more than two meet or one of two is turned over.
    pub across: Vec<[Option<usize>; 3]>,
}

impl Topology {
    pub(super) fn of(surface: &Surface) -> Self {
        let mut at_edge: BTreeMap<[usize; 2], Vec<(usize, usize)>> = BTreeMap::new();
        for (f, face) in surface.faces.iter().enumerate() {
            for (side, edge) in edges(&face.corners).into_iter().enumerate() {
                at_edge.entry(edge).or_default().push((f, side));
            }
        }
        let mut across = vec![[None; 3]; surface.faces.len()];
        for sides in at_edge.values() {
            if let [(f, i), (g, j)] = sides[..]
                && surface.faces[f].corners[i] != surface.faces[g].corners[j]
            {
                across[f][i] = Some(g);
                across[g][j] = Some(f);
            }
        }
        Self { across }
    }
}
