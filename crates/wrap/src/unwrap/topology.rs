//! Adjacency of faces, and their outer sides.

use super::surface::{Neighbours, Surface};
use super::visibility::Seen;

/// Returns the face across each edge of each face, and the index of that face's edge; `None` at a border, where more than two faces meet, or where a
/// non-orientable surface, such as a Möbius strip, is cut. Flips faces so that neighbours agree and the more visible side is outside.
pub(super) fn oriented(surface: &mut Surface, seen: &[Seen]) -> Neighbours {
    let beside = surface.neighbours(|_, _| true);
    let is_turned = turned(surface, seen, &beside);
    for (face, _) in surface.faces.iter_mut().zip(is_turned).filter(|(_, is)| *is) {
        face.corners.swap(1, 2);
        face.weights.swap(1, 2);
    }
    surface.neighbours(|[f, i], [g, j]| surface.faces[f].corners[i] != surface.faces[g].corners[j])
}

/// Returns, for each face, true if its winding is opposite to the outside.
fn turned(surface: &Surface, seen: &[Seen], beside: &Neighbours) -> Vec<bool> {
    let mut turned: Vec<Option<bool>> = vec![None; surface.faces.len()];
    for seed in 0..turned.len() {
        if turned[seed].is_some() {
            continue;
        }
        turned[seed] = Some(false);
        let (mut shell, mut next) = (vec![seed], 0);
        while let Some(f) = shell.get(next).copied() {
            next += 1;
            for (i, neighbour) in beside[f].iter().enumerate() {
                let Some((g, j)) = *neighbour else { continue };
                if turned[g].is_none() {
                    let disagree = surface.faces[f].corners[i] == surface.faces[g].corners[j];
                    turned[g] = turned[f].map(|is| is != disagree);
                    shell.push(g);
                }
            }
        }
        let sign = |f: usize| if turned[f] == Some(true) { -1.0 } else { 1.0 };
        let shown: f64 = shell.iter().map(|f| sign(*f) * seen[*f].front_px as f64).sum();
        let wound: f64 = shell.iter().map(|f| sign(*f) * surface.area(*f)).sum();
        if shown < 0.0 || (shown == 0.0 && wound < 0.0) {
            for f in shell {
                turned[f] = turned[f].map(|is| !is);
            }
        }
    }
    turned.into_iter().map(|is| is == Some(true)).collect()
}
