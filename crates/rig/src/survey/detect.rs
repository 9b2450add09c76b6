//! The tags in the photos of a survey, all in the frame of one camera file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::workers;
use scaleproof_photo::{Photo, PhotoError};
use scaleproof_pose::camera::{Camera, FittedCamera};
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_pose::tags::{AprilTagC, SeenTag, StartError, TagDetector};

/// Tags found in one photo.
#[derive(Debug, Clone)]
pub struct PhotoTags {
    /// File name of the photo.
    pub name: String,
    /// Tags with corners in the image that the camera file is for, px.
    pub seen: Vec<SeenTag>,
}

/// Reason why the tags of a photo are not known.
#[derive(Debug, thiserror::Error)]
pub enum SurveyPhotoError {
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// Tags of all photos of a survey.
#[derive(Debug)]
pub struct SurveyPhotos {
    /// Tags of each photo, in the order of the photos.
    pub photos: Vec<PhotoTags>,
    /// Cautions about a survey from these photos, as sentences.
    pub cautions: Vec<String>,
}

/// Finds the tags of the scene's families and of `family` in every photo.
///
/// A survey has one camera. A photo that EXIF turned, or that was made smaller, is fitted as any photo, and its corners are moved back
/// into the image that the camera file is for.
pub fn detect_tags(
    photos: &[PathBuf],
    scene: &Scene,
    family: TagFamily,
    camera: &Camera,
    on_done: impl Fn() + Sync,
) -> Result<SurveyPhotos, SurveyPhotoError> {
    let mut families = scene.families();
    if !families.contains(&family) {
        families.push(family);
    }
    let found = workers::map(
        photos,
        || Ok(AprilTagC::new(&families)?),
        |detector, path| detect_in(path, camera, detector),
        on_done,
    )?;
    for (i, (hash, ..)) in found.iter().enumerate() {
        if let Some(first) = found[..i].iter().position(|(other, ..)| other == hash) {
            let (photo, first) = (photos[i].display(), photos[first].display());
            bail!("{photo} is the same photo as {first}, which would count twice: give it once");
        }
    }
    let mut scaled: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for (_, tags, fitted) in &found {
        if let Some(caution) = fitted.scaled_caution() {
            scaled.entry(caution).or_default().push(&tags.name);
        }
    }
    let scaled = scaled.into_iter();
    let cautions = scaled.map(|(caution, names)| format!("{}: {caution}", names.join(", ")));
    Ok(SurveyPhotos {
        cautions: cautions.chain(camera.guess.map(|guess| guess.caution())).collect(),
        photos: found.into_iter().map(|(_, tags, _)| tags).collect(),
    })
}

/// Returns a photo's hash and tags, and the camera that fits it.
fn detect_in(
    path: &Path,
    camera: &Camera,
    detector: &mut AprilTagC,
) -> Result<(String, PhotoTags, FittedCamera), SurveyPhotoError> {
    let photo = Photo::open(path)?;
    let luma = photo.luma()?;
    let fitted = camera.for_photo(luma.width(), luma.height(), photo.turned_deg);
    let fitted = fitted.map_err(|reason| message!("{}: {reason}", path.display()))?;
    let in_file = |tag: SeenTag| SeenTag {
        corners_px: tag.corners_px.map(|px| camera.unfitted_px(&fitted, px)),
        ..tag
    };
    let tags = PhotoTags {
        name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        seen: detector.find(&luma).into_iter().map(in_file).collect(),
    };
    Ok((photo.sha256, tags, fitted))
}
