//! Fit of one factor that makes many photos consistent: of the tags' sizes, or of the focal length.

use std::collections::BTreeSet;

use super::matches;
use super::solver::Solver;
use super::{Located, LocatedPhoto, Warning, locate};
use crate::camera::Camera;
use crate::scene::{Scene, Tag, TagFamily};
use crate::tags::SeenTag;

pub(super) type TagSet = BTreeSet<(TagFamily, u32)>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FactorKind<'a> {
    /// Every tag's `size_mm`, about its centre.
    TagSize,
    /// The `size_mm` of some tags, about their centres.
    PartSize(&'a TagSet),
    Focal,
}

/// Correction factor of a value in a file with which the photos fit best, and the evidence for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// Ratio of the true value to the file's.
    pub factor: f64,
    /// Mean over the photos of their squared corner residuals, (degrees)², each bounded.
    pub cost: f64,
    /// Cost with factor 1, (degrees)²: misfit of the photos to the file's value.
    pub cost_of_one: f64,
    /// Number of photos with evidence: two tags or more.
    pub telling: usize,
    pub healed: usize,
    /// Interval that contains the middle half of the single photos' best factors.
    pub middle_half: [f64; 2],
}

/// Largest factor of the initial grid, each way from 1, and the ratio between neighbours.
const MOST: f64 = 2.2;
const STEP: f64 = 1.06;

/// Number of golden section steps around the best grid point.
const SECTIONS: usize = 12;
/// Largest ratio between a photo's own factor and the common one.
const OWN_REACH: f64 = 1.15;

/// Number of photos, spread evenly, that are fitted; the resulting factor is tested on all.
const FITTED: usize = 12;

/// Upper bound of a photo's residual, degrees: more is no more evidence.
const WORST_DEG: f64 = 0.5;

/// Fits a factor to the photos with two tags or more. `None` if there are none.
pub(super) fn fit(of: FactorKind, photos: &[&LocatedPhoto], scene: &Scene) -> Option<Factor> {
    let all: Vec<&LocatedPhoto> = photos.iter().copied().filter(|p| is_telling(of, p, scene)).collect();
    let photos = spread(&all, FITTED);
    let cost = |factor: f64, photos: &[&LocatedPhoto]| {
        let scene = scaled(of, scene, factor);
        let costs = photos.iter().map(|photo| cost(of, factor, photo, &scene));
        costs.sum::<f64>() / photos.len() as f64
    };
    if photos.is_empty() {
        return None;
    }
    let steps = (MOST.ln() / STEP.ln()).ceil() as i32;
    let tried = (-steps..=steps).map(|i| STEP.powi(i)).map(|f| (f, cost(f, &photos)));
    let (coarse, _) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let factor = best_between(coarse / STEP, coarse * STEP, |f| cost(f, &photos));
    let own = |photo: &&LocatedPhoto| best_between(factor / OWN_REACH, factor * OWN_REACH, |f| cost(f, &[*photo]));
    let mut own: Vec<f64> = photos.iter().map(own).collect();
    own.sort_by(f64::total_cmp);
    let quartile = |share: f64| own[((own.len() - 1) as f64 * share).round() as usize];
    let with_factor = scaled(of, scene, factor);
    let healed = all.iter().filter(|photo| is_healed(of, factor, photo, &with_factor));
    Some(Factor {
        factor,
        cost: cost(factor, &photos),
        cost_of_one: cost(1.0, &photos),
        telling: all.len(),
        healed: healed.count(),
        middle_half: [quartile(0.25), quartile(0.75)],
    })
}

/// Returns at most `most` of the items, spread evenly from the first to the last.
pub fn spread<T: Copy>(all: &[T], most: usize) -> Vec<T> {
    let count = all.len().min(most);
    let at = |i: usize| all[i * (all.len() - 1) / (count - 1).max(1)];
    (0..count).map(at).collect()
}

/// Returns true for a photo of at least two tags and, if the factor is of a part of them, tags both in and outside the part.
fn is_telling(of: FactorKind, photo: &LocatedPhoto, scene: &Scene) -> bool {
    let matched = matches::match_tags(&photo.seen, scene);
    let are_telling = |matches: &[matches::Match]| {
        let of_part = matches.iter().filter(|m| of.scales(m.tag)).count();
        let is_mixed = (1..matches.len()).contains(&of_part);
        matches.len() >= 2 && (is_mixed || !matches!(of, FactorKind::PartSize(_)))
    };
    photo.fitted.is_ok() && matched.is_ok_and(|(matches, _)| are_telling(&matches))
}

impl FactorKind<'_> {
    /// Returns true if this factor multiplies the tag's size.
    fn scales(self, tag: &Tag) -> bool {
        match self {
            FactorKind::TagSize => true,
            FactorKind::PartSize(part) => part.contains(&(tag.family, tag.id)),
            FactorKind::Focal => false,
        }
    }
}

/// Returns the scene with its tags' sizes multiplied, if the factor applies to these.
fn scaled(of: FactorKind, scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let tags = scene.tags.iter_mut().filter(|tag| of.scales(tag));
    tags.for_each(|tag| tag.size_mm *= factor);
    scene
}

/// Returns the photo's camera with its focal length multiplied, if the factor applies to it.
fn camera(of: FactorKind, factor: f64, photo: &LocatedPhoto) -> Option<Camera> {
    let mut camera = photo.fitted.as_ref().ok()?.camera.clone();
    if of == FactorKind::Focal {
        camera.fx *= factor;
        camera.fy *= factor;
    }
    Some(camera)
}

/// Returns the least squared residual of a photo over its candidate poses, (degrees)², bounded; `scene` has the factor already.
fn cost(of: FactorKind, factor: f64, photo: &LocatedPhoto, scene: &Scene) -> f64 {
    let worst = WORST_DEG * WORST_DEG;
    let rms_deg = || {
        let camera = camera(of, factor, photo)?;
        let (matches, _) = matches::match_tags(&photo.seen, scene).ok()?;
        let candidates = Solver::SqpnpRefined.candidates(&matches, &camera);
        let best_px = candidates.into_iter().map(|c| c.rms_px).min_by(f64::total_cmp)?;
        Some(best_px * photo.fitted.as_ref().ok()?.camera.deg_per_px())
    };
    rms_deg().map_or(worst, |rms| (rms * rms).min(worst))
}

fn is_healed(of: FactorKind, factor: f64, photo: &LocatedPhoto, scene: &Scene) -> bool {
    camera(of, factor, photo).is_some_and(|camera| agree(&photo.seen, scene, &camera))
}

/// Returns true if two tags or more locate the camera and agree, with few outliers, as in a good photo.
pub(super) fn agree(seen: &[SeenTag], scene: &Scene, camera: &Camera) -> bool {
    let agree = |l: Located| {
        let outliers = l.ignored_tags.iter().filter(|tag| tag.why.is_outlier()).count();
        l.tags.len() >= 2 && 4 * outliers <= l.tags.len() && !l.warnings.contains(&Warning::PoorFit)
    };
    locate(seen, scene, camera).is_ok_and(agree)
}

/// Finds the factor with the least cost between two limits (golden section search, Kiefer 1953).
fn best_between(mut low: f64, mut high: f64, cost: impl Fn(f64) -> f64) -> f64 {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let [mut a, mut b] = [high - golden * (high - low), low + golden * (high - low)];
    let [mut of_a, mut of_b] = [cost(a), cost(b)];
    for _ in 0..SECTIONS {
        if of_a < of_b {
            (high, b, of_b) = (b, a, of_a);
            a = high - golden * (high - low);
            of_a = cost(a);
        } else {
            (low, a, of_a) = (a, b, of_b);
            b = low + golden * (high - low);
            of_b = cost(b);
        }
    }
    (low + high) / 2.0
}
