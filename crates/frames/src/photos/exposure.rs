//! One photo brought to the exposure and white balance of another: the tags' white paper is the same in both.

use super::located::{FlatPhoto, TagPaper};
use crate::light;
use scaleproof_core::message::{Message, bail, ensure};
use scaleproof_core::statistics::median;

/// 8-bit level from which paper may be clipped.
const CLIPPED: f64 = 250.0;
/// Darkest 8-bit level: below, one level is more than 4 % of the light.
const DARK: f64 = 60.0;
/// The fewest tags that must show their paper in both photos.
const LEAST_TAGS: usize = 2;
/// Largest median deviation of the tags' log factors from their median; beyond it the light itself changed.
const MOST_SPREAD: f64 = 0.1;

/// Returns the factor for each channel's linear light that brings a photo to the exposure of the reference: the median over the tags.
pub fn gain(photo: &FlatPhoto, reference: &FlatPhoto) -> Result<[f64; 3], Message> {
    let of_both = photo.papers.iter().filter_map(|paper| {
        let same = |p: &&TagPaper| (p.family, p.id) == (paper.family, paper.id);
        Some((paper, reference.papers.iter().find(same)?))
    });
    let pairs: Vec<(&TagPaper, &TagPaper)> = of_both.collect();
    ensure!(
        pairs.len() >= LEAST_TAGS,
        "it shares {} located tags with {}, and needs {LEAST_TAGS} for its exposure: let the same tags be seen",
        pairs.len(),
        reference.name()
    );
    let kept: Vec<_> = pairs.iter().filter(|(a, b)| a.is_fine() && b.is_fine()).collect();
    if kept.len() < LEAST_TAGS {
        let fine = |of: fn(&(&TagPaper, &TagPaper)) -> bool| pairs.iter().filter(|pair| of(pair)).count();
        let own = fine(|(a, _)| !a.is_fine()) >= fine(|(_, b)| !b.is_fine());
        let photo = if own { photo } else { reference };
        let is_clipped = photo.papers.iter().any(|p| p.highest() >= CLIPPED);
        let photo = photo.name();
        if is_clipped {
            bail!(
                "the white paper of the tags is clipped (level {CLIPPED} and more) in {photo}, so its exposure is not known: expose so that the paper \
                 keeps a tone"
            );
        }
        bail!("the white paper of the tags is too dark (below level {DARK}) in {photo}: expose longer");
    }
    let mut gain = [1.0; 3];
    for (channel, gain) in gain.iter_mut().enumerate() {
        let light = |paper: &TagPaper| light::decode(paper.level[channel] / 255.0);
        let logs: Vec<f64> = kept.iter().map(|(a, b)| (light(b) / light(a)).ln()).collect();
        let middle = median(&logs).unwrap_or(0.0);
        let off: Vec<f64> = logs.iter().map(|log| (log - middle).abs()).collect();
        let spread = median(&off).unwrap_or(0.0);
        ensure!(
            spread <= MOST_SPREAD,
            "the tags' paper does not change by one factor from {} (±{:.0} %): the light moved between the photos, or a shadow did",
            reference.name(),
            100.0 * spread
        );
        *gain = middle.exp();
    }
    Ok(gain)
}

impl TagPaper {
    fn highest(&self) -> f64 {
        self.level.into_iter().fold(0.0, f64::max)
    }

    fn is_fine(&self) -> bool {
        self.highest() < CLIPPED && self.level.iter().all(|level| *level >= DARK)
    }
}
