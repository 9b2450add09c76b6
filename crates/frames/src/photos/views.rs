//! Photos of one place and bin, one in each colour, become a view; or the reason why not.

use nalgebra::Point3;

use super::exposure;
use super::located::{FlatPhoto, LeftOutPhoto};
use crate::light;
use scaleproof_core::message::{Message, bail, ensure, message};
use scaleproof_pose::scene::Bin;

/// Largest angle between two cameras of a view, as the target sees them: gloss and what is hidden change with it.
const MOST_TURN_DEG: f64 = 6.0;
/// Largest difference of distances to the target within a view.
const MOST_CLOSER_PERCENT: f64 = 15.0;

/// Photo of a view with the way to the reference's exposure.
#[derive(Debug, Clone)]
pub struct Other<'a> {
    pub photo: &'a FlatPhoto,
    /// Factor of each channel's linear light.
    pub gain: [f64; 3],
    pub turn_deg: f64,
}

#[derive(Debug, Clone)]
pub struct PhotosOfView<'a> {
    pub reference: &'a FlatPhoto,
    pub others: Vec<Other<'a>>,
}

/// Groups photos to views, in the order of their place and bin, and lists the groups that make none. A view has every colour.
pub fn views<'a>(
    photos: &'a [FlatPhoto],
    flats: &[[u8; 3]],
    target_mm: Point3<f64>,
) -> (Vec<PhotosOfView<'a>>, Vec<LeftOutPhoto>) {
    let mut groups: std::collections::BTreeMap<(&str, Bin), Vec<&FlatPhoto>> = std::collections::BTreeMap::new();
    for photo in photos {
        groups.entry((&photo.place, photo.bin)).or_default().push(photo);
    }
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for group in groups.values() {
        match best(group, flats, target_mm) {
            Ok(view) => found.push(view),
            Err(reason) => left_out.push(LeftOutPhoto::new(group[0].view_name(), reason)),
        }
    }
    (found, left_out)
}

/// Makes a view of a group, with the most central photo that has all others near it as the reference; fails with the reason.
fn best<'a>(group: &[&'a FlatPhoto], flats: &[[u8; 3]], target_mm: Point3<f64>) -> Result<PhotosOfView<'a>, Message> {
    if let Some(rgb) = flats.iter().find(|rgb| !group.iter().any(|s| s.flat_rgb == **rgb)) {
        let colour = light::to_hex(*rgb);
        bail!("it has no located photo in {colour}: take one, or leave the colour out");
    }
    let mut candidates: Vec<(f64, &FlatPhoto, Vec<&FlatPhoto>)> = Vec::new();
    for reference in group {
        let others = nearest(group, reference, flats, target_mm);
        let turns = others.iter().map(|s| turn_deg(s, reference, target_mm));
        candidates.push((turns.fold(0.0, f64::max), reference, others));
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut first_reason = None;
    for (_, reference, others) in candidates {
        match matched(reference, &others, target_mm) {
            Ok(view) => return Ok(view),
            Err(reason) => first_reason = first_reason.or(Some(reason)),
        }
    }
    // There is a photo of every colour, so there was a candidate.
    Err(first_reason.unwrap_or_else(|| message!("")))
}

/// Finds the photo of every other colour that was taken nearest to the reference, in the order of the colours.
fn nearest<'a>(
    group: &[&'a FlatPhoto],
    reference: &FlatPhoto,
    flats: &[[u8; 3]],
    target_mm: Point3<f64>,
) -> Vec<&'a FlatPhoto> {
    let others = flats.iter().filter(|rgb| **rgb != reference.flat_rgb);
    others
        .filter_map(|rgb| {
            let of_colour = group.iter().filter(|s| s.flat_rgb == *rgb);
            let turn = |s: &FlatPhoto| turn_deg(s, reference, target_mm);
            of_colour.min_by(|a, b| turn(a).total_cmp(&turn(b))).copied()
        })
        .collect()
}

fn matched<'a>(
    reference: &'a FlatPhoto,
    others: &[&'a FlatPhoto],
    target_mm: Point3<f64>,
) -> Result<PhotosOfView<'a>, Message> {
    let with_gain = |photo: &&'a FlatPhoto| {
        let (name, to) = (photo.name(), reference.name());
        let turn_deg = turn_deg(photo, reference, target_mm);
        ensure!(
            turn_deg <= MOST_TURN_DEG,
            "{name} was taken {turn_deg:.1}° aside from {to}, and {MOST_TURN_DEG}° is the most: take it nearer to there"
        );
        let (a, b) = (photo.from(target_mm).norm(), reference.from(target_mm).norm());
        let percent = 100.0 * (a.max(b) / a.min(b) - 1.0);
        ensure!(
            percent <= MOST_CLOSER_PERCENT,
            "{name} was taken {percent:.0} % nearer or further than {to}, and {MOST_CLOSER_PERCENT} % is the most: take it again"
        );
        let gain = exposure::gain(photo, reference).map_err(|reason| message!("{name}: {reason}"))?;
        Ok(Other { photo, gain, turn_deg })
    };
    let others = others.iter().map(with_gain).collect::<Result<_, Message>>()?;
    Ok(PhotosOfView { reference, others })
}

/// Returns the angle between two cameras, as the target sees them.
fn turn_deg(a: &FlatPhoto, b: &FlatPhoto, target_mm: Point3<f64>) -> f64 {
    a.from(target_mm).angle(&b.from(target_mm)).to_degrees()
}
