//! Further flat colours from a few, without rendering: light adds up.
//!
//! In linear light a pixel is `L(ρ) = Σ aₙ ρⁿ` of the paint's reflectance ρ, channel by channel: a₀ is what never touched the paint, a₁ what
//! touched it once, higher terms what went to and fro between its parts. The polynomial through n colours is a sum of
//! their images with the weights of Lagrange's interpolation, the same for all pixels. This is exact for a diffuse paint under a
//! coat up to the degree n − 1, and holds before clipping only, which is why frames keep linear light.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use image::RgbImage;

use crate::{Frame, FramePaint, FrameSet, FramesError, encode_rgb, light, views};
use scaleproof_core::files;
use scaleproof_core::geometry::extent;
use scaleproof_core::message::bail;

/// Files with their contents, not yet written.
type Files = Vec<(PathBuf, Vec<u8>)>;

/// Images of one view in several flat colours, in linear light.
#[derive(Debug, Clone)]
pub struct Additive {
    /// Reflectance of each image's colour.
    pub colours: Vec<[f64; 3]>,
    images: Vec<Vec<[f32; 3]>>,
}

impl Additive {
    /// Reads the flat-coloured frames of one view. Colours that share a channel's value with an earlier one are left out: the polynomial of
    /// that channel would have no answer.
    pub fn of_view(set: &FrameSet, view: &[&Frame]) -> Result<Self, FramesError> {
        let mut additive = Self {
            colours: Vec::new(),
            images: Vec::new(),
        };
        for frame in view {
            let Some(colour) = frame.flat_rgb().map(light::linear_of) else {
                continue;
            };
            let is_new = |known: &[f64; 3]| (0..3).all(|c| known[c] != colour[c]);
            // More than four interpolate noise.
            if additive.colours.len() < 4
                && additive.colours.iter().all(is_new)
                && let Some(image) = set.linear(frame)?
            {
                additive.colours.push(colour);
                additive.images.push(image);
            }
        }
        let found = additive.colours.len();
        if found < 3 {
            let view = view.first().map(|f| f.name.as_str()).unwrap_or_default();
            bail!(
                "{view} has {found} flat colours in linear light that differ in all three channels, and 3 are needed; render more";
                hint: "three are ‹flat› 000000 808080 ffffff"
            );
        }
        Ok(additive)
    }

    /// Replaces each image by a linear map of it, such as a part or means of its pixels; the colours stay.
    #[must_use]
    pub fn mapped(self, map: impl Fn(&[[f32; 3]]) -> Vec<[f32; 3]>) -> Self {
        Self {
            images: self.images.iter().map(|image| map(image)).collect(),
            colours: self.colours,
        }
    }

    /// Returns the colour that lies at a share (0 to 255 of each channel) between the darkest and the brightest frame's: beyond those the polynomial
    /// extrapolates.
    pub fn between(&self, share: [u8; 3]) -> [u8; 3] {
        std::array::from_fn(|channel| {
            let (low, high) = extent(self.colours.iter().map(|colour| light::encode(colour[channel])));
            let value = low + (high - low) * f64::from(share[channel]) / 255.0;
            (255.0 * value).round() as u8
        })
    }

    /// Computes the view in another flat colour (8-bit sRGB of the reflectance): linear light, row by row.
    pub fn light(&self, rgb: [u8; 3]) -> Vec<[f32; 3]> {
        let at = light::linear_of(rgb);
        let weights: [Vec<f64>; 3] = std::array::from_fn(|channel| {
            let levels: Vec<f64> = self.colours.iter().map(|c| c[channel]).collect();
            lagrange(&levels, at[channel])
        });
        let pixels = self.images.first().map_or(0, Vec::len);
        let sum = |pixel: usize, channel: usize| -> f64 {
            let of_each = self.images.iter().zip(&weights[channel]);
            of_each.map(|(image, w)| w * f64::from(image[pixel][channel])).sum()
        };
        (0..pixels)
            .map(|pixel| std::array::from_fn(|channel| sum(pixel, channel).max(0.0) as f32))
            .collect()
    }

    /// Computes the view in another flat colour (8-bit sRGB of the reflectance), as a frame's 8-bit sRGB pixels, row by row.
    pub fn rgb(&self, rgb: [u8; 3]) -> Vec<[u8; 3]> {
        let linear = self.light(rgb);
        linear.iter().map(|p| light::rgb_of(p.map(f64::from))).collect()
    }
}

/// Makes frames of every view in other flat colours: returns them as files of `output`, and their number.
pub fn recoloured(set: &FrameSet, colours: &[[u8; 3]], output: &Path) -> Result<(Files, usize), FramesError> {
    let mut list = set.list.clone();
    list.frames.clear();
    list.made_by = format!("attack colours (of: {})", set.list.made_by);
    let (mut new, mut copied) = (Files::new(), BTreeSet::new());
    for view in views(&set.list.frames) {
        let additive = Additive::of_view(set, &view)?;
        for (key, file) in view[0].files() {
            if !matches!(key, "rgb" | "linear" | "pattern") && copied.insert(file) {
                let copy = files::read(&set.folder.join(file))?;
                new.push((output.join(file), copy));
            }
        }
        for rgb in colours {
            let name = format!("{:05}_{}", list.frames.len(), light::to_hex(*rgb));
            let frame = Frame {
                rgb: format!("rgb/{name}.png"),
                name,
                linear: None,
                paint: FramePaint::FlatRgb(*rgb),
                ..view[0].clone()
            };
            let pixels = additive.rgb(*rgb).into_iter().flatten().collect();
            let [width, height] = set.list.size_px;
            let image = RgbImage::from_raw(width, height, pixels).unwrap_or_default();
            new.push((output.join(&frame.rgb), encode_rgb(&image)?));
            list.frames.push(frame);
        }
    }
    new.push(list.to_file(output)?);
    Ok((new, list.frames.len()))
}

/// Returns the weights of the values at `levels` in the value at `at` of the polynomial through them.
fn lagrange(levels: &[f64], at: f64) -> Vec<f64> {
    let weight = |i: usize| {
        let others = levels.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, other)| (at - other) / (levels[i] - other)).product()
    };
    (0..levels.len()).map(weight).collect()
}
