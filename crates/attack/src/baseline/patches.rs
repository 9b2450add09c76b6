//! Finished patches in their places on a model of one colour: the paint of each pixel, from the positions of a frame's paint.

use crate::AttackError;
use crate::run::Rgb;
use crate::run::judge::{HeldOutFigures, judge_images};
use crate::run::view_set::no_positions;
use crate::setup::Setup;
use scaleproof_frames::{Frame, FrameSet, FramesError, SurfacePoint, light};
use scaleproof_surface::texture::PlacedPatch;

/// Returns a patch's reflectance at a point of the surface; `None` beside the patch. The hood is part of the roof's side: both look up.
fn colour(patch: &PlacedPatch, point: &SurfacePoint) -> Option<Rgb> {
    let rgb = patch.colour_at(point.side?, &point.place_mm.into())?;
    Some(light::linear_of(rgb))
}

/// Returns true for a patch of which a frame's paint shows a part; `None` for a frame without positions.
pub fn is_seen(set: &FrameSet, frame: &Frame, patch: &PlacedPatch) -> Result<Option<bool>, FramesError> {
    let points = set.surface(frame)?;
    Ok(points.map(|points| points.iter().any(|point| colour(patch, point).is_some())))
}

/// Finds the first of some patches that no judged view shows: it would be judged as the plain model. A frame without positions may show any.
pub fn first_unseen(setup: &Setup, patches: &[PlacedPatch]) -> Result<Option<usize>, FramesError> {
    for (i, patch) in patches.iter().enumerate() {
        let mut is_shown = false;
        for view in setup.view_set.judged() {
            let frame = &setup.view_set.views[view].frame;
            is_shown |= is_seen(&setup.frames[setup.view_set.set_of(view)], frame, patch)? != Some(false);
        }
        if !is_shown {
            return Ok(Some(i));
        }
    }
    Ok(None)
}

/// Judges patches on a model of one colour (8-bit sRGB) by the views held out.
pub fn judge_patches(setup: &Setup, patches: &[PlacedPatch], base_rgb: [u8; 3]) -> Result<HeldOutFigures, AttackError> {
    let (view_set, frames) = (&setup.view_set, &setup.frames);
    judge_images(view_set, &setup.detectors, |view| {
        let frame = &view_set.views[view].frame;
        let paint = paint(&frames[view_set.set_of(view)], frame, patches, base_rgb)?;
        let paint = paint.ok_or_else(|| no_positions(frame))?;
        Ok(view_set.painted(view, &paint))
    })
}

/// Computes the paint in each pixel of a frame (linear reflectance); later patches lie over earlier ones. `None` for a frame without positions.
pub fn paint(
    set: &FrameSet,
    frame: &Frame,
    patches: &[PlacedPatch],
    base_rgb: [u8; 3],
) -> Result<Option<Vec<Rgb>>, FramesError> {
    let (Some(points), Some(about)) = (set.surface(frame)?, &set.list.positions) else {
        return Ok(None);
    };
    let base = light::linear_of(base_rgb);
    let (factor, [width, height]) = (about.factor as usize, set.list.size_px.map(|px| px as usize));
    let seen_colour = |point: &SurfacePoint| {
        let found = patches.iter().rev().find_map(|patch| colour(patch, point));
        found.unwrap_or(base)
    };
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let parts = (0..factor * factor).map(|i| (x * factor + i % factor, y * factor + i / factor));
        let parts = parts.map(|(x, y)| &points[y * width * factor + x]);
        let seen: Vec<Rgb> = parts.filter(|point| point.side.is_some()).map(seen_colour).collect();
        match seen.len() {
            0 => base,
            count => std::array::from_fn(|c| seen.iter().map(|rgb| rgb[c]).sum::<f64>() / count as f64),
        }
    };
    Ok(Some((0..width * height).map(pixel).collect()))
}
