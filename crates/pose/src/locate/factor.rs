//! One factor that makes many photos fit: of the tags' sizes, or of the focal length.

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

/// A factor of what a file says with which the photos fit best, and what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// The truth by what the file says.
    pub factor: f64,
    /// Mean square over the photos of their corners' distances, (degrees)², each bounded.
    pub cost: f64,
    /// Cost with factor 1, (degrees)²: how badly the photos fit what the file says.
    pub cost_of_one: f64,
    /// Photos that say something: two tags or more.
    pub telling: usize,
    pub healed: usize,
    /// The best factors of single photos: the middle half lies between these.
    pub middle_half: [f64; 2],
}

/// Factors that are tried first, each way from 1, and the step between two of them.
const MOST: f64 = 2.2;
const STEP: f64 = 1.06;

/// Halvings (golden sections) of the step around the best of them.
const SECTIONS: usize = 12;
/// What a photo's own factor may differ from that of all.
const OWN_REACH: f64 = 1.15;

/// So many photos, spread evenly, are fitted; all are tried with the factor that was found.
const FITTED: usize = 12;

/// A photo that nothing makes fit says no more than this, degrees.
const WORST_DEG: f64 = 0.5;

/// Fits a factor to the photos with two tags or more. `None` when there are none.
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

/// At most so many of some things, from the first to the last, evenly.
pub fn spread<T: Copy>(all: &[T], most: usize) -> Vec<T> {
    let count = all.len().min(most);
    let at = |i: usize| all[i * (all.len() - 1) / (count - 1).max(1)];
    (0..count).map(at).collect()
}

/// Two tags or more, and where the factor is of a part of them, one of each kind.
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
    /// Whether a tag's size is multiplied.
    fn scales(self, tag: &Tag) -> bool {
        match self {
            FactorKind::TagSize => true,
            FactorKind::PartSize(part) => part.contains(&(tag.family, tag.id)),
            FactorKind::Focal => false,
        }
    }
}

/// The scene with its tags' sizes multiplied, when that is what the factor belongs to.
fn scaled(of: FactorKind, scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let tags = scene.tags.iter_mut().filter(|tag| of.scales(tag));
    tags.for_each(|tag| tag.size_mm *= factor);
    scene
}

/// The photo's camera with its focal length multiplied, when that is what the factor belongs to.
fn camera(of: FactorKind, factor: f64, photo: &LocatedPhoto) -> Option<Camera> {
    let mut camera = photo.fitted.as_ref().ok()?.camera.clone();
    if of == FactorKind::Focal {
        camera.fx *= factor;
        camera.fy *= factor;
    }
    Some(camera)
}

/// How badly all tags of a photo fit at best, (degrees)²; `scene` has the factor already.
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

/// Whether two tags or more locate the camera and agree, as in a good photo, where hardly one is left out.
pub(super) fn agree(seen: &[SeenTag], scene: &Scene, camera: &Camera) -> bool {
    let agree = |l: Located| {
        let outliers = l.ignored_tags.iter().filter(|tag| tag.why.is_outlier()).count();
        l.tags.len() >= 2 && 4 * outliers <= l.tags.len() && !l.warnings.contains(&Warning::PoorFit)
    };
    locate(seen, scene, camera).is_ok_and(agree)
}

/// The factor between two with the least cost (golden section search, Kiefer 1953).
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
