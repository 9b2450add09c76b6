//! Common cause of many photos without a good pose, if there is one: hundreds of photos seldom fail for hundreds of reasons.
//!
//! A wrong cause would cost more time than none. So most photos must be bad, most of the telling ones must become good once the cause is corrected,
//! and no rival cause may do that as well.

use std::collections::BTreeSet;
use std::path::Path;

use super::factor::{self, Factor, FactorKind};
use super::part_sizes::{self, PartSize, has_outlier};
use super::relabelled::{self, Relabelled};
use super::{Abstention, LocatedPhoto, Warning};
use crate::camera::{Camera, SizeError};
use crate::scene::{Scene, TagFamily};
use crate::tags::SeenTag;

#[derive(Debug, Clone, PartialEq)]
pub enum Diagnosis {
    /// The tags are larger or smaller than the scene says.
    TagSize(Factor),
    /// Some of the tags are larger or smaller than the scene says.
    PartSize(PartSize),
    /// The camera's focal length is longer or shorter than its file says.
    Focal(Factor),
    /// Tags of the scene's family that the scene does not have.
    OtherIds { family: TagFamily, ids: Vec<u32> },
    /// The photos show tags of other families than the scene's.
    OtherFamilies { found: Vec<(TagFamily, Vec<u32>)> },
    /// All cards are turned alike, or all have ids that are shifted by one number.
    Cards(Relabelled),
    /// The tags are found in the mirrored photo: the prints are mirrored, or the photos.
    Mirrored { photos: usize, of: usize },
    /// The camera file is for another aspect ratio.
    CameraSize { errors: Vec<SizeError> },
    /// The photos are too blurred for tags.
    Blurred { photos: usize, of: usize },
    /// No tag is found at all. `searched_others`: number of photos that were searched for every family.
    NoTags {
        photos: usize,
        of: usize,
        searched_others: usize,
    },
}

/// Minimum number of photos that are bad in one way, and of those that must tell the cause.
const FEWEST: usize = 3;

/// Minimum share of bad photos among all, and of healed photos among the telling ones.
const MOST: f64 = 0.8;

/// Maximum of a factor's mean squared error, as a share of the error without it and of the rival's.
const BETTER: f64 = 0.25;
const BETTER_THAN_RIVAL: f64 = 0.5;

/// Smallest reported deviation of a factor from 1; prints and lenses have smaller ones anyway.
const SMALLEST: f64 = 0.01;

/// Maximum spread of the middle half of the photos' factors, as a share of the factor's distance from 1 (both in logarithms).
const AGREEMENT: f64 = 0.5;

/// Returns true for a photo without a pose, or with one that its tags fit poorly.
pub fn is_bad(photo: &LocatedPhoto) -> bool {
    match &photo.result {
        Ok(located) => located.warnings.contains(&Warning::PoorFit),
        Err(_) => true,
    }
}

/// Returns true if nearly all photos show no tag of the families that were searched, so that others should be searched.
pub fn is_without_tags(photos: &[&LocatedPhoto]) -> bool {
    is_most(photos, |p| {
        matches!(p.result, Err(Abstention::NoTags | Abstention::Blurred { .. }))
    })
}

/// Tags found in some photos by further searches; empty if none was made.
#[derive(Debug, Default)]
pub struct OtherLooks {
    /// Tags of the families that the scene lacks, by photo.
    pub families: Vec<Vec<SeenTag>>,
    /// Tags of the scene's families in the mirrored photo, by photo.
    pub mirrored: Vec<Vec<SeenTag>>,
}

/// Returns true if nearly all photos are bad, so that they may have one cause.
pub fn are_bad(photos: &[&LocatedPhoto]) -> bool {
    is_most(photos, is_bad)
}

/// Returns the common cause, if there is one.
pub fn diagnose(photos: &[&LocatedPhoto], others: &OtherLooks, scene: &Scene) -> Option<Diagnosis> {
    if !are_bad(photos) {
        // If the tags of a wrong size are fewer than the others, they are rejected as outliers, and the photos are located.
        let doubtful: Vec<&LocatedPhoto> = photos.iter().copied().filter(|p| is_bad(p) || has_outlier(p)).collect();
        let are_many = doubtful.len() >= FEWEST && 2 * doubtful.len() >= photos.len();
        return are_many
            .then(|| part_size(&doubtful, photos.len(), f64::INFINITY, scene))
            .flatten();
    }
    if is_most(photos, |p| matches!(p.result, Err(Abstention::WrongCameraSize(_)))) {
        let mut errors: Vec<SizeError> = Vec::new();
        for photo in photos {
            if let Err(Abstention::WrongCameraSize(e)) = &photo.result
                && !errors.contains(e)
            {
                errors.push(e.clone());
            }
        }
        return Some(Diagnosis::CameraSize { errors });
    }
    if let Some(found) = mirrored(&others.mirrored, scene) {
        return Some(found);
    }
    let is_blurred = |p: &LocatedPhoto| matches!(p.result, Err(Abstention::Blurred { .. }));
    if is_most(photos, is_blurred) {
        return Some(Diagnosis::Blurred {
            photos: photos.iter().filter(|p| is_blurred(p)).count(),
            of: photos.len(),
        });
    }
    let others = &others.families;
    if is_without_tags(photos) {
        let no_tags = || Diagnosis::NoTags {
            photos: photos.iter().filter(|p| p.seen.is_empty()).count(),
            of: photos.len(),
            searched_others: others.len(),
        };
        return Some(other_families(others).unwrap_or_else(no_tags));
    }
    let bad: Vec<&LocatedPhoto> = photos.iter().copied().filter(|p| is_bad(p)).collect();
    let relabelled = relabelled::find(photos, scene).map(Diagnosis::Cards);
    let cause = relabelled.or_else(|| other_ids(photos, scene));
    cause.or_else(|| wrong_number(&bad, photos.len(), scene))
}

fn is_most(photos: &[&LocatedPhoto], is: impl Fn(&LocatedPhoto) -> bool) -> bool {
    let count = photos.iter().filter(|p| is(p)).count();
    count >= FEWEST && count as f64 >= MOST * photos.len() as f64
}

/// Tests for mirrored photos: most of the mirrored copies must show two whole tags of the scene.
fn mirrored(looks: &[Vec<SeenTag>], scene: &Scene) -> Option<Diagnosis> {
    let is_scenes = |tag: &&SeenTag| tag.is_whole && scene.tag(tag.family, tag.id).is_some();
    let with_two = looks.iter().filter(|seen| seen.iter().filter(is_scenes).count() >= 2);
    let (photos, of) = (with_two.count(), looks.len());
    (photos >= 2.min(of) && 2 * photos > of).then_some(Diagnosis::Mirrored { photos, of })
}

/// Finds families with two whole tags in most of the photos that were searched: single ones are false detections in grass or print.
fn other_families(others: &[Vec<SeenTag>]) -> Option<Diagnosis> {
    let found = TagFamily::ALL.into_iter().filter_map(|(family, _)| {
        let whole = |seen: &Vec<SeenTag>| -> BTreeSet<u32> {
            let whole = seen.iter().filter(|tag| tag.family == family && tag.is_whole);
            whole.map(|tag| tag.id).collect()
        };
        let ids: Vec<BTreeSet<u32>> = others.iter().map(whole).collect();
        let with_two = ids.iter().filter(|ids| ids.len() >= 2).count();
        let is_there = with_two >= 2.min(others.len()) && 2 * with_two > others.len();
        let ids: BTreeSet<u32> = ids.into_iter().flatten().collect();
        is_there.then(|| (family, Vec::from_iter(ids)))
    });
    let found: Vec<(TagFamily, Vec<u32>)> = found.collect();
    (!found.is_empty()).then_some(Diagnosis::OtherFamilies { found })
}

/// Tests for other ids: most photos must show at least two tags that the scene lacks, and at least as many of those as of the scene's own.
fn other_ids(photos: &[&LocatedPhoto], scene: &Scene) -> Option<Diagnosis> {
    let unknown = |p: &LocatedPhoto| -> BTreeSet<(TagFamily, u32)> {
        let unknown = p.seen.iter().filter(|t| scene.tag(t.family, t.id).is_none());
        unknown.map(|t| (t.family, t.id)).collect()
    };
    let is_strange = |p: &LocatedPhoto| {
        let strange = unknown(p).len();
        strange >= 2 && strange >= p.seen.len() - strange.min(p.seen.len())
    };
    if !is_most(photos, is_strange) {
        return None;
    }
    let all: BTreeSet<(TagFamily, u32)> = photos.iter().flat_map(|p| unknown(p)).collect();
    let in_family = |family| {
        let of_family = all.iter().filter(|(f, _)| *f == family);
        (family, Vec::from_iter(of_family.map(|(_, id)| *id)))
    };
    let by_family = scene.families().into_iter().map(in_family);
    let (family, ids) = by_family.max_by_key(|(_, ids)| ids.len())?;
    Some(Diagnosis::OtherIds { family, ids })
}

/// Tests for a wrong size of all tags, and for a wrong focal length.
fn wrong_number(bad: &[&LocatedPhoto], photos: usize, scene: &Scene) -> Option<Diagnosis> {
    let size = factor::fit(FactorKind::TagSize, bad, scene)?;
    let focal = factor::fit(FactorKind::Focal, bad, scene)?;
    let best = size.cost.min(focal.cost);
    let could_be = |fit: &Factor| best > BETTER_THAN_RIVAL * fit.cost;
    let is_good = |fit: &Factor| is_good(fit, photos);
    if let Some(part) = part_size(bad, photos, best, scene) {
        return Some(part);
    }
    match (could_be(&size), could_be(&focal)) {
        (true, false) if is_good(&size) => Some(Diagnosis::TagSize(size)),
        (false, true) if is_good(&focal) => Some(Diagnosis::Focal(focal)),
        _ => None, // where both could be, naming either would be a guess
    }
}

/// Tests for a wrong size of some tags: it must explain more than a factor of all, whose cost is `rival`, and than that of any other part.
fn part_size(bad: &[&LocatedPhoto], photos: usize, rival: f64, scene: &Scene) -> Option<Diagnosis> {
    let mut fits = part_sizes::fits(bad, scene);
    fits.sort_by(|a, b| a.size.cost.total_cmp(&b.size.cost));
    let best = fits.first()?;
    let is_best = best.size.cost <= BETTER_THAN_RIVAL * rival;
    // Overlapping parts are the same finding; a part without common tags is another explanation.
    let has_rival = fits[1..].iter().any(|other| {
        let is_apart = other.tags.iter().all(|tag| !best.tags.contains(tag));
        is_apart && best.size.cost > BETTER_THAN_RIVAL * other.size.cost
    });
    (is_best && !has_rival && is_good(&best.size, photos)).then(|| Diagnosis::PartSize(fits.swap_remove(0)))
}

/// Returns true if a factor makes most photos good, and their own factors agree with it.
fn is_good(fit: &Factor, photos: usize) -> bool {
    let share = |part: usize, of: usize| part as f64 / of as f64;
    let away = fit.factor.ln().abs();
    let spread = (fit.middle_half[1] / fit.middle_half[0]).ln();
    fit.healed >= FEWEST
        && share(fit.healed, fit.telling) >= MOST
        && share(fit.telling, photos) >= 0.5
        && fit.cost <= BETTER * fit.cost_of_one
        && away >= SMALLEST
        && spread <= AGREEMENT * away
}

impl Diagnosis {
    /// Returns the cause as a sentence that names the files, and what to do.
    pub fn sentence(&self, scene: &Scene, scene_file: &Path, camera: &Camera, camera_file: &Path) -> String {
        let (scene_file, camera_file) = (scene_file.display(), camera_file.display().to_string());
        let fits = |Factor { healed, telling, .. }: &Factor| {
            format!("{healed} of the {telling} photos with two tags or more fit")
        };
        match self {
            Diagnosis::TagSize(size) => {
                // The tags' real size and the scene's, as widths if all tags have the same.
                let mut sizes = scene.tags.iter().map(|tag| tag.size_mm);
                let (is, was) = match sizes.next() {
                    Some(first) if sizes.all(|s| s == first) => {
                        (format!("{:.1} mm wide", first * size.factor), format!("{first} mm"))
                    }
                    _ => (format!("{:.2} times as wide", size.factor), "as wide".to_owned()),
                };
                format!(
                    "the tags seem to be {is}, not {was} as {scene_file} says: so {}. Measure the black square of a printed tag: if it is \
                     as {scene_file} says, all tags stand {:.2} times as far apart as it says instead",
                    fits(size),
                    1.0 / size.factor
                )
            }
            Diagnosis::PartSize(PartSize { size, tags }) => {
                let ids: Vec<u32> = tags.iter().map(|(_, id)| *id).collect();
                let sizes: BTreeSet<String> = tags
                    .iter()
                    .filter_map(|(f, id)| Some(scene.tag(*f, *id)?.size_mm.to_string()))
                    .collect();
                let (is, was) = match (sizes.first().and_then(|mm| mm.parse::<f64>().ok()), sizes.len()) {
                    (Some(mm), 1) => (format!("{:.1} mm wide", mm * size.factor), format!("{mm} mm")),
                    _ => (format!("{:.2} times as wide", size.factor), "as wide".to_owned()),
                };
                format!(
                    "the tags with {} seem to be {is}, not {was} as {scene_file} says: so {} of {} photos that show them beside others fit. \
                     Measure the black square of one of them and of one of the others, and correct size_mm of these tags or print them again",
                    ids_in_words(&ids),
                    size.healed,
                    size.telling
                )
            }
            Diagnosis::Focal(focal) => {
                let off = 100.0 * (1.0 / focal.factor - 1.0);
                let (too, is_px) = (if off > 0.0 { "long" } else { "short" }, camera.fx * focal.factor);
                format!(
                    "the focal length in {camera_file} seems {:.0} % too {too} (some {is_px:.0} px, not {:.0}): so {}. Are these photos of \
                     another camera or zoom, or cut out of larger ones? Calibrate this camera (scaleproof calibrate), or name its file",
                    off.abs(),
                    camera.fx,
                    fits(focal)
                )
            }
            Diagnosis::OtherIds { family, ids } => {
                let own = scene.tags.iter().filter(|t| t.family == *family);
                let own = Vec::from_iter(own.map(|t| t.id));
                format!(
                    "these photos show {} {}, and {scene_file} has {}: are these another scene's cards?",
                    family.name(),
                    ids_in_words(ids),
                    ids_in_words(&own)
                )
            }
            Diagnosis::OtherFamilies { found } => {
                let tags = |(f, ids): &(TagFamily, Vec<u32>)| format!("{} {}", f.name(), ids_in_words(ids));
                let found: Vec<String> = found.iter().map(tags).collect();
                format!(
                    "these photos show {}, and {scene_file} has {} only: are these another scene's cards, or is `family` wrong there?",
                    found.join(" and "),
                    families(scene)
                )
            }
            Diagnosis::Cards(Relabelled { cards, telling, healed }) => format!(
                "{}, compared with {scene_file}: so {healed} of the {telling} photos with two tags or more fit. Say so there, in lines of their own \
                 before the first [[tag]]: `[cards]` and `{}`",
                cards.clause(),
                cards.line()
            ),
            Diagnosis::Mirrored { photos, of } => format!(
                "the tags are mirrored: {photos} of {of} photos that were searched show tags of {scene_file} when they are mirrored, which no tag \
                 detector reads. Print the cards again, without “mirror” or “flip” in the print dialogue, or, if writing in the photos is \
                 mirrored too, switch that off in the camera"
            ),
            Diagnosis::CameraSize { errors } => camera_sizes(errors, &camera_file),
            Diagnosis::Blurred { photos, of } => format!(
                "{photos} of {of} photos have no sharp edge: they are blurred, by motion or focus, and no tag can be read in them. More light, a \
                 shorter exposure, and focus on the model"
            ),
            Diagnosis::NoTags {
                photos,
                of,
                searched_others,
            } => {
                let where_none = if photos == of {
                    "none of the photos shows a tag".to_owned()
                } else {
                    format!("{photos} of {of} photos show no tag")
                };
                let others = match searched_others {
                    0 => String::new(),
                    n => format!(", and no other family in the {n} that were searched for all"),
                };
                format!(
                    "{where_none}: no {} of {scene_file}{others}. Are they in the photo, sharp, lit, with their white margin, and at \
                     least 25 pixels wide? Look at one photo at full size",
                    families(scene)
                )
            }
        }
    }
}

fn camera_sizes(errors: &[SizeError], camera_file: &str) -> String {
    let (mut cropped, mut turned, mut own) = (Vec::new(), Vec::new(), "");
    for error in errors {
        let (photo, camera, kind) = match error {
            SizeError::Cropped { photo, camera } => (photo, camera, &mut cropped),
            SizeError::Turned { photo, camera } => (photo, camera, &mut turned),
        };
        own = camera;
        kind.push(photo.as_str());
    }
    let (photos, advice) = if cropped.is_empty() {
        let advice = "with no EXIF data that says which way they were turned: use the original photos, or calibrate with photos held this way";
        (turned, advice)
    } else {
        let advice = "another aspect ratio: were they cut, or taken with another camera or format? Use the original photos, or calibrate at this size";
        (cropped, advice)
    };
    let sizes = match &photos[..] {
        [first, second, third, _, ..] => format!("{first}, {second}, {third} and others"),
        few => few.join(" and "),
    };
    format!("{camera_file} is for photos of {own}, and these are {sizes}, {advice}")
}

fn families(scene: &Scene) -> String {
    let names: Vec<&str> = scene.families().into_iter().map(TagFamily::name).collect();
    names.join(" and ")
}

/// Returns `id 7`, `ids 0 to 15`, `ids 1, 5 and 20 to 27`, at most `MOST_RANGES` ranges.
pub fn ids_in_words(ids: &[u32]) -> String {
    let sorted: BTreeSet<u32> = ids.iter().copied().collect();
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for id in &sorted {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *id => *last = *id,
            _ => ranges.push((*id, *id)),
        }
    }
    let shown = |(first, last): &(u32, u32)| match last - first {
        0 | 1 => (*first..=*last).map(|id| id.to_string()).collect(),
        _ => vec![format!("{first} to {last}")],
    };
    let mut words: Vec<String> = ranges.iter().flat_map(shown).collect();
    if words.len() > MOST_RANGES {
        words.truncate(MOST_RANGES - 1);
        words.push("others".to_owned());
    }
    let noun = if sorted.len() == 1 { "id" } else { "ids" };
    match words.pop() {
        None => "no id".to_owned(),
        Some(last) if words.is_empty() => format!("{noun} {last}"),
        Some(last) => format!("{noun} {} and {last}", words.join(", ")),
    }
}

/// Maximum number of ranges in [`ids_in_words`].
const MOST_RANGES: usize = 8;
