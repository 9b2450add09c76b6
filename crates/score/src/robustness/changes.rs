//! Comparison of changed photos with the same photos unchanged.

use std::collections::BTreeMap;

use crate::compare::{compare_set, decide_families};
use crate::error::ScoreError;
use crate::figures::{Compared, PairedDifference, ScoredPhoto, ScoredSet, Scores, UNDEFENDED};
use crate::observe::Options;
use crate::robustness::{PhotoUnderConditions, per_condition};
use scaleproof_plot::distinct;

/// Variant of unchanged photos where they stand for a texture: no texture is called so.
const UNCHANGED: &str = "\u{1}";

/// Compares the photos of each variant under each condition with themselves under the first, which has no comparisons itself. The conditions of a
/// detector and variant are tested together.
pub(crate) fn changes(
    scores: &Scores,
    photos: &[PhotoUnderConditions],
    conditions: usize,
    options: &Options,
) -> Result<Vec<Vec<PairedDifference>>, ScoreError> {
    let mut all = per_condition(options, conditions, |at| compared(scores, photos, at))?;
    for own in families(&mut all) {
        // A base that was not seen before may be seen after a defence.
        decide_families(vec![own], 0.0);
    }
    let differences = |own: Vec<Compared>| {
        own.into_iter()
            .map(|compared| PairedDifference::new(UNDEFENDED, compared))
            .collect()
    };
    Ok(all.into_iter().map(differences).collect())
}

/// Groups comparisons that are tested together: the same detector and variant under all conditions.
fn families(all: &mut [Vec<Compared>]) -> impl Iterator<Item = Vec<&mut Compared>> {
    let mut families: BTreeMap<[String; 2], Vec<&mut Compared>> = BTreeMap::new();
    for compared in all.iter_mut().flatten() {
        let key = [&compared.detector, &compared.variant].map(String::clone);
        families.entry(key).or_default().push(compared);
    }
    families.into_values()
}

/// Compares photos under one condition. A photo pairs with itself: both sides have the same photos in the same order.
fn compared(scores: &Scores, photos: &[PhotoUnderConditions], at: usize) -> Vec<Compared> {
    if at == 0 {
        return Vec::new();
    }
    let both = photos
        .iter()
        .filter_map(|seen| Some([seen[0].as_ref().ok()?, seen[at].as_ref().ok()?]));
    let both: Vec<[&ScoredPhoto; 2]> = both.collect();
    let mut all = Vec::new();
    for variant in distinct(both.iter().map(|[photo, _]| photo.variant.as_str())) {
        let own = both.iter().filter(|[photo, _]| photo.variant == variant);
        let as_two = own.flat_map(|[unchanged, changed]| {
            [(UNCHANGED, unchanged), (variant, changed)].map(|(name, photo)| ScoredPhoto {
                variant: name.to_owned(),
                ..(*photo).clone()
            })
        });
        let photos: Vec<ScoredPhoto> = as_two.collect();
        let set = ScoredSet {
            photos: &photos,
            ..scores.set()
        };
        let comparison = compare_set(set, UNCHANGED, &[variant], scores.criteria.ap);
        all.extend(comparison.into_iter().flat_map(|comparison| comparison.results));
    }
    all
}
