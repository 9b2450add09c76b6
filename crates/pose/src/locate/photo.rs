//! Pipeline from a photo to its pose: decode its luma, find tags, fit the camera to the photo, locate.

use super::plain_view::still_missing;
use super::{Abstention, Located, locate};
use crate::camera::{Camera, FittedCamera, SizeError};
use crate::scene::Scene;
use crate::tags::{HOPELESS_BLUR_PX, SeenTag, TagDetector, limit_scale, sharpest_edges_px};
use scaleproof_core::geometry::Rigid;
use scaleproof_photo::{Luma, Photo, PhotoError};

/// Result of locating one photo.
#[derive(Debug, Clone)]
pub struct LocatedPhoto {
    /// All tags that were found, including those that the scene lacks.
    pub seen: Vec<SeenTag>,
    /// The camera fitted to this photo, or the reason why it does not fit.
    pub fitted: Result<FittedCamera, SizeError>,
    /// The pose, or the reason for abstaining.
    pub result: Result<Located, Abstention>,
}

/// Finds the tags in a photo and locates its camera; `camera` is the camera file's, `tags` detects the scene's families.
///
/// # Errors
/// A photo that cannot be decoded. A photo without a pose is no error.
pub fn locate_photo(
    photo: &Photo,
    scene: &Scene,
    camera: &Camera,
    tags: &mut dyn TagDetector,
) -> Result<LocatedPhoto, PhotoError> {
    let luma = photo.luma_where_seen()?;
    Ok(locate_luma(luma.as_ref(), photo.turned_deg, None, scene, camera, tags))
}

/// Finds the tags in upright luma, which EXIF turned by `turned_deg`, and locates its camera: for frames that are no files. With a guess of the pose,
/// `T_camera_model`, tags are first searched at their predicted positions.
pub fn locate_luma(
    luma: &dyn Luma,
    turned_deg: u32,
    guess: Option<&Rigid>,
    scene: &Scene,
    camera: &Camera,
    tags: &mut dyn TagDetector,
) -> LocatedPhoto {
    let [width, height] = luma.size();
    let Ok(fitted) = camera.for_photo(width, height, turned_deg) else {
        return locate_tags(tags.find(luma), (width, height), turned_deg, scene, camera);
    };
    let mut answered = None;
    let seen = tags.find_until(luma, &mut |seen| {
        let result = locate(seen, scene, &fitted.camera);
        let missing = still_missing(&result, guess, seen, scene, &fitted.camera);
        answered = Some((seen.to_vec(), result));
        missing
    });
    let result = match answered {
        Some((of, result)) if of == seen => result,
        _ => locate(&seen, scene, &fitted.camera),
    };
    let result = result.map_err(|why| match &why {
        Abstention::NoTags | Abstention::OneTagCovered { .. } => {
            blur_px(luma).map_or(why, |blur_px| Abstention::Blurred { blur_px })
        }
        _ => why,
    });
    LocatedPhoto {
        seen,
        fitted: Ok(fitted),
        result,
    }
}

/// Returns the blur (σ, px) of an image that has no sharp edge in one of both directions: motion keeps edges parallel to it sharp.
fn blur_px(luma: &dyn Luma) -> Option<f64> {
    let limit = HOPELESS_BLUR_PX * limit_scale(luma.size());
    let [across, along] = sharpest_edges_px(luma.whole());
    let blur_px = across?.max(along?);
    (blur_px > limit).then_some(blur_px)
}

/// Locates the camera by the tags found in an upright photo of a width and height, px, which EXIF turned by `turned_deg`.
pub fn locate_tags(
    seen: Vec<SeenTag>,
    (width, height): (u32, u32),
    turned_deg: u32,
    scene: &Scene,
    camera: &Camera,
) -> LocatedPhoto {
    let fitted = camera.for_photo(width, height, turned_deg);
    let result = match &fitted {
        Ok(fitted) => locate(&seen, scene, &fitted.camera),
        Err(e) => Err(Abstention::from(e.clone())),
    };
    LocatedPhoto { seen, fitted, result }
}

impl LocatedPhoto {
    /// Returns the pose and the camera that projects into this photo.
    pub fn pose_and_camera(self) -> Result<(Located, FittedCamera), Abstention> {
        let fitted = self.fitted?;
        Ok((self.result?, fitted))
    }
}
