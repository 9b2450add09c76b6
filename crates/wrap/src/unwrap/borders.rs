//! Borders between pieces on the surface.

use std::collections::{BTreeMap, BTreeSet};

use super::assembly::{Assembly, Edge};

/// Two pieces in ascending order, or one and itself at a slit.
pub(super) type Pair = (usize, usize);

/// Returns the edges between each two pieces, and at the slits of each; only those of one piece if one is given.
pub(super) fn borders(assembly: &Assembly, of: Option<usize>) -> BTreeMap<Pair, Vec<Edge>> {
    let mut borders: BTreeMap<Pair, Vec<Edge>> = BTreeMap::new();
    let pieces = of.map_or(0..assembly.pieces.len(), |one| one..one + 1);
    let pieces = pieces.filter_map(|p| assembly.pieces[p].as_ref());
    for face in pieces.flat_map(|p| &p.faces) {
        for (side, across) in assembly.across[*face].iter().enumerate() {
            let Some((other, _)) = *across else { continue };
            let (Some(a), Some(b)) = (assembly.piece_of[*face], assembly.piece_of[other]) else {
                continue;
            };
            // For all pieces, an edge is visited from both sides, and at a slit always.
            let is_first = if a == b { *face < other } else { of.is_some() || a < b };
            if is_first && !assembly.glued[*face][side] {
                borders.entry((a.min(b), a.max(b))).or_default().push((*face, side));
            }
        }
    }
    borders
}

fn ends(assembly: &Assembly, (face, side): Edge) -> [usize; 2] {
    let corners = &assembly.surface.faces[face].corners;
    [corners[side], corners[(side + 1) % 3]]
}

/// Groups the edges into runs without common corners.
pub(super) fn runs(assembly: &Assembly, edges: &[Edge]) -> Vec<Vec<Edge>> {
    let mut runs: Vec<(BTreeSet<usize>, Vec<Edge>)> = Vec::new();
    for edge in edges {
        let ends = ends(assembly, *edge);
        let (touching, rest): (Vec<_>, Vec<_>) = runs
            .into_iter()
            .partition(|(corners, _)| ends.iter().any(|end| corners.contains(end)));
        let mut run = (BTreeSet::from(ends), vec![*edge]);
        for (corners, edges) in touching {
            run.0.extend(corners);
            run.1.extend(edges);
        }
        runs = rest;
        runs.push(run);
    }
    runs.into_iter().map(|(_, edges)| edges).collect()
}

/// Splits a chain of edges in the middle of its length; returns nothing if it is closed.
pub(super) fn halves(assembly: &Assembly, run: &[Edge]) -> Vec<Vec<Edge>> {
    let mut at: BTreeMap<usize, Vec<Edge>> = BTreeMap::new();
    for edge in run {
        ends(assembly, *edge)
            .into_iter()
            .for_each(|end| at.entry(end).or_default().push(*edge));
    }
    let Some((start, _)) = at.iter().find(|(_, edges)| edges.len() == 1) else {
        return Vec::new();
    };
    let total: f64 = run.iter().map(|edge| assembly.length(*edge)).sum();
    let (mut place, mut length) = (*start, 0.0);
    let (mut halves, mut is_done) = ([Vec::new(), Vec::new()], BTreeSet::new());
    while let Some(edge) = at
        .get(&place)
        .and_then(|edges| edges.iter().find(|e| !is_done.contains(*e)))
    {
        is_done.insert(*edge);
        let own = assembly.length(*edge);
        halves[usize::from(length + 0.5 * own > 0.5 * total)].push(*edge);
        length += own;
        let [p, q] = ends(assembly, *edge);
        place = if p == place { q } else { p };
    }
    halves
        .into_iter()
        .filter(|half| !half.is_empty() && half.len() < run.len())
        .collect()
}
