//! The one cause why the frames of a walk have no pose, where there is one.

use std::path::Path;

use crate::look::{Look, Unplaced};
use crate::walk::Walk;
use scaleproof_photo as photo;
use scaleproof_photo::{Budget, Photo};
use scaleproof_pose::locate::diagnosis::{OtherLooks, diagnose};
use scaleproof_pose::locate::{LocatedPhoto, locate_photo};
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_video::Selection;

/// So many frames with tags and without a pose are looked at as photos.
const FRAMES: usize = 8;

/// As a sentence that names the files; `None` where there is no one cause, or the frames cannot be decoded again.
pub fn cause(walk: &Walk, looks: &[Look], [scene_file, camera_file]: [&Path; 2]) -> Option<String> {
    let unsure = looks.iter().filter(|look| look.shows == Err(Unplaced::Unsure));
    let numbers: Vec<u64> = unsure.map(|look| look.number).collect();
    let step = numbers.len().div_ceil(FRAMES).max(1);
    let numbers: Vec<u64> = numbers.into_iter().step_by(step).collect();
    let selection = Selection {
        numbers: (!numbers.is_empty()).then_some(numbers),
        is_whole: false,
        ..Selection::default()
    };
    selection.numbers.as_ref()?;
    let mut tags = TagDetectorChoice::default().open(&walk.scene.families()).ok()?;
    let mut located = |image| -> Option<LocatedPhoto> {
        let png = photo::sensor_png(&image, walk.video.turned_deg)?;
        let photo = Photo::from_bytes(Path::new(&walk.name), png, Budget::FILE).ok()?;
        locate_photo(&photo, &walk.scene, &walk.camera, tags.as_mut()).ok()
    };
    let frames = walk.video.rgb(&selection).ok()?.flatten();
    let photos: Vec<LocatedPhoto> = frames.filter_map(|frame| located(frame.image)).collect();
    let photos: Vec<&LocatedPhoto> = photos.iter().collect();
    let cause = diagnose(&photos, &OtherLooks::default(), &walk.scene)?;
    Some(cause.sentence(&walk.scene, scene_file, &walk.camera, camera_file))
}
