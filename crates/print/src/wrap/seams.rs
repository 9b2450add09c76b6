//! Seams between panels on the model: the same small letter beside both.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};

use super::panel::{PaintedSurface, Panel, corner_of};
use super::region::Region;
use crate::template::letters;
use scaleproof_core::geometry::{Point2, distance};
use scaleproof_surface::pattern::world_aligned::Side;

/// Minimum length of a lettered seam; shorter ones can be matched without a letter.
const SHORTEST_MM: f64 = 15.0;
/// Distance between a letter's middle and the nearest ink.
pub const CLEAR_MM: f64 = 2.4;
/// Maximum additional distance of a letter from its seam.
const FARTHEST_MM: f64 = 4.0;

#[derive(Debug, Clone, PartialEq)]
pub struct SeamMark {
    pub letter: String,
    /// Point2 of the seam on the panel's border.
    pub seam: Point2,
    /// Centre of the letter.
    pub at: Point2,
}

/// Letters beside each panel, and the length of the seams without room for theirs on both panels.
#[derive(Default)]
pub struct PanelSeams {
    pub marks: BTreeMap<Side, Vec<SeamMark>>,
    pub unlettered_mm: f64,
}

struct Seam {
    sides: [Side; 2],
    edges: Vec<[Point3<f64>; 2]>,
    length_mm: f64,
}

/// Assigns letters to all seams of sufficient length. `grown` are the panels' regions with their bleed.
pub fn seams(paint: &PaintedSurface, panels: &[Panel], grown: &[Region]) -> PanelSeams {
    let mut found = PanelSeams::default();
    let mut all = runs(paint);
    all.retain(|seam| seam.length_mm >= SHORTEST_MM);
    // Longest first, so that they get the room and the first letters.
    all.sort_by(|a, b| b.length_mm.total_cmp(&a.length_mm));
    let mut count = 0;
    for seam in all {
        let places = seam.sides.map(|side| {
            let index = panels.iter().position(|panel| panel.side == side)?;
            let near = found.marks.get(&side).map_or(&[][..], Vec::as_slice);
            place(&seam, side, &panels[index].region, &grown[index], near)
        });
        let [Some(first), Some(second)] = places else {
            found.unlettered_mm += seam.length_mm;
            continue;
        };
        // Lower case, because the capitals are those of the sheets of one panel.
        let letter = letters(count).to_lowercase();
        count += 1;
        for (side, (on_seam, at)) in seam.sides.into_iter().zip([first, second]) {
            found.marks.entry(side).or_default().push(SeamMark {
                letter: letter.clone(),
                seam: on_seam,
                at,
            });
        }
    }
    found
}

/// Returns the connected runs of edges between each two printed panels.
fn runs(paint: &PaintedSurface) -> Vec<Seam> {
    let mut between = BTreeMap::<[Side; 2], BTreeMap<[usize; 2], [Point3<f64>; 2]>>::new();
    for (edge, faces) in paint.edges() {
        let sides: BTreeSet<Side> = faces.iter().map(|i| paint.faces[*i].side).collect();
        let sides: Vec<Side> = sides.into_iter().filter(|side| *side != Side::Bottom).collect();
        if let [a, b] = sides[..] {
            let ends = edge.map(|corner| corner_of(&paint.faces[faces[0]], corner));
            between.entry([a, b]).or_default().insert(edge, ends);
        }
    }
    let mut seams = Vec::new();
    for (sides, edges) in between {
        seams.extend(connected(&edges).into_iter().map(|edges| Seam {
            sides,
            length_mm: edges.iter().map(|[a, b]| (b - a).norm()).sum(),
            edges,
        }));
    }
    seams
}

fn connected(edges: &BTreeMap<[usize; 2], [Point3<f64>; 2]>) -> Vec<Vec<[Point3<f64>; 2]>> {
    let mut at_corner = BTreeMap::<usize, Vec<[usize; 2]>>::new();
    for edge in edges.keys() {
        edge.iter()
            .for_each(|corner| at_corner.entry(*corner).or_default().push(*edge));
    }
    let mut seen = BTreeSet::new();
    let mut all = Vec::new();
    for start in edges.keys() {
        let (mut run, mut waiting) = (Vec::new(), vec![*start]);
        while let Some(edge) = waiting.pop() {
            if seen.insert(edge) {
                run.push(edges[&edge]);
                waiting.extend(edge.iter().flat_map(|corner| &at_corner[corner]));
            }
        }
        if !run.is_empty() {
            all.push(run);
        }
    }
    all
}

/// Returns a point of the seam on the panel's border, and beside it a position for the letter without ink: as near as possible to the middle of the
/// seam.
fn place(seam: &Seam, side: Side, region: &Region, grown: &Region, taken: &[SeamMark]) -> Option<(Point2, Point2)> {
    let sum = seam.edges.iter().fold(Vector3::zeros(), |sum, [a, b]| {
        sum + 0.5 * (a.coords + b.coords) * (b - a).norm()
    });
    let middle = side.project(&Point3::from(sum / seam.length_mm));
    let mut best: Option<(f64, Point2, Point2)> = None;
    for ends in &seam.edges {
        let [a, b] = ends.map(|p| side.project(&p));
        let length = distance(a, b);
        if length < 1e-6 {
            continue;
        }
        let outward = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
        let steps = (length / 3.0).ceil().max(1.0) as usize;
        for step in 0..steps {
            let share = (step as f64 + 0.5) / steps as f64;
            let p = [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]));
            let off_middle = distance(p, middle);
            if best.is_some_and(|(found, ..)| found <= off_middle) || region.distance_mm(p) < -0.1 {
                continue;
            }
            let here = free(p, outward, grown, taken);
            let at = here.or_else(|| free(p, outward.map(|c| -c), grown, taken));
            best = at.map(|at| (off_middle, p, at)).or(best);
        }
    }
    best.map(|(_, p, at)| (p, at))
}

fn free(p: Point2, direction: Point2, grown: &Region, taken: &[SeamMark]) -> Option<Point2> {
    let outwards = (0..=12).map(|step| f64::from(step) / 12.0 * (CLEAR_MM + FARTHEST_MM));
    let mut places = outwards.map(|mm| [p[0] + mm * direction[0], p[1] + mm * direction[1]]);
    places.find(|at| {
        let alone = taken.iter().all(|mark| distance(mark.at, *at) > 2.0 * CLEAR_MM);
        alone && grown.distance_mm(*at) >= CLEAR_MM
    })
}
