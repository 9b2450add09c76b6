//! Faces at the same edge.

use std::collections::BTreeMap;

use super::surface::{Surface, edges};

/// For each edge of each face the face at its other side, and which of that face's edges it is.
pub(super) type Neighbours = Vec<[Option<(usize, usize)>; 3]>;

/// Faces at edges that only two have, if the two are allowed to be neighbours.
pub(super) fn neighbours(surface: &Surface, is_allowed: impl Fn([usize; 2], [usize; 2]) -> bool) -> Neighbours {
    let mut at_edge: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
    for (f, face) in surface.faces.iter().enumerate() {
        for (side, edge) in edges(&face.corners).into_iter().enumerate() {
            at_edge.entry(edge).or_default().push([f, side]);
        }
    }
    let mut beside = vec![[None; 3]; surface.faces.len()];
    for sides in at_edge.values() {
        if let [a, b] = sides[..]
            && is_allowed(a, b)
        {
            beside[a[0]][a[1]] = Some(b.into());
            beside[b[0]][b[1]] = Some(a.into());
        }
    }
    beside
}
