//! Common cause why the frames of a walk have no pose, if there is one.

use std::path::Path;

use crate::tracking::{FrameResult, NoPose};
use crate::walk::Walk;
use scaleproof_photo as photo;
use scaleproof_photo::{Budget, Photo};
use scaleproof_pose::locate::diagnosis::{OtherLooks, diagnose};
use scaleproof_pose::locate::{LocatedPhoto, locate_photo};
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_video::Selection;

/// Number of frames with tags and without a pose that are located as photos.
const FRAMES: usize = 8;

/// Finds the cause, as a sentence that names the files; `None` if there is no common one, or the frames cannot be decoded again.
pub fn common_cause(walk: &Walk, looks: &[FrameResult], [scene_file, camera_file]: [&Path; 2]) -> Option<String> {
    let unsure = looks.iter().filter(|look| look.shows == Err(NoPose::Unsure));
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
