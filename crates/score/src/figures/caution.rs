//! Cautions about the figures: shown in the terminal, on the report and in `summary.json`.

use std::collections::{BTreeMap, BTreeSet};

use crate::evaluated::{DetectionSource, EvaluatedDetector};
use crate::figures::summary::thousandths;
use crate::figures::{MATCH_IOU, NotScored, ScoredPhoto, Summary, identical_photos, is_control};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::spelling;
use scaleproof_core::statistics::FEWEST_CLUSTERS;
use scaleproof_detect::Detection;
use scaleproof_pose::scene::{Bin, Envelope};
use scaleproof_session::contents::are_copies;
use scaleproof_session::{Session, envelope};

/// Returns the cautions as sentences, the weightiest first: a screen shows no more than the first few.
pub(crate) fn cautions(
    photos: &[ScoredPhoto],
    not_scored: &[NotScored],
    sessions: &[Session],
    detectors: &[EvaluatedDetector],
    base: &str,
    control: Option<&str>,
    summaries: &[Summary],
) -> Vec<String> {
    let mut cautions = Vec::new();
    // Figures that may be of something else.
    cautions.extend(never_the_model(photos, detectors));
    let cards = detectors.iter().filter_map(EvaluatedDetector::foreign);
    cautions.extend(cards.flat_map(|card| card.notes.clone()));
    cautions.extend(turned_meshes(sessions));
    cautions.extend(guessed_cameras(photos, sessions));
    cautions.extend(other_sizes(photos, sessions));
    cautions.extend(copies(photos));
    cautions.extend(repeats(photos));
    cautions.extend(left_out(not_scored));
    cautions.extend(several_models(sessions));
    cautions.extend(several_truths(photos, sessions));
    // Drops that cannot be shown, or that may have another cause.
    cautions.extend(no_base(photos, base));
    cautions.extend(few_clusters(photos, base));
    cautions.extend(uneven_directions(photos, base));
    cautions.extend(no_random(photos, base, control));
    cautions.extend(renders(sessions));
    cautions.extend(few_places(photos));
    cautions.extend(hardly_found(summaries, base));
    cautions.extend(counted_once(photos, not_scored));
    cautions.extend(unknown_classes(sessions, detectors));
    cautions.extend(loose_boxes(photos, sessions));
    cautions
}

fn no_base(photos: &[ScoredPhoto], base: &str) -> Option<String> {
    let has_base = photos.iter().any(|p| p.variant == base);
    (!has_base).then(|| format!("no photo has the variant “{base}”, so no drop can be given"))
}

/// Warns of renders, whose light, paint and lens are simplified.
fn renders(sessions: &[Session]) -> Option<String> {
    let rendered: Vec<&str> = sessions
        .iter()
        .filter(|s| s.rendered)
        .map(|s| s.name.as_str())
        .collect();
    let whose = if rendered.len() == sessions.len() {
        "the photos".to_owned()
    } else {
        format!("the photos of {}", rendered.join(", "))
    };
    (!rendered.is_empty()).then(|| {
        format!("{whose} are renders, which no camera took: what is found need not hold for a printed pattern on a real model")
    })
}

/// Warns of variants that share too few directions and places with the base, by which photos pair: any drop may be chance.
fn few_clusters(photos: &[ScoredPhoto], base: &str) -> Vec<String> {
    let mut seen: BTreeMap<&str, BTreeSet<(Bin, &str)>> = BTreeMap::new();
    for (photo, bin) in photos.iter().filter_map(|p| Some((p, p.bin?))) {
        let place = photo.place.as_deref().unwrap_or_default();
        seen.entry(&photo.variant).or_default().insert((bin, place));
    }
    let Some(own) = seen.get(base) else {
        return Vec::new();
    };
    let mut few: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for (variant, cells) in seen.iter().filter(|(variant, _)| **variant != base) {
        let shared = cells.intersection(own).count();
        if shared < FEWEST_CLUSTERS {
            few.entry(shared).or_default().push(format!("“{variant}”"));
        }
    }
    let sentence = |(shared, variants): (usize, Vec<String>)| {
        let cells = format!("{} of place × direction", spelling::count(shared, "cell"));
        let who = match variants.as_slice() {
            [one] => format!("{one} and “{base}” share {cells}"),
            several => format!("{} each share {cells} with “{base}”", several.join(", ")),
        };
        format!(
            "{who}, fewer than the {FEWEST_CLUSTERS} from which on a drop can be shown: whatever the drop, it may be chance"
        )
    };
    few.into_iter().map(sentence).collect()
}

/// Warns of few places: results at one place need not hold at another.
fn few_places(photos: &[ScoredPhoto]) -> Option<String> {
    let places: BTreeSet<Option<&str>> = photos.iter().map(|p| p.place.as_deref()).collect();
    match places.len() {
        0 => None,
        1 if places.contains(&None) => Some(
            "no photo names a place, and all are taken as of one: what is found holds for where, how and in what light they were taken"
                .to_owned(),
        ),
        1 => Some(
            "all photos are of one place: what is found holds for this place, this print and this light".to_owned(),
        ),
        few if few < FEWEST_CLUSTERS => Some(format!(
            "the photos are of {few} places, fewer than {FEWEST_CLUSTERS}: the intervals take the directions of one place as independent, and hold for \
             these places"
        )),
        _ => None,
    }
}

/// Warns of detectors that often miss the base itself, which leaves little to drop.
fn hardly_found(summaries: &[Summary], base: &str) -> Vec<String> {
    let own = summaries.iter().filter(|s| s.variant == base);
    let few = own.filter(|s| s.overall.hit_rate.rate < HARDLY_FOUND);
    let sentence = |s: &Summary| {
        let (hits, photos) = (s.overall.hit_rate.count, spelling::count(s.overall.photos, "photo"));
        let detector = &s.detector;
        format!(
            "{detector} finds “{base}” itself in {hits} of {photos} only: its hit rate can hardly fall (floor effect)"
        )
    };
    few.map(sentence).collect()
}

/// Hit rate of the base below which hardly anything is left to drop.
const HARDLY_FOUND: f64 = 0.5;

/// Warns of detectors that never find the model: their boxes may be of another scale, their labels of another numbering.
fn never_the_model<'a>(photos: &'a [ScoredPhoto], detectors: &[EvaluatedDetector]) -> Vec<String> {
    let of = |(index, detector): (usize, &EvaluatedDetector)| {
        let of_photo = move |p: &'a ScoredPhoto| p.detections[index].iter().map(|d| (d, &p.truth));
        let found = || photos.iter().flat_map(of_photo);
        let counts = |d: &Detection| detector.counted.contains(&d.label);
        let name = &detector.manifest.name;
        if !found().any(|(d, _)| counts(d)) {
            let mut labels: BTreeMap<usize, usize> = BTreeMap::new();
            found().for_each(|(d, _)| *labels.entry(d.label).or_default() += 1);
            let (label, _) = labels.into_iter().max_by_key(|(_, count)| *count)?;
            let usual = detector.labels().name(label).unwrap_or("?");
            let remedy = match &detector.source {
                DetectionSource::Outside(_) => {
                    " (--first-label 0 where they count from 0, --categories for other names)"
                }
                _ => "",
            };
            return Some(format!(
                "{name} gives no detection the label of the model, and most often “{usual}”: do the numbers of its classes mean what its labels say?{remedy}"
            ));
        }
        let overlaps = |(d, truth): (&Detection, &BoxPx)| counts(d) && d.box_px.iou(truth) >= MATCH_IOU;
        (!found().any(overlaps)).then(|| {
            format!(
                "no box of {name} overlaps a truth box by {MATCH_IOU} in any of {}: are its boxes in pixels of the whole, upright photo?",
                spelling::count(photos.len(), "photo")
            )
        })
    };
    detectors.iter().enumerate().filter_map(of).collect()
}

/// Warns of a missing random pattern: any print changes detections; only a random one shows what the optimised one adds.
fn no_random(photos: &[ScoredPhoto], base: &str, control: Option<&str>) -> Option<String> {
    let variants = photos.iter().map(|p| p.variant.as_str());
    let others: BTreeSet<&str> = variants.filter(|v| *v != base && Some(*v) != control).collect();
    let is_control = |variant: &&str| is_control(variant);
    let lacks = !others.is_empty() && !is_control(&base) && !others.iter().any(is_control);
    lacks.then(|| {
        "no variant is a random control (by its name): a drop may come from any print of such colours, and not from this pattern".to_owned()
    })
}

/// Warns of truth boxes around the model's size, which are looser than its outline, and so than a detector's box.
fn loose_boxes(photos: &[ScoredPhoto], sessions: &[Session]) -> Option<String> {
    let is_loose = |p: &ScoredPhoto| {
        let envelope = sessions.get(p.session).map(|s| &s.scene.model.envelope);
        !p.truth_given && matches!(envelope, Some(Envelope::Box))
    };
    let count = photos.iter().filter(|p| is_loose(p)).count();
    (count > 0).then(|| {
        format!(
            "{} drawn around the model's size, looser than its outline, so that good detections may stay below an IoU; a mesh or hull \
             as the scene's truth is tighter",
            spelling::choose(count, "1 truth box is", &format!("{count} truth boxes are"))
        )
    })
}

/// Warns of identical photos that are named for two textures, places or conditions; copies within a texture count once.
fn copies(photos: &[ScoredPhoto]) -> Option<String> {
    let mut copies = identical_photos(photos);
    let (first, copy) = copies.next()?;
    let count = 1 + copies.count();
    Some(format!(
        "{}, named for another texture, place or condition (the first: {} of {}): which of them is right?",
        are_copies(count),
        copy.file,
        first.file
    ))
}

/// Warns of photos that repeat an earlier one under another place or texture, and so are evidence of neither. Copies byte for byte have a sentence of
/// their own.
fn repeats(photos: &[ScoredPhoto]) -> Option<String> {
    let identical: BTreeSet<u64> = identical_photos(photos).map(|(_, copy)| copy.id).collect();
    let others = photos.iter().filter(|photo| !identical.contains(&photo.id));
    let all: Vec<_> = others
        .filter_map(|photo| Some((photo, photo.repeat_of.as_ref()?)))
        .collect();
    let (photo, first) = all.first()?;
    Some(format!(
        "{} an earlier photo shows, named for another place, direction or texture (the first: {} of {first}): what is found must stand without",
        spelling::choose(
            all.len(),
            "1 photo shows what",
            &format!("{} photos show what", all.len())
        ),
        photo.file
    ))
}

/// Warns of textures that were not photographed from the same directions: their drop mixes texture with direction.
fn uneven_directions(photos: &[ScoredPhoto], base_variant: &str) -> Vec<String> {
    let mut counts: BTreeMap<&str, BTreeMap<i64, usize>> = BTreeMap::new();
    for photo in photos {
        let bin = photo.bin.map_or(-1, |b| thousandths(b.azimuth_deg));
        *counts.entry(&photo.variant).or_default().entry(bin).or_default() += 1;
    }
    let Some(base) = counts.get(base_variant) else {
        return Vec::new();
    };
    let others = counts
        .iter()
        .filter(|(variant, bins)| **variant != base_variant && *bins != base);
    others
        .map(|(variant, bins)| {
            let all: BTreeSet<&i64> = base.keys().chain(bins.keys()).collect();
            let uneven = all.iter().filter(|bin| base.get(**bin) != bins.get(**bin)).count();
            format!(
                "“{variant}” and “{base_variant}” have different numbers of photos in {uneven} of {} directions: the drop over all photos \
                 mixes texture with direction; go by the figures of each direction, or by `compare`, which pairs the photos",
                all.len()
            )
        })
        .collect()
}

/// Warns of near-copies, such as re-encodings and frames of one moment, which count once.
fn counted_once(photos: &[ScoredPhoto], not_scored: &[NotScored]) -> Option<String> {
    let mut copies = not_scored
        .iter()
        .filter_map(|p| Some((&p.file, p.near_copy_of.as_ref()?)));
    let (file, first) = copies.next()?;
    let count = 1 + copies.count();
    Some(format!(
        "{} of another (the first: {file} of {first}): each is counted with it, once, so that {} of {} count",
        spelling::choose(
            count,
            "1 photo is a near-copy",
            &format!("{count} photos are near-copies")
        ),
        photos.len(),
        photos.len() + count
    ))
}

fn left_out(not_scored: &[NotScored]) -> Option<String> {
    let count = not_scored.iter().filter(|photo| photo.near_copy_of.is_none()).count();
    let sentence = match count {
        1 => "1 photo could not be scored and is in no figure; it is listed with its reason".to_owned(),
        _ => format!("{count} photos could not be scored and are in no figure; they are listed with their reasons"),
    };
    (count > 0).then_some(sentence)
}

/// Warns of detectors that lack some of the labels that count, and so have fewer ways to find the model.
fn unknown_classes(sessions: &[Session], detectors: &[EvaluatedDetector]) -> Vec<String> {
    let Some(classes) = sessions.first().map(|s| &s.scene.model.class) else {
        return Vec::new();
    };
    let unknown = detectors.iter().filter_map(|c| {
        let unknown = c.manifest.unknown_classes(classes.labels());
        let quoted: Vec<String> = unknown.iter().map(|label| format!("`{label}`")).collect();
        let name = &c.manifest.name;
        (!quoted.is_empty()).then(|| {
            format!(
                "{name} has no label {}, so that it finds the model by the others only",
                quoted.join(" or ")
            )
        })
    });
    unknown.collect()
}

fn several_models(sessions: &[Session]) -> Option<String> {
    let models = sessions.iter().map(|s| &s.scene.model);
    let models: BTreeSet<String> = models
        .map(|m| format!("{} (1:{}, {:?} mm)", m.name, m.scale, m.size_mm))
        .collect();
    let list = models.iter().cloned().collect::<Vec<_>>().join(", ");
    (models.len() > 1).then(|| format!("the sessions show different models, pooled in every figure: {list}"))
}

/// Warns of truth boxes of several kinds: one around the model's size is larger than one around its outline, and is matched less easily.
fn several_truths(photos: &[ScoredPhoto], sessions: &[Session]) -> Option<String> {
    let source = |p: &ScoredPhoto| {
        if p.truth_given {
            Some("given by the session")
        } else {
            sessions.get(p.session).map(|s| s.scene.model.envelope.name())
        }
    };
    let sources: BTreeSet<&str> = photos.iter().filter_map(source).collect();
    let list = sources.iter().copied().collect::<Vec<_>>().join(", ");
    (sources.len() > 1).then(|| {
        format!("truth boxes of several kinds are pooled in every figure ({list}), and detections match some kinds more easily than others")
    })
}

/// Returns the photos that were placed by the camera of their session, with the session.
fn placed_by_camera<'a>(
    photos: &'a [ScoredPhoto],
    sessions: &'a [Session],
) -> impl Iterator<Item = (&'a ScoredPhoto, &'a Session)> {
    let placed = photos.iter().filter(|p| p.rms_px.is_some());
    placed.filter_map(|p| Some((p, sessions.get(p.session)?)))
}

/// Warns of meshes that lie otherwise than the scene says, which give truth boxes of a turned model.
fn turned_meshes(sessions: &[Session]) -> BTreeSet<String> {
    let meshes = sessions
        .iter()
        .filter_map(|s| Some((s.mesh_path.as_deref()?, &s.scene.model)));
    meshes
        .filter_map(|(mesh, model)| envelope::lies_otherwise(mesh, model))
        .collect()
}

fn guessed_cameras(photos: &[ScoredPhoto], sessions: &[Session]) -> BTreeSet<String> {
    let guessed = placed_by_camera(photos, sessions).filter_map(|(_, s)| Some((s, s.camera.as_ref()?.guess?)));
    guessed
        .map(|(s, guess)| format!("{}: {}", s.name, guess.caution()))
        .collect()
}

/// Warns of photos of another size than the camera file's: each was taken for the whole photo, made smaller or larger.
fn other_sizes(photos: &[ScoredPhoto], sessions: &[Session]) -> Option<String> {
    let is_other = |p: &ScoredPhoto, s: &Session| {
        let own = s.camera.as_ref().map(|c| [c.width, c.height]);
        own.is_some_and(|own| own != [p.width, p.height] && own != [p.height, p.width])
    };
    let count = placed_by_camera(photos, sessions)
        .filter(|(p, s)| is_other(p, s))
        .count();
    (count > 0).then(|| {
        format!(
            "{} another size than {} camera file, which was scaled for {}: right for photos made smaller or larger as a whole, wrong for \
             photos cut out of larger ones",
            spelling::choose(count, "1 photo has", &format!("{count} photos have")),
            spelling::choose(count, "its", "their"),
            spelling::choose(count, "it", "them")
        )
    })
}
