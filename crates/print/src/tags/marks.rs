//! Images of tags, captions and the width of lines on cards, mats and plans.

use super::error::{MIN_MODULE_MM, TagPrintError};
use crate::media::Media;
use crate::template::making;
use scaleproof_plot::lettering::number;
use scaleproof_pose::scene::{Scene, Tag};
use scaleproof_pose::tags::TagImage;

/// Width of cut and fold lines.
pub const LINE_MM: f64 = 0.2;

pub fn image_of(tag: &Tag) -> Result<TagImage, TagPrintError> {
    let image = TagImage::new(tag.family, tag.id).ok_or(TagPrintError::NoImage {
        family: tag.family.name(),
        id: tag.id,
    })?;
    let module_mm = tag.size_mm / image.border_modules() as f64;
    if module_mm < MIN_MODULE_MM {
        return Err(TagPrintError::ModuleTooSmall { id: tag.id, module_mm });
    }
    Ok(image)
}

/// Returns the lines at the foot of every page.
pub fn captions(scene: &Scene, media: Media, how_to: [&str; 2]) -> Vec<String> {
    let (name, scale) = (&scene.model.name, number(scene.model.scale));
    let making = format!("scene {name} · scale 1:{scale} · {}", making(&media));
    let check = "Print at 100 % (no fit to page): both rulers must measure 100 mm.";
    [check, how_to[0], how_to[1], &making].map(str::to_owned).to_vec()
}
