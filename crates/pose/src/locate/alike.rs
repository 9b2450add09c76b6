//! Common cause of many photos' failures, reported once instead of a line for each.

use std::path::{Path, PathBuf};

use image::{GrayImage, imageops};

use super::diagnosis::{self, OtherLooks};
use super::{LocatedPhoto, locate_photo, spread};
use crate::camera::Camera;
use crate::scene::{Scene, TagFamily};
use crate::tags::{SeenTag, TagDetector, TagDetectorChoice};
use scaleproof_photo::Photo;

/// Largest number of failed photos that are listed one by one, without a common cause.
pub const MOST_LISTED: usize = 3;

/// Number of photos, spread evenly, that are located again to find the cause if their results were not kept.
const LOOKED_AT: usize = 12;

/// Number of photos that are searched for tags of all families, or mirrored.
const SEARCHED_AGAIN: usize = 4;

pub struct LocateFiles {
    pub scene: Scene,
    pub scene_file: PathBuf,
    pub camera: Camera,
    pub camera_file: PathBuf,
}

impl LocateFiles {
    /// Returns the common cause of examined photos as a sentence, if there is one.
    pub fn cause(&self, photos: &[(&Path, &LocatedPhoto)]) -> Option<String> {
        let (paths, examined): (Vec<&Path>, Vec<&LocatedPhoto>) = photos.iter().copied().unzip();
        let mut others = OtherLooks::default();
        if diagnosis::is_without_tags(&examined) {
            let own = self.scene.families();
            let all = TagFamily::ALL.map(|(family, _)| family).into_iter();
            // The code tables of these two take more than a hundred megabytes each.
            let rare = [TagFamily::TagCircle49h12, TagFamily::TagCustom48h12];
            let all = all.filter(|family| !own.contains(family) && !rare.contains(family));
            others.families = look_again(&paths, all.collect(), |luma| luma);
        }
        if diagnosis::are_bad(&examined) {
            others.mirrored = look_again(&paths, self.scene.families(), |luma| imageops::flip_horizontal(&luma));
        }
        let found = diagnosis::diagnose(&examined, &others, &self.scene)?;
        Some(found.sentence(&self.scene, &self.scene_file, &self.camera, &self.camera_file))
    }

    /// Returns the common cause of photos whose results were not kept, as a sentence, if there is one: some of them are located again.
    pub fn cause_in_files(&self, photos: &[PathBuf]) -> Option<String> {
        let mut tags = TagDetectorChoice::default().open(&self.scene.families()).ok()?;
        let paths = spread(&photos.iter().map(PathBuf::as_path).collect::<Vec<_>>(), LOOKED_AT);
        let examined = paths.into_iter().filter_map(|path| {
            let photo = Photo::open(path).ok()?;
            Some((path, locate_photo(&photo, &self.scene, &self.camera, &mut tags).ok()?))
        });
        let examined: Vec<(&Path, LocatedPhoto)> = examined.collect();
        self.cause(
            &examined
                .iter()
                .map(|(path, examined)| (*path, examined))
                .collect::<Vec<_>>(),
        )
    }
}

/// Detects tags of the given families in some of the photos, after `changed` was applied to their luma.
fn look_again(
    photos: &[&Path],
    families: Vec<TagFamily>,
    changed: impl Fn(GrayImage) -> GrayImage,
) -> Vec<Vec<SeenTag>> {
    let Ok(mut tags) = TagDetectorChoice::default().open(&families) else {
        return Vec::new();
    };
    let luma = |path: &&Path| Some(changed(Photo::open(path).ok()?.luma().ok()?));
    let some = spread(photos, SEARCHED_AGAIN);
    some.iter().filter_map(luma).map(|luma| tags.find(&luma)).collect()
}
