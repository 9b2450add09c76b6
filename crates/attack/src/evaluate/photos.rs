//! Photos of an evaluation: the missing ones, and those that Blender makes, each whole under its name or absent.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use image::DynamicImage;

use crate::AttackError;
use scaleproof_core::files;
use scaleproof_core::message::bail;
use scaleproof_frames::render::{Missing, PlannedFrame, RenderPlan, blender, srgb, stopped, triples};
use scaleproof_frames::{FramesError, encode_rgb};
use scaleproof_photo::{Budget, open_png};
use scaleproof_session::PhotoEntry;

/// Renders the missing photos into `folder`.
pub(super) fn render(
    plan: &RenderPlan,
    photos: &[PhotoEntry],
    folder: &Path,
    python: impl FnOnce() -> Result<blender::Python, FramesError>,
    mut on_photo: impl FnMut(usize),
) -> Result<(), AttackError> {
    let missing = missing(plan, photos, folder)?;
    let wanted = photos.len();
    let mut done = wanted - missing.frames.len();
    on_photo(done);
    if missing.is_empty() {
        return Ok(());
    }
    let python = python()?;
    let size_px = plan.request().size_px;
    let named = |(frame, photo): (&PlannedFrame, &PhotoEntry)| (plan.frame_name(frame), folder.join(&photo.file));
    let places: HashMap<String, PathBuf> = plan.frames().iter().zip(photos).map(named).collect();
    let finished = blender::run(&python, &plan.to_script(&missing, folder), folder, |event| {
        if let blender::BlenderEvent::Frame(name) = event
            && let Some(place) = places.get(&name)
        {
            let image = srgb(&triples(folder, &format!("{name}.rgb"), size_px)?, size_px);
            files::replace_atomically(folder, place, &encode_rgb(&image)?)?;
            done += 1;
            on_photo(done);
        }
        Ok(())
    })?;
    if !finished || done < wanted {
        return Err(stopped(folder, done, wanted).into());
    }
    // Nothing is lost if the work folder stays.
    let _ = files::chosen::remove_folder(folder, &blender::work_folder(folder));
    Ok(())
}

/// Lists the photos that are not there; those that are must be whole.
fn missing(plan: &RenderPlan, photos: &[PhotoEntry], folder: &Path) -> Result<Missing, AttackError> {
    let mut frames: Vec<PlannedFrame> = Vec::new();
    for (frame, photo) in plan.frames().into_iter().zip(photos) {
        let path = folder.join(&photo.file);
        if path.is_file() {
            check(&path, plan.request().size_px)?;
        } else {
            frames.push(frame);
        }
    }
    Ok(Missing {
        frames,
        viewpoints: Vec::new(),
    })
}

fn check(path: &Path, size_px: [u32; 2]) -> Result<(), AttackError> {
    let bytes = files::read(path)?;
    let decoded = open_png(&bytes, &Budget::FILE)
        .map_err(|e| e.to_string())
        .and_then(|decoder| DynamicImage::from_decoder(decoder).map_err(|e| e.to_string()));
    let [width, height] = size_px;
    let reason = match decoded.map(|image| (image.width(), image.height())) {
        Ok(found) if found == (width, height) => return Ok(()),
        Ok(found) => format!("it has {}×{} pixels and not {width}×{height}", found.0, found.1),
        Err(reason) => reason,
    };
    bail!(
        "{} is damaged ({reason}): remove it, and the same command renders it again",
        path.display()
    )
}
