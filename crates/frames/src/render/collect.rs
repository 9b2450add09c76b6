//! Frames from the values that the script writes: float32 values become PNG files, each whole under its name or absent.

use std::path::{Path, PathBuf};

use image::{GrayImage, RgbImage};

use super::plan::{LINEAR_MAX, Missing, RenderPlan};
use crate::{FramesError, encode_grey, encode_linear, encode_positions, encode_rgb, light};
use scaleproof_core::files;
use scaleproof_core::message::ensure;

pub(super) struct Collector<'a> {
    pub plan: &'a RenderPlan,
    /// The folder of the frames; Blender writes its values to the work folder in it.
    pub folder: &'a Path,
}

impl Collector<'_> {
    /// Lists the frames and views without their files. A file is there only when it is whole: all are written under another name first.
    pub(super) fn missing(&self) -> Missing {
        let mut missing = self.plan.everything();
        let lacks_any = |files: &[PathBuf]| files.iter().any(|file| !file.is_file());
        let Missing { frames, viewpoints } = &mut missing;
        frames.retain(|frame| lacks_any(&self.frame_files(&self.plan.frame_name(frame))));
        viewpoints.retain(|v| lacks_any(&self.view_files(&self.plan.view_name(*v))));
        missing
    }

    fn frame_files(&self, name: &str) -> [PathBuf; 2] {
        ["rgb", "linear"].map(|kind| self.folder.join(format!("{kind}/{name}.png")))
    }

    fn view_files(&self, name: &str) -> [PathBuf; 4] {
        ["object", "paint", "positions", "sides"].map(|kind| self.folder.join(format!("views/{name}_{kind}.png")))
    }

    pub(super) fn save_frame(&self, name: &str) -> Result<(), FramesError> {
        let size = self.plan.request().size_px;
        let linear = triples(self.folder, &format!("{name}.rgb"), size)?;
        let [rgb_file, linear_file] = self.frame_files(name);
        files::replace_all_atomically(
            self.folder,
            &[
                (linear_file, encode_linear(&linear, size, LINEAR_MAX)?),
                (rgb_file, encode_rgb(&srgb(&linear, size))?),
            ],
        )?;
        Ok(())
    }

    pub(super) fn save_geometry(&self, view: &str) -> Result<(), FramesError> {
        let request = self.plan.request();
        let (size, fine) = (request.size_px, request.size_px.map(|px| px * request.factor));
        let grey = |kind: &str, size: [u32; 2], most: f32, scale: f32| -> Result<Vec<u8>, FramesError> {
            let shares = values(self.folder, &format!("{view}.{kind}"), size, 1)?;
            let levels = shares.iter().map(|v| (scale * v).round().clamp(0.0, most) as u8);
            let image = GrayImage::from_raw(size[0], size[1], levels.collect()).unwrap_or_default();
            encode_grey(&image)
        };
        let places = triples(self.folder, &format!("{view}.position"), fine)?;
        let places = places.iter().map(|p| p.map(f64::from));
        let contents = [
            grey("object", size, 255.0, 255.0)?,
            grey("paint", size, 255.0, 255.0)?,
            encode_positions(places, fine, &self.plan.positions())?,
            grey("side", fine, 6.0, 1.0)?,
        ];
        let whole: Vec<_> = self.view_files(view).into_iter().zip(contents).collect();
        Ok(files::replace_all_atomically(self.folder, &whole)?)
    }
}

/// Reads a raw image that Blender wrote for a folder (linear light, row by row) and removes the file.
pub fn triples(folder: &Path, name: &str, size: [u32; 2]) -> Result<Vec<[f32; 3]>, FramesError> {
    Ok(values(folder, name, size, 3)?.as_chunks::<3>().0.to_vec())
}

/// Reads the values of a raw image and removes the file.
fn values(folder: &Path, name: &str, size: [u32; 2], channels: usize) -> Result<Vec<f32>, FramesError> {
    let path = super::blender::work_folder(folder).join(format!("{name}.f32"));
    files::inputs::own(&path);
    let bytes = files::read(&path)?;
    let (found, wanted) = (bytes.len(), size[0] as usize * size[1] as usize * channels * 4);
    ensure!(
        found == wanted,
        "Blender made {} with {found} bytes instead of {wanted}; run the command again",
        path.display()
    );
    files::chosen::remove(folder, &path)?;
    let values = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b));
    // What is no number would be black in one place and white in another.
    Ok(values.map(|v| if v.is_finite() { v } else { 0.0 }).collect())
}

/// Converts linear light to the 8-bit sRGB image that a detector gets.
pub fn srgb(linear: &[[f32; 3]], size: [u32; 2]) -> RgbImage {
    let pixels = linear.iter().flat_map(|p| light::rgb_of(p.map(f64::from))).collect();
    RgbImage::from_raw(size[0], size[1], pixels).unwrap_or_default()
}
