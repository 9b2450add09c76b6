//! Table of the labels that each detector gave the model.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::figures::{ScoredPhoto, Scores};
use crate::report::table::{Cell, Column, Table};
use crate::report::words::{counted, other_label};

/// Name for no label at all.
const NOTHING: &str = "nothing";

/// Counts photos by the label of the most confident detection on the model, for a hit of the matching one: labels that count as the model first, then
/// the others by how often they occur, nothing last.
pub(crate) fn taken(scores: &Scores) -> Table {
    let mut counts: BTreeMap<(usize, &str), BTreeMap<String, usize>> = BTreeMap::new();
    for p in &scores.photos {
        for index in 0..scores.detectors.len() {
            let own = counts.entry((index, p.variant.as_str())).or_default();
            *own.entry(label(scores, index, p)).or_default() += 1;
        }
    }
    let labels = ordered(scores, counts.values());
    let names = [Column::words("detector"), Column::words("texture")];
    let columns = names
        .into_iter()
        .chain(labels.iter().map(|label| Column::numbers(label)));
    let mut table = Table::new("As what the model was taken", columns.collect());
    for (index, detector) in scores.detectors.iter().enumerate() {
        let row = |variant: &str| {
            let own = counts.get(&(index, variant))?;
            let count = |label: &String| {
                own.get(label)
                    .map_or_else(|| Cell::text("·"), |count| Cell::count(*count))
            };
            let names = [Cell::text(&detector.manifest.title), Cell::text(variant)];
            Some(names.into_iter().chain(labels.iter().map(count)).collect::<Vec<_>>())
        };
        table.add_block(scores.variants().into_iter().filter_map(row));
    }
    let note = "Photos by the label on the model at hit confidence: of a hit the one that counts, else the most confident other";
    table.notes.push(note.to_owned());
    table
}

fn label(scores: &Scores, index: usize, p: &ScoredPhoto) -> String {
    let (detector, outcome) = (&scores.detectors[index], &p.outcomes[index]);
    let own = p.detections[index].iter().find(|d| {
        detector.counts(d)
            && d.score >= scores.criteria.hit_confidence
            && d.box_px.iou(&p.truth) >= scores.criteria.match_iou()
    });
    let hit = own
        .filter(|_| outcome.is_hit())
        .and_then(|d| detector.labels().name(d.label));
    let other = || other_label(p, index, detector).map(|(label, _)| label);
    hit.or_else(other).unwrap_or(NOTHING).to_owned()
}

fn ordered<'a>(scores: &Scores, counts: impl Iterator<Item = &'a BTreeMap<String, usize>>) -> Vec<String> {
    let mut all: BTreeMap<&String, usize> = BTreeMap::new();
    counts
        .flatten()
        .for_each(|(label, count)| *all.entry(label).or_default() += count);
    let counted = counted::classes(scores).labels();
    let mut labels: Vec<(&String, usize)> = all.into_iter().collect();
    labels.sort_by_key(|(label, count)| (*label == NOTHING, !counted.contains(label), Reverse(*count), *label));
    labels.into_iter().map(|(label, _)| label.clone()).collect()
}
