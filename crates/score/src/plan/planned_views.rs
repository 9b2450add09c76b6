//! Deviations of the photos from those that were planned.

use std::collections::{BTreeMap, BTreeSet};

use crate::figures::{Comparison, Course, Scores, identical_photos};
use crate::plan::{Endpoint, SealedPlan};
use scaleproof_core::spelling::count;
use scaleproof_plot::distinct;
use scaleproof_pose::scene::Bin;

/// Largest number of views that are named in one deviation.
const MOST_NAMED: usize = 4;

/// Number of photos of each texture at each place and planned bin.
type Photos<'a> = BTreeMap<(&'a str, &'a str, Bin), usize>;

/// Returns deviations: places and views that are missing or repeated, and photos that a plan does not have.
pub(crate) fn deviations(plan: &SealedPlan, scores: &Scores, comparison: &Comparison) -> Vec<String> {
    let planned: Vec<Bin> = plan.views.iter().map(|view| bin(*view)).collect();
    let mut photos = Photos::new();
    let mut elsewhere = 0;
    for photo in &scores.photos {
        let place = photo.place.as_deref().unwrap_or_default();
        match photo.bin.filter(|bin| planned.contains(bin)) {
            Some(bin) => *photos.entry((&photo.variant, place, bin)).or_default() += 1,
            None => elsewhere += 1,
        }
    }
    let mut all = Vec::new();
    all.extend(of_places(plan, scores, comparison));
    for texture in plan.textures.keys() {
        all.extend(missing(texture, plan, &planned, &photos, scores, comparison));
    }
    let repeated = photos.values().filter(|photos| **photos > 1).count();
    let left_out = scores.not_scored.iter();
    let (near, left_out): (Vec<_>, Vec<_>) = left_out.partition(|photo| photo.near_copy_of.is_some());
    let copies = identical_photos(&scores.photos).count() + near.len();
    let given = scores.photos.iter().filter(|photo| photo.truth_given).count();
    let counted = [
        (repeated, "view", "with more photos than the one that was planned"),
        (elsewhere, "photo", "of views that are not in the plan"),
        (copies, "photo", "with the same content as another, or nearly"),
        (given, "photo", "with a truth box that the session gives, not the pose"),
        (left_out.len(), "photo", "left out, with reasons"),
    ];
    let counted = counted.into_iter().filter(|(number, ..)| *number > 0);
    all.extend(counted.map(|(number, what, why)| format!("{} {why}", count(number, what))));
    all
}

/// Returns a deviation for another number of places; fewer where it was decided earlier are as planned.
fn of_places(plan: &SealedPlan, scores: &Scores, comparison: &Comparison) -> Option<String> {
    let (planned, here) = (usize::from(plan.places), places(scores).len());
    let is_ended = plan
        .textures
        .keys()
        .any(|texture| ends_decided(plan, comparison, texture));
    (here > planned || here < planned && !is_ended).then(|| {
        let [planned, here] = [planned, here].map(|n| count(n, "place"));
        format!("{planned} in the plan, {here} here")
    })
}

/// Returns the planned views without a photo of a texture; those of the last place may be missing where it was decided there.
fn missing(
    texture: &str,
    plan: &SealedPlan,
    planned: &[Bin],
    photos: &Photos,
    scores: &Scores,
    comparison: &Comparison,
) -> Option<String> {
    let begun = places_in_order(scores, texture);
    let is_excused = ends_decided(plan, comparison, texture);
    let may_be_missing = |place: &str| is_excused && (begun.last() == Some(&place) || !begun.contains(&place));
    let missing: Vec<String> = places(scores)
        .into_iter()
        .flat_map(|place| planned.iter().map(move |bin| (place, *bin)))
        .filter(|(place, bin)| !photos.contains_key(&(texture, *place, *bin)) && !may_be_missing(place))
        .map(|(place, bin)| named(place, bin))
        .collect();
    (!missing.is_empty()).then(|| {
        let some = missing.iter().take(MOST_NAMED).cloned().collect::<Vec<_>>().join("; ");
        let more = if missing.len() > MOST_NAMED { "; …" } else { "" };
        format!(
            "{} of the plan without a photo of {texture}: {some}{more}",
            count(missing.len(), "view")
        )
    })
}

fn places(scores: &Scores) -> BTreeSet<&str> {
    let photos = scores.photos.iter();
    photos.map(|photo| photo.place.as_deref().unwrap_or_default()).collect()
}

/// Returns true if the photos of a texture end with the pair that decided: then views of the last place may be missing.
fn ends_decided(plan: &SealedPlan, comparison: &Comparison, texture: &str) -> bool {
    let Some(sequential) = &comparison.sequential else {
        return false;
    };
    let own = sequential.results.iter().filter(|course| course.variant == texture);
    let own: Vec<&Course> = own.collect();
    let decision = |course: &&Course| match plan.endpoint() {
        Endpoint::MeanConfidence => course.mean_confidence.decided_after,
        Endpoint::HitRate => course.hit_rate.decided_after,
    };
    let decided = own.iter().map(decision);
    let last = decided.collect::<Option<Vec<_>>>();
    last.is_some_and(|last| last.into_iter().max() == own.first().map(|course| course.looks))
}

/// Returns the places of the photos of a texture, in the order of their list.
fn places_in_order<'a>(scores: &'a Scores, texture: &str) -> Vec<&'a str> {
    let own = scores.photos.iter().filter(|photo| photo.variant == texture);
    distinct(own.map(|photo| photo.place.as_deref().unwrap_or_default()))
}

fn bin([azimuth_deg, pitch_deg, distance_mm]: [f64; 3]) -> Bin {
    Bin {
        azimuth_deg,
        pitch_deg,
        distance_mm,
    }
}

fn named(place: &str, bin: Bin) -> String {
    let at = if place.is_empty() {
        String::new()
    } else {
        format!(" at {place}")
    };
    format!("{}°/{}°/{} mm{at}", bin.azimuth_deg, bin.pitch_deg, bin.distance_mm)
}
