//! Findings on many detectors and textures, tested together.

use std::collections::{BTreeMap, BTreeSet};

use crate::compare::control::withhold;
use crate::compare::detectable::drop_shown_from;
use crate::figures::{Compared, Comparison, Effect, Finding, InPlacesLikeThese, PairedView, Sums};
use scaleproof_core::statistics::{shares, sign_flip_p, smallest_sign_flip_p};

/// Rate of wrong findings that is promised, for the confidence and again for the hit rate.
pub(crate) const LEVEL: f64 = 0.05;

/// Mean confidence of the base below which a detector does not see it.
pub(crate) const LEAST_SEEN: f64 = 0.1;

/// Largest hit rate at which a texture hides the model.
pub const MOST_HIT: f64 = 0.25;

/// Differences of one figure: for each detector, one for each cluster.
type Differences = Vec<Vec<f64>>;

/// Decides the findings of a comparison: its textures share the error rate, the detectors of a texture are tested together, and effects no larger
/// than those of the control are withheld.
pub fn decide(comparison: &mut Comparison) {
    decide_among(comparison, |_| true);
}

/// Decides as [`decide`] for the detectors that are tested: the others are in no family and get no finding.
pub(crate) fn decide_among(comparison: &mut Comparison, is_tested: impl Fn(&str) -> bool) {
    let textures = comparison.results.chunk_by_mut(|a, b| a.variant == b.variant);
    let families = textures.map(|family| family.iter_mut().filter(|r| is_tested(&r.detector)).collect());
    let families = families.filter(|family: &Vec<_>| !family.is_empty()).collect();
    decide_families(families, LEAST_SEEN);
    if let Some(control) = &comparison.control {
        withhold(&mut comparison.results, control);
    }
}

/// Decides several families that share the error rate: each is a list of comparisons that are tested together, on the same views.
///
/// For the confidence, the differences of the pairs of a view (place × bin) are summed, and the signs of the views flipped for all members together
/// ([`sign_flip_p`]). A family of which everything is shown passes its share on ([`shares`]). The hit rate is decided in the same way with an error
/// rate of its own. An effect that is shown for these places is tested for places like these by flipping whole places. A member whose base has a
/// smaller mean confidence than `least_seen` gets the effect `BaseUnseen`.
pub(crate) fn decide_families(mut families: Vec<Vec<&mut Compared>>, least_seen: f64) {
    let all = findings(&families, least_seen, PairedView::sums);
    let mut views = families.iter().flatten().flat_map(|compared| &compared.views);
    let once = views
        .any(PairedView::has_repeats)
        .then(|| findings(&families, least_seen, PairedView::sums_once));
    for (f, family) in families.iter_mut().enumerate() {
        for (k, compared) in family.iter_mut().enumerate() {
            let finding = match &once {
                Some(once) => standing(all[f][k], once[f][k]),
                None => all[f][k],
            };
            compared.finding = Some(finding);
        }
    }
}

/// Returns what remains of a finding when photos that show the same moment again count once.
fn standing(finding: Finding, once: Finding) -> Finding {
    if finding.effect == once.effect && finding.effect.is_shown() {
        return finding;
    }
    let effect = match once.effect {
        Effect::BaseUnseen => Effect::BaseUnseen,
        _ => Effect::NothingShown,
    };
    Finding {
        effect,
        withheld_for_copies: finding.effect.is_shown(),
        in_places_like_these: None,
        ..once
    }
}

/// Returns the finding on each member of each family by these sums of its views.
fn findings(
    families: &[Vec<&mut Compared>],
    least_seen: f64,
    sums: impl Fn(&PairedView) -> Option<Sums> + Copy,
) -> Vec<Vec<Finding>> {
    let tests: Vec<FamilyTests> = families.iter().map(|family| FamilyTests::of(family, sums)).collect();
    let levels =
        |p: fn(&FamilyTests) -> &Vec<f64>| shares(&tests.iter().map(|a| p(a).clone()).collect::<Vec<_>>(), LEVEL);
    let confidence_levels = levels(|a| &a.confidence_p);
    let hit_rate_levels = levels(|a| &a.hit_rate_p);
    let of_family = |(f, family): (usize, &Vec<&mut Compared>)| {
        let levels = Levels {
            confidence: confidence_levels[f],
            hit_rate: hit_rate_levels[f],
            least_seen,
        };
        (0..family.len())
            .map(|k| tests[f].finding(k, family[k], levels))
            .collect()
    };
    families.iter().enumerate().map(of_family).collect()
}

/// Largest p values that count as shown, and smallest mean confidence of a base that is seen.
#[derive(Clone, Copy)]
struct Levels {
    confidence: f64,
    hit_rate: f64,
    least_seen: f64,
}

/// p values of one family, and the differences they are of.
struct FamilyTests {
    confidence: Differences,
    /// Number of pairs in each view.
    pairs: Vec<f64>,
    places: usize,
    confidence_p: Vec<f64>,
    hit_rate_p: Vec<f64>,
    confidence_p_of_places: Vec<f64>,
    hit_rate_p_of_places: Vec<f64>,
}

impl FamilyTests {
    fn of(family: &[&mut Compared], sums: impl Fn(&PairedView) -> Option<Sums> + Copy) -> FamilyTests {
        let view = |v: &PairedView| (v.place.clone(), v.bin);
        let place = |v: &PairedView| v.place.clone();
        let confidence = by_cluster(family, sums, view, |s| s.confidence_lost);
        let by_place = by_cluster(family, sums, place, |s| s.confidence_lost);
        let pairs = by_cluster(family, sums, view, |s| s.pairs as f64);
        FamilyTests {
            pairs: pairs.into_iter().next().unwrap_or_default(),
            places: by_place.first().map_or(0, Vec::len),
            confidence_p: sign_flip_p(&confidence),
            hit_rate_p: sign_flip_p(&by_cluster(family, sums, view, |s| s.hits_lost)),
            confidence_p_of_places: sign_flip_p(&by_place),
            hit_rate_p_of_places: sign_flip_p(&by_cluster(family, sums, place, |s| s.hits_lost)),
            confidence,
        }
    }

    fn finding(&self, member: usize, compared: &Compared, levels: Levels) -> Finding {
        let p = [self.confidence_p[member], self.hit_rate_p[member]];
        let effect = effect(compared, p, levels);
        let views_missing = missing(self.pairs.len(), levels.confidence);
        let asks_for_drop = effect == Effect::NothingShown && views_missing == 0;
        Finding {
            effect,
            withheld_for_copies: false,
            withheld_by_control: None,
            confidence_p: p[0],
            confidence_level: levels.confidence,
            hit_rate_p: p[1],
            hit_rate_level: levels.hit_rate,
            views_missing,
            drop_shown_from: asks_for_drop
                .then(|| drop_shown_from(&self.confidence, &self.pairs, member, levels.confidence))
                .flatten()
                .filter(|drop| *drop <= compared.mean_confidence.base),
            in_places_like_these: effect
                .is_shown()
                .then(|| self.in_places_like_these(member, compared, levels)),
        }
    }

    fn in_places_like_these(&self, member: usize, compared: &Compared, levels: Levels) -> InPlacesLikeThese {
        let p = [self.confidence_p_of_places[member], self.hit_rate_p_of_places[member]];
        // Hits that are not shown to change in these places are not shown to change in others.
        let hit_rate_p = p[1].max(self.hit_rate_p[member]);
        InPlacesLikeThese {
            effect: effect(compared, [p[0], hit_rate_p], levels),
            confidence_p: p[0],
            places_missing: missing(self.places, levels.confidence),
        }
    }
}

/// Returns the effect that is shown by the p values of the confidence and of the hit rate.
fn effect(compared: &Compared, [confidence_p, hit_rate_p]: [f64; 2], levels: Levels) -> Effect {
    let (confidence, hits) = (&compared.mean_confidence, &compared.hit_rate.rate);
    let is_hidden = hit_rate_p <= levels.hit_rate && hits.drop > 0.0 && hits.other <= MOST_HIT;
    if confidence.base < levels.least_seen {
        Effect::BaseUnseen
    } else if confidence_p > levels.confidence {
        Effect::NothingShown
    } else if confidence.drop < 0.0 {
        Effect::Strengthens
    } else if is_hidden {
        Effect::Hides
    } else {
        Effect::Weakens
    }
}

/// Sums a figure's differences over clusters of the views, which are the same for all members; 0 where a member has no photos.
fn by_cluster<K: Ord>(
    family: &[&mut Compared],
    sums: impl Fn(&PairedView) -> Option<Sums>,
    cluster: impl Fn(&PairedView) -> K,
    figure: impl Fn(&Sums) -> f64,
) -> Differences {
    let views = |compared: &Compared| -> Vec<(K, f64)> {
        let views = compared.views.iter();
        views
            .filter_map(|view| Some((cluster(view), figure(&sums(view)?))))
            .collect()
    };
    let members: Vec<Vec<(K, f64)>> = family.iter().map(|compared| views(compared)).collect();
    let clusters: BTreeSet<&K> = members.iter().flatten().map(|(cluster, _)| cluster).collect();
    let of_member = |views: &Vec<(K, f64)>| {
        let mut sums: BTreeMap<&K, f64> = BTreeMap::new();
        for (cluster, figure) in views {
            *sums.entry(cluster).or_default() += figure;
        }
        clusters
            .iter()
            .map(|key| sums.get(key).copied().unwrap_or_default())
            .collect()
    };
    members.iter().map(of_member).collect()
}

/// Returns the number of further clusters from which the smallest possible p is within the level.
pub(crate) fn missing(clusters: usize, level: f64) -> usize {
    (0..)
        .take_while(|more| smallest_sign_flip_p(clusters + more) > level)
        .count()
}
