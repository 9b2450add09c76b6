//! Frames from what the script leaves: float32 values become PNG files, each whole under its name or absent.

use std::path::{Path, PathBuf};

use image::{GrayImage, RgbImage};

use super::RenderError;
use super::plan::{Missing, PlannedFrame, RenderPlan};
use crate::frames::{encode_grey, encode_linear, encode_positions, encode_rgb, light};
use scaleproof_core::files;

/// Puts images into the folder of a plan.
pub(super) struct Collector<'a> {
    plan: &'a RenderPlan,
    folder: &'a Path,
    raw: &'a Path,
}

impl<'a> Collector<'a> {
    pub(super) fn new(plan: &'a RenderPlan, folder: &'a Path, raw: &'a Path) -> Self {
        Self { plan, folder, raw }
    }

    /// A file is there only when it is whole: all are written under another name first.
    pub(super) fn missing(&self) -> Missing {
        let list = self.plan.frames();
        let lacks = |frame: &PlannedFrame| {
            self.frame_files(&self.plan.frame_name(frame))
                .iter()
                .any(|f| !f.is_file())
        };
        let mut viewpoints: Vec<usize> = list.iter().map(|f| f.viewpoint).collect();
        viewpoints.sort_unstable();
        viewpoints.dedup();
        viewpoints.retain(|v| self.view_files(&self.plan.view_name(*v)).iter().any(|f| !f.is_file()));
        Missing {
            frames: list.into_iter().filter(lacks).collect(),
            viewpoints,
        }
    }

    fn frame_files(&self, name: &str) -> [PathBuf; 2] {
        ["rgb", "linear"].map(|kind| self.folder.join(format!("{kind}/{name}.png")))
    }

    fn view_files(&self, name: &str) -> [PathBuf; 4] {
        ["object", "paint", "positions", "sides"].map(|kind| self.folder.join(format!("views/{name}_{kind}.png")))
    }

    pub(super) fn take_frame(&self, name: &str) -> Result<(), RenderError> {
        let size = self.plan.size_px();
        let linear = self.triples(&format!("{name}.rgb"), size)?;
        let rgb = srgb(&linear, size);
        let [rgb_file, linear_file] = self.frame_files(name);
        files::replace_all_atomically(&[
            (linear_file, encode_linear(&linear, size, self.plan.linear_max())?),
            (rgb_file, encode_rgb(&rgb)?),
        ])?;
        Ok(())
    }

    pub(super) fn take_geometry(&self, view: &str) -> Result<(), RenderError> {
        let size = self.plan.size_px();
        let fine = size.map(|px| px * self.plan.factor());
        let grey = |size: [u32; 2], levels: Vec<u8>| GrayImage::from_raw(size[0], size[1], levels).unwrap_or_default();
        let coverage = |kind: &str| -> Result<Vec<u8>, RenderError> {
            let shares = self.values(&format!("{view}.{kind}"), size, 1)?;
            let levels = shares.iter().map(|v| (255.0 * v).round().clamp(0.0, 255.0) as u8);
            Ok(encode_grey(&grey(size, levels.collect()))?)
        };
        let sides: Vec<u8> = self
            .values(&format!("{view}.side"), fine, 1)?
            .iter()
            .map(|v| v.round().clamp(0.0, 6.0) as u8)
            .collect();
        let places = self.triples(&format!("{view}.position"), fine)?;
        let places = places.iter().map(|p| p.map(f64::from));
        let positions = encode_positions(places, fine, self.plan.position_box_mm())?;
        let contents = [
            coverage("object")?,
            coverage("paint")?,
            positions,
            encode_grey(&grey(fine, sides))?,
        ];
        let whole: Vec<_> = self.view_files(view).into_iter().zip(contents).collect();
        files::replace_all_atomically(&whole)?;
        Ok(())
    }

    fn triples(&self, name: &str, size: [u32; 2]) -> Result<Vec<[f32; 3]>, RenderError> {
        triples(self.raw, name, size)
    }

    fn values(&self, name: &str, size: [u32; 2], channels: usize) -> Result<Vec<f32>, RenderError> {
        values(self.raw, name, size, channels)
    }
}

/// The pixels of a raw image in linear light, row by row; the file is then removed.
pub fn triples(raw: &Path, name: &str, size: [u32; 2]) -> Result<Vec<[f32; 3]>, RenderError> {
    Ok(values(raw, name, size, 3)?.as_chunks::<3>().0.to_vec())
}

/// The values of a raw image, which is then removed.
fn values(raw: &Path, name: &str, size: [u32; 2], channels: usize) -> Result<Vec<f32>, RenderError> {
    let path = raw.join(format!("{name}.f32"));
    let bytes = files::read(&path)?;
    let wanted = size[0] as usize * size[1] as usize * channels * 4;
    if bytes.len() != wanted {
        return Err(RenderError::Torn {
            path,
            found: bytes.len(),
            wanted,
        });
    }
    files::remove(&path)?;
    let values = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b));
    // What is no number would be black in one place and white in another.
    Ok(values.map(|v| if v.is_finite() { v } else { 0.0 }).collect())
}

/// Linear light as the 8-bit sRGB image that a detector gets.
pub fn srgb(linear: &[[f32; 3]], size: [u32; 2]) -> RgbImage {
    let pixels = linear.iter().flat_map(|p| light::rgb_of(p.map(f64::from))).collect();
    RgbImage::from_raw(size[0], size[1], pixels).unwrap_or_default()
}
