//! Which photo of one texture is held against which of the other.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::scene::Bin;
use crate::score::{ScoredPhoto, Scores};

/// A scored photo that has no partner, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unpaired {
    pub session: String,
    pub file: String,
    pub variant: String,
    /// A sentence.
    pub reason: String,
}

/// The pairs of one place and bin, which are not independent of each other: (base, other).
pub(super) struct Cluster<'a> {
    pub bin: Bin,
    pub pairs: Vec<(&'a ScoredPhoto, &'a ScoredPhoto)>,
}

/// Pairs the photos of two variants by place and bin, in the order of the sessions; photos left over are returned too.
///
/// A photo without a place is in the one unnamed place, so that two sessions pair when neither names any.
pub(super) fn pair<'a>(scores: &'a Scores, base: &str, variant: &str) -> (Vec<Cluster<'a>>, Vec<Unpaired>) {
    let mut sides: BTreeMap<_, [Vec<&ScoredPhoto>; 2]> = BTreeMap::new();
    let mut unpaired = Vec::new();
    for photo in &scores.photos {
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
            None => unpaired.push(left_over(scores, photo, "its viewpoint is not known".into())),
        }
    }
    let mut clusters = Vec::new();
    for ((bin, place), [bases, others]) in sides {
        let pairs: Vec<_> = bases.iter().copied().zip(others.iter().copied()).collect();
        for (photo, missing) in bases[pairs.len()..]
            .iter()
            .map(|p| (p, variant))
            .chain(others[pairs.len()..].iter().map(|p| (p, base)))
        {
            let place = if place.is_empty() { "no named place" } else { place };
            let reason = format!(
                "no photo of “{missing}” is left for it from {}, {place}",
                direction(photo)
            );
            unpaired.push(left_over(scores, photo, reason));
        }
        if !pairs.is_empty() {
            clusters.push(Cluster { bin, pairs });
        }
    }
    (clusters, unpaired)
}

fn direction(photo: &ScoredPhoto) -> String {
    let named = |b: Bin| {
        format!(
            "azimuth {}°, pitch {}°, {} mm",
            b.azimuth_deg, b.pitch_deg, b.distance_mm
        )
    };
    photo.bin.map_or_else(String::new, named)
}

fn left_over(scores: &Scores, photo: &ScoredPhoto, reason: String) -> Unpaired {
    Unpaired {
        session: scores.sessions[photo.session].name.clone(),
        file: photo.file.clone(),
        variant: photo.variant.clone(),
        reason,
    }
}
