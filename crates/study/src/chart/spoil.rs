//! Degradations of a photo by a measured amount, from harmless to hopeless.

use std::io::Cursor;

use image::codecs::jpeg::JpegEncoder;
use image::{GrayImage, Luma, imageops};
use rand::{Rng, RngExt};

use scaleproof_core::geometry::extent;
use scaleproof_pose::simulate::normal;
use scaleproof_pose::tags::middle_px;

/// Four corners of a tag in the image, px.
pub(super) type TagCorners = [[f64; 2]; 4];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spoil {
    /// Out of focus: Gaussian blur, σ in px.
    Blur,
    /// The camera moved: mean along a line of this many px, in a random direction.
    Motion,
    /// Normal noise, σ in grey levels of 255.
    Noise,
    /// Too little light (below 0) or too much: stops.
    Exposure,
    /// A lamp lights every tag unevenly: the light at its dark end, as a share of that at its bright end, in a random direction.
    Lamp,
    /// Every tag is covered from a random side by an opaque strip: share of its side.
    Cover,
    /// The photo was cut to this share of its sides, anywhere, and passes as a smaller photo.
    Crop,
    /// JPEG quality.
    Jpeg,
}

impl Spoil {
    /// Returns the degradation of the sweep of this name.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "blur" => Self::Blur,
            "motion_blur" => Self::Motion,
            "noise" => Self::Noise,
            "exposure" => Self::Exposure,
            "lamp" => Self::Lamp,
            "occlusion" => Self::Cover,
            "cropping" => Self::Crop,
            "jpeg_quality" => Self::Jpeg,
            _ => return None,
        })
    }

    /// Returns the photo after the degradation. `tags`: corners of the scene's tags in it.
    pub fn apply(self, photo: &GrayImage, amount: f64, tags: &[TagCorners], rng: &mut impl Rng) -> GrayImage {
        match self {
            Self::Blur if amount > 0.0 => imageops::blur(photo, amount as f32),
            Self::Motion if amount > 0.0 => moved(photo, amount, rng.random_range(0.0..180.0)),
            Self::Noise => each(photo, |value| value + amount * normal(rng)),
            Self::Exposure => {
                // A stop is a factor of two in light; grey levels are taken as light to the power of 1/2.2.
                let gain = 2f64.powf(amount / 2.2);
                each(photo, |value| value * gain)
            }
            Self::Lamp => lit(photo, amount, tags, rng),
            Self::Cover => covered(photo, amount, tags, rng),
            Self::Crop => cropped(photo, amount, rng),
            Self::Jpeg => jpeg(photo, amount as u8),
            Self::Blur | Self::Motion => photo.clone(),
        }
    }
}

fn moved(photo: &GrayImage, length_px: f64, direction_deg: f64) -> GrayImage {
    let (sin, cos) = direction_deg.to_radians().sin_cos();
    let steps = length_px.ceil() as i32;
    let along = (0..=steps).map(|i| length_px * (f64::from(i) / f64::from(steps) - 0.5));
    let offsets = along.map(|t| ((t * cos).round() as i64, (t * sin).round() as i64));
    let offsets: Vec<(i64, i64)> = offsets.collect();
    let (width, height) = (i64::from(photo.width()), i64::from(photo.height()));
    GrayImage::from_fn(photo.width(), photo.height(), |x, y| {
        let at = |(dx, dy): &(i64, i64)| {
            let x = (i64::from(x) + dx).clamp(0, width - 1);
            let y = (i64::from(y) + dy).clamp(0, height - 1);
            u32::from(photo.get_pixel(x as u32, y as u32).0[0])
        };
        Luma([(offsets.iter().map(at).sum::<u32>() / offsets.len() as u32) as u8])
    })
}

/// Maps every grey level by itself.
fn each(photo: &GrayImage, mut level: impl FnMut(f64) -> f64) -> GrayImage {
    let mut out = photo.clone();
    out.iter_mut()
        .for_each(|value| *value = level(f64::from(*value)).round().clamp(0.0, 255.0) as u8);
    out
}

/// Darkens each tag and its margin from one side to the other; grey levels are taken as light to the power of 1/2.2.
fn lit(photo: &GrayImage, share: f64, tags: &[TagCorners], rng: &mut impl Rng) -> GrayImage {
    let mut out = photo.clone();
    for tag in tags {
        let around: f64 = rng.random_range(0.0..std::f64::consts::TAU);
        let along = |[x, y]: [f64; 2]| x * around.cos() + y * around.sin();
        let middle = middle_px(tag);
        let margin = tag.map(|p| [0, 1].map(|k| middle[k] + 1.4 * (p[k] - middle[k])));
        let (from, to) = extent(margin.iter().map(|p| along(*p)));
        inside(&margin, photo.dimensions(), |x, y| {
            let part = (along([f64::from(x), f64::from(y)]) - from) / (to - from);
            let gain = (1.0 - (1.0 - share) * part).powf(1.0 / 2.2);
            let level = &mut out.get_pixel_mut(x, y).0[0];
            *level = (f64::from(*level) * gain).round() as u8;
        });
    }
    out
}

fn covered(photo: &GrayImage, share: f64, tags: &[TagCorners], rng: &mut impl Rng) -> GrayImage {
    let mut out = photo.clone();
    if share <= 0.0 {
        return out;
    }
    for tag in tags {
        let side = rng.random_range(0..4);
        let grey = [0, 110, 255][rng.random_range(0..3)];
        // The strip reaches over the tag's white ring as well: a hand, not a sticker.
        let corner = |i: usize| tag[(side + i) % 4];
        let towards = |from: [f64; 2], to: [f64; 2], t: f64| [0, 1].map(|k| from[k] + t * (to[k] - from[k]));
        let edge = |t: f64| [towards(corner(0), corner(3), t), towards(corner(1), corner(2), t)];
        let ([a, b], [c, d]) = (edge(-0.3), edge(share));
        let strip = [(a, b), (b, a), (d, c), (c, d)].map(|(from, to)| towards(from, to, -0.3));
        fill(&mut out, &strip, grey);
    }
    out
}

/// Paints a convex outline.
fn fill(image: &mut GrayImage, outline: &TagCorners, grey: u8) {
    inside(outline, image.dimensions(), |x, y| image.put_pixel(x, y, Luma([grey])));
}

/// Calls `each` on the pixels of an image of this size inside a convex outline.
fn inside(outline: &TagCorners, (width, height): (u32, u32), mut each: impl FnMut(u32, u32)) {
    let span = |k: usize, size: u32| {
        let (low, high) = extent(outline.iter().map(|p| p[k]));
        (low.floor().max(0.0) as u32)..(high.ceil().clamp(0.0, f64::from(size)) as u32)
    };
    let side = |x: f64, y: f64, i: usize| {
        let (a, b) = (outline[i], outline[(i + 1) % 4]);
        (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
    };
    for y in span(1, height) {
        for x in span(0, width) {
            let signs: [f64; 4] = std::array::from_fn(|i| side(f64::from(x), f64::from(y), i));
            if signs.iter().all(|s| *s >= 0.0) || signs.iter().all(|s| *s <= 0.0) {
                each(x, y);
            }
        }
    }
}

fn cropped(photo: &GrayImage, share: f64, rng: &mut impl Rng) -> GrayImage {
    let left = |side: u32| ((f64::from(side) * share).round() as u32).clamp(1, side);
    let (width, height) = (left(photo.width()), left(photo.height()));
    let x = rng.random_range(0..=photo.width() - width);
    let y = rng.random_range(0..=photo.height() - height);
    imageops::crop_imm(photo, x, y, width, height).to_image()
}

/// Encodes and decodes an image. One that cannot be encoded is returned as it is.
fn jpeg(photo: &GrayImage, quality: u8) -> GrayImage {
    let mut file = Cursor::new(Vec::new());
    let encoder = JpegEncoder::new_with_quality(&mut file, quality.clamp(1, 100));
    let encoded = photo.write_with_encoder(encoder).map(|()| file.into_inner());
    match encoded.map(|bytes| image::load_from_memory_with_format(&bytes, image::ImageFormat::Jpeg)) {
        Ok(Ok(again)) => again.to_luma8(),
        _ => photo.clone(),
    }
}
