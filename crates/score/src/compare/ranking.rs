//! Agreement of the order of the variants with that in other photos: simulated against photographed, 1:10 against 1:24.

use std::collections::{BTreeMap, BTreeSet};

use crate::figures::{
    ClusteredAp, DetectorView, GroupBy, RankedVariant, Ranking, RankingFinding, RankingRow, ScoredPhoto, Scores,
    variants,
};
use scaleproof_core::ap::ApDefinition;
use scaleproof_core::spelling::{choose, count};
use scaleproof_core::statistics::{ALIKE, FEWEST_CLUSTERS, Interval, interval_95_of_two, kendall_tau_b};
use scaleproof_pose::scene::Bin;

/// Orders the variants of two runs by AP, and computes how far they agree, for each detector that both have, over all photos and over those of each
/// group of the first.
pub fn ranking(scores: &Scores, other: &Scores) -> Ranking {
    let (mut rows, mut cautions) = (Vec::new(), Vec::new());
    let here: BTreeSet<&str> = scores.photos.iter().map(|photo| photo.sha256.as_str()).collect();
    let shared = other
        .photos
        .iter()
        .filter(|photo| here.contains(photo.sha256.as_str()))
        .count();
    if shared > 0 {
        cautions.push(format!(
            "{} of the other sessions {} here, too: an order agrees with itself",
            count(shared, "photo"),
            choose(shared, "is", "are")
        ));
    }
    for (side, detector) in DetectorView::each(&scores.detectors) {
        let name = &detector.manifest.name;
        let Some(other_side) = DetectorView::named(&other.detectors, name) else {
            cautions.push(format!("{name} did not look at the other photos"));
            continue;
        };
        for group in groups(scores) {
            let here = CellPhotos::new(scores, side, group.as_ref());
            let there = CellPhotos::new(other, other_side, group.as_ref());
            let title = group.map_or("all".to_owned(), |(by, value)| format!("{} {value}", by.condition));
            match row(name, &title, &here, &there, scores.criteria.ap) {
                Ok(row) => rows.push(row),
                Err(reason) => cautions.push(format!("{name}, photos: {title}: {reason}")),
            }
        }
    }
    Ranking {
        others: other.sessions.iter().map(|session| session.name.clone()).collect(),
        rows,
        cautions,
    }
}

/// Returns `None` for all photos, then each value of each condition that was grouped by.
fn groups(scores: &Scores) -> Vec<Option<(&GroupBy, String)>> {
    let of_each = scores.groups().iter().flat_map(|by| {
        let values: BTreeSet<String> = scores.photos.iter().filter_map(|photo| by.group_of(photo)).collect();
        values.into_iter().map(move |value| Some((by, value)))
    });
    std::iter::once(None).chain(of_each).collect()
}

/// The photos of one detector in a group, by place and bin and then by variant.
struct CellPhotos<'a> {
    side: DetectorView<'a>,
    cells: BTreeMap<(&'a str, Bin), BTreeMap<&'a str, Vec<&'a ScoredPhoto>>>,
    variants: Vec<String>,
}

impl<'a> CellPhotos<'a> {
    fn new(scores: &'a Scores, side: DetectorView<'a>, group: Option<&(&GroupBy, String)>) -> CellPhotos<'a> {
        let is_own = |photo: &&ScoredPhoto| group.is_none_or(|(by, value)| by.group_of(photo).as_ref() == Some(value));
        let mut cells: BTreeMap<_, BTreeMap<_, Vec<_>>> = BTreeMap::new();
        for photo in scores.photos.iter().filter(is_own) {
            if let Some(bin) = photo.bin {
                let place = photo.place.as_deref().unwrap_or_default();
                let of_cell = cells.entry((place, bin)).or_default();
                of_cell.entry(photo.variant.as_str()).or_default().push(photo);
            }
        }
        CellPhotos {
            side,
            cells,
            variants: variants(&scores.photos, &scores.base),
        }
    }

    /// Returns the APs of these variants over the cells that have photos of all of them, and the cluster of each cell: its place where there are six
    /// places or more.
    fn variant_aps(&self, all: &[&str], definition: ApDefinition) -> VariantAps {
        let whole: Vec<_> = self
            .cells
            .iter()
            .filter(|(_, own)| all.iter().all(|variant| own.contains_key(variant)))
            .collect();
        let places: BTreeSet<&str> = whole.iter().map(|((place, _), _)| *place).collect();
        let by_place = places.len() >= FEWEST_CLUSTERS;
        let cluster = |cell: usize, place: &str| {
            if by_place {
                places.iter().position(|p| *p == place).unwrap_or_default()
            } else {
                cell
            }
        };
        let variants = all.iter().map(|variant| {
            let cells = whole.iter().enumerate();
            self.side.clustered(cells.flat_map(|(cell, ((place, _), own))| {
                let photos = own.get(variant).into_iter().flatten();
                let cluster = cluster(cell, place);
                photos.map(move |photo| (*photo, cluster))
            }))
        });
        VariantAps {
            variants: variants.collect(),
            cells: whole.len(),
            clusters: if by_place { places.len() } else { whole.len() },
            definition,
        }
    }
}

struct VariantAps {
    variants: Vec<ClusteredAp>,
    cells: usize,
    clusters: usize,
    definition: ApDefinition,
}

impl VariantAps {
    /// Returns AP of each variant, when each cluster counts as often as `drawn` says.
    fn aps(&self, drawn: &[u32]) -> Vec<f64> {
        let aps = self.variants.iter();
        aps.map(|ap| ap.of_draw(drawn, self.definition)).collect()
    }
}

fn row(
    detector: &str,
    photos: &str,
    here: &CellPhotos,
    there: &CellPhotos,
    definition: ApDefinition,
) -> Result<RankingRow, String> {
    let common: Vec<&str> = here
        .variants
        .iter()
        .filter(|variant| there.variants.contains(variant))
        .map(String::as_str)
        .collect();
    if common.len() < 2 {
        return Err(format!(
            "both have {} in common, and an order needs two",
            count(common.len(), "texture")
        ));
    }
    let [own, others] = [here, there].map(|looked| looked.variant_aps(&common, definition));
    if own.cells == 0 || others.cells == 0 {
        let where_ = if own.cells == 0 {
            "here"
        } else {
            "in the other sessions"
        };
        return Err(format!("no place and bin has photos of all {} {where_}", common.len()));
    }
    let [ap, other_ap] = [&own, &others].map(|ordered| ordered.aps(&vec![1; ordered.clusters]));
    let tau = kendall_tau_b(&ap, &other_ap, ALIKE);
    let of_draws = |a: &[u32], b: &[u32]| kendall_tau_b(&own.aps(a), &others.aps(b), ALIKE).unwrap_or(0.0);
    let clusters = [own.clusters, others.clusters];
    let interval_95 = interval_95_of_two(clusters, of_draws);
    let mut variants: Vec<RankedVariant> = common
        .iter()
        .zip(ap.iter().zip(&other_ap))
        .map(|(variant, (ap50, other_ap50))| RankedVariant {
            variant: (*variant).to_owned(),
            ap50: *ap50,
            other_ap50: *other_ap50,
        })
        .collect();
    variants.sort_by(|a, b| b.ap50.total_cmp(&a.ap50));
    Ok(RankingRow {
        detector: detector.to_owned(),
        photos: photos.to_owned(),
        variants,
        cells: [own.cells, others.cells],
        clusters,
        tau,
        interval_95,
        finding: finding(clusters, tau, interval_95),
    })
}

/// Returns the finding. Without an interval all resamples agree, or there are too few clusters.
fn finding(clusters: [usize; 2], tau: Option<f64>, interval: Option<Interval>) -> RankingFinding {
    let Some(tau) = tau else {
        return RankingFinding::TooFewPhotosToTell;
    };
    let enough = clusters.iter().all(|clusters| *clusters >= FEWEST_CLUSTERS);
    let (above, below) = interval.map_or((tau > 0.0, tau < 0.0), |i| (i.low > 0.0, i.high < 0.0));
    match (enough && above, enough && below) {
        (true, _) => RankingFinding::Holds,
        (_, true) => RankingFinding::Reversed,
        (false, false) => RankingFinding::TooFewPhotosToTell,
    }
}
