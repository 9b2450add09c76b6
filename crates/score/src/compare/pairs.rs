//! Pairs of photos of two textures, by place and bin.

use std::collections::{BTreeMap, BTreeSet};

use crate::compare::CompareError;
use crate::figures::{ClusteredBy, NotScored, ScoredPhoto, ScoredSet};
use scaleproof_core::statistics::FEWEST_CLUSTERS;
use scaleproof_pose::scene::Bin;

/// Photos of the base and of the other variant.
pub(crate) type Pair<'a> = (&'a ScoredPhoto, &'a ScoredPhoto);

/// The pairs of one place and bin.
pub(crate) struct Cell<'a> {
    pub bin: Bin,
    pub place: &'a str,
    pub pairs: Vec<Pair<'a>>,
}

/// Pairs that are not independent of each other.
pub(crate) struct Cluster<'a> {
    pub pairs: Vec<Pair<'a>>,
}

/// Pairs the photos of two variants by place and bin, in the order of the sessions; photos left over are returned too.
///
/// A photo without a place is in the one unnamed place, so that two sessions pair when neither names any.
pub(crate) fn pair<'a>(set: ScoredSet<'a>, base: &str, variant: &str) -> (Vec<Cell<'a>>, Vec<NotScored>) {
    let mut sides: BTreeMap<_, [Vec<&ScoredPhoto>; 2]> = BTreeMap::new();
    let mut unpaired = Vec::new();
    for photo in set.photos {
        let side = match &photo.variant {
            v if v == base => 0,
            v if v == variant => 1,
            _ => continue,
        };
        match photo.bin {
            Some(bin) => sides
                .entry((bin, photo.place.as_deref().unwrap_or_default()))
                .or_default()[side]
                .push(photo),
            None => unpaired.push(left_over(set, photo, "its viewpoint is not known".into())),
        }
    }
    let mut cells = Vec::new();
    for ((bin, place), [bases, others]) in sides {
        let pairs: Vec<_> = bases.iter().copied().zip(others.iter().copied()).collect();
        let bases = bases[pairs.len()..].iter().map(|p| (p, variant));
        let others = others[pairs.len()..].iter().map(|p| (p, base));
        for (photo, missing) in bases.chain(others) {
            let place = if place.is_empty() { "no named place" } else { place };
            let from = direction(&bin);
            let reason = format!("no photo of “{missing}” is left for it from {from}, {place}");
            unpaired.push(left_over(set, photo, reason));
        }
        if !pairs.is_empty() {
            cells.push(Cell { bin, place, pairs });
        }
    }
    (cells, unpaired)
}

/// Returns the clustering: by place where there are enough places, since the photos of one place share its light and background in every direction.
pub(crate) fn clustered_by(cells: &[Cell]) -> ClusteredBy {
    let places: BTreeSet<&str> = cells.iter().map(|cell| cell.place).collect();
    if places.len() >= FEWEST_CLUSTERS {
        ClusteredBy::Place
    } else {
        ClusteredBy::PlaceAndBin
    }
}

/// Returns the clusters of some cells, in their order.
pub(crate) fn clusters<'a>(cells: &[&Cell<'a>], by: ClusteredBy) -> Vec<Cluster<'a>> {
    let mut clusters: Vec<(&str, Cluster)> = Vec::new();
    for cell in cells {
        let same = |(place, _): &&mut (&str, Cluster)| by == ClusteredBy::Place && *place == cell.place;
        match clusters.iter_mut().find(same) {
            Some((_, cluster)) => cluster.pairs.extend(&cell.pairs),
            None => {
                let pairs = cell.pairs.clone();
                clusters.push((cell.place, Cluster { pairs }));
            }
        }
    }
    clusters.into_iter().map(|(_, cluster)| cluster).collect()
}

fn direction(bin: &Bin) -> String {
    format!(
        "azimuth {}°, pitch {}°, {} mm",
        bin.azimuth_deg, bin.pitch_deg, bin.distance_mm
    )
}

fn left_over(set: ScoredSet, photo: &ScoredPhoto, reason: String) -> NotScored {
    NotScored {
        session: set.sessions[photo.session].name.clone(),
        file: photo.file.clone(),
        variant: photo.variant.clone(),
        reason,
        near_copy_of: None,
    }
}

/// Returns the pairs of two variants, of which there must be one, and the photos left over.
pub(crate) fn some_pairs<'a>(
    set: ScoredSet<'a>,
    base: &str,
    variant: &str,
) -> Result<(Vec<Cell<'a>>, Vec<NotScored>), CompareError> {
    let (cells, left_over) = pair(set, base, variant);
    if cells.is_empty() {
        let (base, variant) = (base.to_owned(), variant.to_owned());
        return Err(CompareError::NoPair { base, variant });
    }
    Ok((cells, left_over))
}

/// Returns true if photos of two variants pair.
pub(crate) fn pairs(set: ScoredSet, base: &str, other: &str) -> bool {
    !pair(set, base, other).0.is_empty()
}
