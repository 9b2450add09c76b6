//! A run's comparisons on defended photos, and photos with a defence against themselves without it.

use super::condition::{Condition, Defending};
use super::defences::{DefenceCard, Defences, DefendedRow, UNDEFENDED};
use super::{Again, Held, Seen, per_condition};
use crate::score::compare::{compare_set, decide};
use crate::score::error::ScoreError;
use crate::score::observe::Options;
use crate::score::{ScoredPhoto, ScoredSet, Scores};
use scaleproof_plot::distinct;

/// What photos without a defence are called where that stands for a texture: no texture is called so.
const WITHOUT: &str = "\u{1}";

/// Looks at every photo of a run again, under each of these defences, and compares the variants as [`super::under_corruption`] does. `None` where no photos
/// pair.
pub fn under_defences(
    scores: &Scores,
    defences: &[Defending],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Option<Defences>, ScoreError> {
    let defended = defences.iter().cloned().map(Condition::Defended);
    let Some(again) = Again::of(scores, defended, options, on_photo)? else {
        return Ok(None);
    };
    let names: Vec<String> = std::iter::once(UNDEFENDED.to_owned())
        .chain(defences.iter().map(Defending::name))
        .collect();
    let named = |of_each: Vec<Vec<Held>>| -> Vec<DefendedRow> {
        let of_each = names.iter().zip(of_each);
        let rows = of_each.flat_map(|(name, own)| own.into_iter().map(move |held| (name.clone(), held)));
        rows.map(|(defence, held)| DefendedRow { defence, held }).collect()
    };
    let changed = per_condition(options, again.conditions.len(), |at| changes(scores, &again.photos, at))?;
    let notes = defences.iter().filter_map(|defence| match defence {
        Defending::Program(program) => Some(program.card().notes.clone()),
        Defending::Published(_) => None,
    });
    Ok(Some(Defences {
        defences: defences.iter().map(DefenceCard::of).collect(),
        cautions: again
            .left_out(scores, "defended")
            .into_iter()
            .chain(notes.flatten())
            .collect(),
        rows: named(again.held),
        changes: named(changed),
    }))
}

/// The photos of each variant under a defence against themselves without it; nothing for the first condition, which is without. A photo pairs with itself: both
/// sides have the same photos in the same order.
fn changes(scores: &Scores, photos: &[Seen], at: usize) -> Vec<Held> {
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
        let as_two = own.flat_map(|[without, with]| {
            [(WITHOUT, without), (variant, with)].map(|(name, photo)| ScoredPhoto {
                variant: name.to_owned(),
                ..(*photo).clone()
            })
        });
        let photos: Vec<ScoredPhoto> = as_two.collect();
        let set = ScoredSet {
            photos: &photos,
            ..scores.set()
        };
        let compared = compare_set(set, WITHOUT, &[variant], scores.criteria.ap, None);
        all.extend(compared.into_iter().flat_map(|comparison| comparison.results));
    }
    decide(&mut all.iter_mut().collect::<Vec<_>>());
    all.into_iter()
        .map(|compared| Held::new(UNDEFENDED, compared))
        .collect()
}
