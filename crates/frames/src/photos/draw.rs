//! The images of one view: what the reference photo sees, in every colour.

use image::{GrayImage, Luma, Rgb, RgbImage};
use nalgebra::Point3;

use super::located::FlatPhoto;
use super::views::PhotosOfView;
use crate::drawn::{DrawnMesh, clip_box, level, side_number};
use crate::raster::{Raster, outline, ray};
use crate::{FramesError, Pinhole, light, reduced};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::ensure;
use scaleproof_photo::Photo;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::world_aligned::Side;

/// Samples of the surface along each side of a pixel.
pub const FACTOR: u32 = 3;

/// The settings of frames from photos.
#[derive(Debug, Clone)]
pub struct PhotoFramesRequest {
    pub mesh: Mesh,
    /// Indices of the materials that are the paint; all when empty.
    pub materials: Vec<usize>,
    pub target_mm: Point3<f64>,
    /// Colours of the paint, 8-bit sRGB of its reflectance. Every view has all of them.
    pub flats: Vec<[u8; 3]>,
    /// Width of the frames, px.
    pub width_px: u32,
    /// The command that makes the frames.
    pub made_by: String,
}

/// Light that may have been clipped: level 253.7 and more.
const CLIPPED: f64 = 0.99;

/// The request, and what all views of a folder have in common.
pub(super) struct Canvas<'a> {
    pub request: &'a PhotoFramesRequest,
    pub size_px: [u32; 2],
    pub pinhole: Pinhole,
    /// The side that each triangle's paint belongs to; `None` for what is no paint.
    pub sides: Vec<Option<Side>>,
}

pub(super) struct ViewImages {
    /// Masks and, at [`FACTOR`]² places of each pixel, positions.
    pub shape: DrawnMesh,
    /// The reference, then the others in the view's order.
    pub images: Vec<RgbImage>,
    /// The share of the paint that every photo sees.
    pub kept: f64,
}

/// A photo that the reference's surface is looked up in.
struct Source<'a> {
    photo: &'a FlatPhoto,
    raster: Raster<'a>,
    light: LightImage,
    gain: [f64; 3],
}

impl Canvas<'_> {
    /// Draws a view in every colour; `None` when the model is partly behind a camera.
    pub(super) fn draw(&self, view: &PhotosOfView) -> Result<Option<ViewImages>, FramesError> {
        let fine = self.size_px.map(|px| (px * FACTOR) as usize);
        let pinhole = self.pinhole.finer(FACTOR);
        let (mesh, reference) = (&self.request.mesh, view.reference);
        let Some(raster) = Raster::image(mesh, &reference.pose, &pinhole, fine) else {
            return Ok(None);
        };
        let own = self.light(reference)?;
        let mut sources = Vec::new();
        for other in &view.others {
            let Some(raster) = Raster::whole(mesh, &other.photo.pose, &pinhole, fine) else {
                return Ok(None);
            };
            sources.push(Source {
                photo: other.photo,
                raster,
                light: self.light(other.photo)?,
                gain: other.gain,
            });
        }
        let mut sums = Sums::new(self.size_px, 1 + sources.len());
        let centre = reference.centre_mm();
        for y in 0..fine[1] as i64 {
            for x in 0..fine[0] as i64 {
                let pixel = reference.camera.project(&ray(&pinhole, [x as f64, y as f64]));
                // The frame lies inside the photo; only rounding can leave it.
                let light = pixel.and_then(|p| own.sample(p)).unwrap_or_default();
                let hit = raster.at(x, y);
                let paint = hit.and_then(|hit| {
                    let side = self.sides[hit.triangle]?;
                    let point = raster.point(x, y, &hit);
                    let found = sources.iter().map(|s| self.look_up(s, &point, hit.triangle, &centre));
                    Some((side, point, std::iter::once(Some(light)).chain(found).collect()))
                });
                sums.add([x, y].map(|v| v as usize), hit.is_some(), light, paint);
            }
        }
        let around = outline(mesh, &reference.pose, &self.pinhole);
        Ok(Some(sums.finished(around)))
    }

    /// Returns the light of a surface point, at the reference's exposure; `None` where the photo does not see it, or something else a place away, and
    /// where clipped light would pass for a tone.
    fn look_up(&self, source: &Source, point: &Point3<f64>, triangle: usize, centre: &Point3<f64>) -> Option<[f64; 3]> {
        let is_paint = |triangle: usize| self.sides[triangle].is_some();
        if !source.raster.sees(point, triangle, centre, is_paint) {
            return None;
        }
        let pixel = source.photo.camera.project(&(source.photo.pose * point))?;
        let light = source.light.sample(pixel)?;
        let is_clipped = (0..3).any(|c| light[c] > CLIPPED && source.gain[c] < 1.0);
        (!is_clipped).then(|| std::array::from_fn(|c| source.gain[c] * light[c]))
    }

    /// Reads a photo in linear light, reduced to no less than the finer image's resolution.
    fn light(&self, photo: &FlatPhoto) -> Result<LightImage, FramesError> {
        let decoded = Photo::open(&photo.file)?;
        let (width, height) = (photo.camera.width, photo.camera.height);
        ensure!(
            (decoded.width, decoded.height) == (width, height),
            "{} is of another size than it was a moment ago: leave the photos as they are",
            photo.file.display()
        );
        let reduction = photo.camera.fx.min(photo.camera.fy) / self.pinhole.finer(FACTOR).focal_length_px;
        Ok(LightImage::new(
            &decoded.rgb(1)?,
            (reduction as usize).clamp(1, width.min(height) as usize),
        ))
    }
}

type PaintPlace = (Side, Point3<f64>, Option<Vec<[f64; 3]>>);

struct Sums {
    size_px: [usize; 2],
    pixels: Vec<Pixel>,
    /// The light of the paint in each colour, pixel by pixel.
    paint: Vec<Vec<[f64; 3]>>,
    positions: Vec<[f64; 3]>,
    sides: Vec<u8>,
}

/// Counts of places in a pixel, and the reference photo's light from those that are not in [`Sums::paint`].
#[derive(Clone, Copy, Default)]
struct Pixel {
    object: u32,
    seen: u32,
    hidden: u32,
    rest: [f64; 3],
    hidden_light: [f64; 3],
}

impl Pixel {
    /// Returns the places of paint in the mask: what is hidden looks like the paint that is seen in the same pixel.
    fn painted(&self) -> u32 {
        if self.seen > 0 { self.seen + self.hidden } else { 0 }
    }
}

fn add(sum: &mut [f64; 3], light: &[f64; 3], weight: f64) {
    (0..3).for_each(|c| sum[c] += weight * light[c]);
}

impl Sums {
    /// Empty sums; positions and sides are kept for each place of the finer image.
    fn new(size_px: [u32; 2], colours: usize) -> Self {
        let count = (size_px[0] * size_px[1]) as usize;
        let places = count * (FACTOR * FACTOR) as usize;
        Self {
            size_px: size_px.map(|px| px as usize),
            pixels: vec![Pixel::default(); count],
            paint: vec![vec![[0.0; 3]; count]; colours],
            positions: vec![[0.0; 3]; places],
            sides: vec![0; places],
        }
    }

    /// Adds a place of the finer image: the light that the reference photo has there, whether it shows the model, and of its paint the side, the
    /// point and the light in every colour, the reference's first; `None` where some photo does not see it.
    fn add(&mut self, [x, y]: [usize; 2], is_object: bool, light: [f64; 3], paint: Option<PaintPlace>) {
        let factor = FACTOR as usize;
        let index = y / factor * self.size_px[0] + x / factor;
        let pixel = &mut self.pixels[index];
        pixel.object += u32::from(is_object);
        match paint {
            None => add(&mut pixel.rest, &light, 1.0),
            Some((_, _, None)) => {
                pixel.hidden += 1;
                add(&mut pixel.hidden_light, &light, 1.0);
            }
            Some((side, point, Some(lights))) => {
                pixel.seen += 1;
                let fine = y * self.size_px[0] * factor + x;
                self.positions[fine] = point.coords.into();
                self.sides[fine] = side_number(side);
                for (image, light) in self.paint.iter_mut().zip(&lights) {
                    add(&mut image[index], light, 1.0);
                }
            }
        }
    }

    /// Returns a pixel's mean light in a colour; 0 is the reference.
    fn light(&self, index: usize, colour: usize) -> [f64; 3] {
        let pixel = &self.pixels[index];
        let mut sum = pixel.rest;
        add(&mut sum, &self.paint[colour][index], 1.0);
        match self.paint_about(index, colour).filter(|_| colour > 0) {
            Some(paint) => add(&mut sum, &paint, f64::from(pixel.hidden)),
            None => add(&mut sum, &pixel.hidden_light, 1.0),
        }
        sum.map(|v| v / f64::from(FACTOR * FACTOR))
    }

    /// Returns the mean light of the paint that is seen in a pixel, else in its neighbours; without it, edges would be lined in the reference's colour.
    fn paint_about(&self, index: usize, colour: usize) -> Option<[f64; 3]> {
        let [width, height] = self.size_px;
        let (x, y) = (index % width, index / width);
        let mean = |reach: usize| {
            let (mut sum, mut seen) = ([0.0; 3], 0);
            for row in y.saturating_sub(reach)..(y + reach + 1).min(height) {
                for column in x.saturating_sub(reach)..(x + reach + 1).min(width) {
                    let index = row * width + column;
                    seen += self.pixels[index].seen;
                    add(&mut sum, &self.paint[colour][index], 1.0);
                }
            }
            (seen > 0).then(|| sum.map(|v| v / f64::from(seen)))
        };
        mean(0).or_else(|| mean(1))
    }

    /// Returns masks and images; `around` is the box of the mesh's projected corners, from the middle of the first pixel.
    fn finished(self, around: Option<BoxPx>) -> ViewImages {
        let [width, height] = self.size_px.map(|px| px as u32);
        let index = |x: u32, y: u32| (y * width + x) as usize;
        let mask = |count: fn(&Pixel) -> u32| {
            let level = |x, y| level(count(&self.pixels[index(x, y)]), FACTOR);
            GrayImage::from_fn(width, height, |x, y| Luma([level(x, y)]))
        };
        let image = |colour: usize| {
            let light = |x, y| self.light(index(x, y), colour);
            RgbImage::from_fn(width, height, |x, y| Rgb(light::rgb_of(light(x, y))))
        };
        let total = |count: fn(&Pixel) -> u32| self.pixels.iter().map(count).sum::<u32>();
        let kept = f64::from(total(Pixel::painted)) / f64::from(total(|p| p.seen + p.hidden).max(1));
        ViewImages {
            images: (0..self.paint.len()).map(image).collect(),
            shape: DrawnMesh {
                object_mask: mask(|p| p.object),
                paint_mask: mask(Pixel::painted),
                positions: self.positions,
                sides: GrayImage::from_raw(width * FACTOR, height * FACTOR, self.sides).unwrap_or_default(),
                box_xyxy_px: around.and_then(|b| clip_box(&b, [width, height])),
            },
            kept,
        }
    }
}

/// A photo's light, reduced by the mean of squares of pixels: linear in sRGB's primaries, 1 is white.
struct LightImage {
    width: usize,
    height: usize,
    /// Width and height of the photo, px.
    photo: [f64; 2],
    /// Width and height of a pixel here, in pixels of the photo.
    reduction: usize,
    pixels: Vec<[f32; 3]>,
}

impl LightImage {
    /// Pixels at the right and lower border that fill no square are left to the last one.
    fn new(photo: &RgbImage, reduction: usize) -> Self {
        let levels: [f32; 256] = std::array::from_fn(|level| light::decode(level as f64 / 255.0) as f32);
        let [width, height] = [photo.width(), photo.height()].map(|side| side as usize);
        let pixels = photo.pixels().map(|p| p.0.map(|level| levels[usize::from(level)]));
        Self {
            width: width / reduction,
            height: height / reduction,
            photo: [photo.width(), photo.height()].map(f64::from),
            reduction,
            pixels: reduced(pixels, width, reduction),
        }
    }

    /// Samples the light at a pixel of the photo, bilinear; `None` outside the image.
    fn sample(&self, pixel: [f64; 2]) -> Option<[f64; 3]> {
        if (0..2).any(|i| !(-0.5..=self.photo[i] - 0.5).contains(&pixel[i])) {
            return None;
        }
        let here = pixel.map(|v| (v + 0.5) / self.reduction as f64 - 0.5);
        let (x0, x1, tx) = neighbours(here[0], self.width);
        let (y0, y1, ty) = neighbours(here[1], self.height);
        let at = |x: usize, y: usize| self.pixels[y * self.width + x];
        let [a, b, c, d] = [at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1)];
        let mix = |from: f64, to: f64, share: f64| from + share * (to - from);
        Some(std::array::from_fn(|i| {
            let row = |l: [f32; 3], r: [f32; 3]| mix(f64::from(l[i]), f64::from(r[i]), tx);
            mix(row(a, b), row(c, d), ty)
        }))
    }
}

/// Returns the two pixels about a place on one axis, and the second one's share.
fn neighbours(place: f64, size: usize) -> (usize, usize, f64) {
    let place = place.clamp(0.0, (size - 1) as f64);
    let first = place as usize;
    (first, (first + 1).min(size - 1), place - first as f64)
}
