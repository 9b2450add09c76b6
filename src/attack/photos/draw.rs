//! The pictures of one view: what the reference photo sees, in every colour.

use image::{GrayImage, Luma, Rgb, RgbImage};
use nalgebra::Point3;

use super::picture::LightPicture;
use super::raster::{Raster, outline, ray};
use super::views::View;
use super::{FACTOR, PhotosError, Request, Shot};
use crate::attack::frames::Pinhole;
use crate::attack::light;
use crate::geometry::BoxPx;
use crate::mesh::doubled_area;
use crate::pattern::world_aligned::Side;
use crate::photo::Photo;

/// What all views of a folder share.
pub struct Canvas<'a> {
    pub request: &'a Request,
    pub size_px: [u32; 2],
    pub pinhole: Pinhole,
    /// Of each triangle; `None` for what is no paint.
    pub sides: Vec<Option<Side>>,
}

/// The pictures of a view, and what was seen of it.
pub struct Drawn {
    pub object_mask: GrayImage,
    pub paint_mask: GrayImage,
    /// At [`FACTOR`]² places of each pixel, row by row of the finer picture.
    pub positions: Vec<[f64; 3]>,
    pub sides: GrayImage,
    /// The reference, then the others in the view's order.
    pub pictures: Vec<RgbImage>,
    pub box_xyxy_px: Option<BoxPx>,
    /// The share of the paint that every photo sees.
    pub kept: f64,
}

/// A photo that the reference's surface is looked up in.
struct Source<'a> {
    shot: &'a Shot,
    raster: Raster<'a>,
    light: LightPicture,
    gain: [f64; 3],
}

/// The light at one place of the finer picture in each colour, the reference first.
struct Place {
    is_object: bool,
    /// Where the paint is seen in every photo.
    paint: Option<(Side, Point3<f64>)>,
    lights: Vec<[f64; 3]>,
}

impl<'a> Canvas<'a> {
    pub fn new(request: &'a Request, size_px: [u32; 2], pinhole: Pinhole) -> Self {
        let is_paint = |material: usize| request.materials.is_empty() || request.materials.contains(&material);
        let side = |t: &crate::mesh::Triangle| {
            is_paint(t.material).then(|| Side::of(&doubled_area(&request.mesh.corners_mm(t))))
        };
        Self {
            request,
            size_px,
            pinhole,
            sides: request.mesh.triangles().iter().map(side).collect(),
        }
    }

    /// `None` when the model is partly behind a camera.
    ///
    /// # Errors
    /// Photos that cannot be read.
    pub fn draw(&self, view: &View) -> Result<Option<Drawn>, PhotosError> {
        let fine = self.size_px.map(|px| (px * FACTOR) as usize);
        let pinhole = self.fine_pinhole();
        let (mesh, reference) = (&self.request.mesh, view.reference);
        let Some(raster) = Raster::picture(mesh, &reference.pose, &pinhole, fine) else {
            return Ok(None);
        };
        let own = self.light(reference)?;
        let mut sources = Vec::new();
        for other in &view.others {
            let Some(raster) = Raster::whole(mesh, &other.shot.pose, &pinhole, fine) else {
                return Ok(None);
            };
            sources.push(Source {
                shot: other.shot,
                raster,
                light: self.light(other.shot)?,
                gain: other.gain,
            });
        }
        let mut sums = Sums::new(self.size_px, 1 + sources.len());
        let centre = reference.centre_mm();
        for y in 0..fine[1] as i64 {
            for x in 0..fine[0] as i64 {
                let pixel = reference.camera.project(&ray(&pinhole, [x as f64, y as f64]));
                // The frame lies inside the photo; only rounding can leave it.
                let light = pixel.and_then(|p| own.at(p)).unwrap_or_default();
                let mut place = Place {
                    is_object: false,
                    paint: None,
                    lights: vec![light; 1 + sources.len()],
                };
                if let Some(hit) = raster.at(x, y) {
                    place.is_object = true;
                    if let Some(side) = self.sides[hit.triangle] {
                        sums.paint += 1;
                        let point = raster.point(x, y, &hit);
                        let found: Option<Vec<_>> =
                            sources.iter().map(|s| s.at(&point, hit.triangle, &centre)).collect();
                        if let Some(found) = found {
                            place.paint = Some((side, point));
                            place.lights[1..].copy_from_slice(&found);
                        }
                    }
                }
                sums.add(x as usize, y as usize, &place);
            }
        }
        let around = outline(mesh, &reference.pose, &self.pinhole);
        Ok(Some(sums.finished(around)))
    }

    /// The camera of the finer picture.
    fn fine_pinhole(&self) -> Pinhole {
        let factor = f64::from(FACTOR);
        Pinhole {
            focal_length_px: factor * self.pinhole.focal_length_px,
            centre_px: self.pinhole.centre_px.map(|c| factor * (c + 0.5) - 0.5),
        }
    }

    /// A photo, reduced to no less than the finer picture's resolution.
    fn light(&self, shot: &Shot) -> Result<LightPicture, PhotosError> {
        let photo = Photo::open(&shot.file)?;
        let (width, height) = (shot.camera.width, shot.camera.height);
        if photo.rgb.dimensions() != (width, height) {
            return Err(PhotosError::Changed {
                photo: shot.file.clone(),
            });
        }
        let reduction = shot.camera.fx.min(shot.camera.fy) / self.fine_pinhole().focal_length_px;
        Ok(LightPicture::new(&photo.rgb, (reduction as usize).clamp(1, width.min(height) as usize)))
    }
}

impl Source<'_> {
    /// The light of a surface point, at the reference's exposure; `None` where this photo does not see it.
    fn at(&self, point: &Point3<f64>, triangle: usize, reference_centre: &Point3<f64>) -> Option<[f64; 3]> {
        if !self.raster.sees(point, triangle, reference_centre) {
            return None;
        }
        let light = self.light.at(self.shot.camera.project(&(self.shot.pose * point))?)?;
        Some(std::array::from_fn(|c| self.gain[c] * light[c]))
    }
}

/// The pictures while they are added up.
struct Sums {
    size_px: [usize; 2],
    object: Vec<u32>,
    painted: Vec<u32>,
    /// Places of paint in the reference photo.
    paint: usize,
    positions: Vec<[f64; 3]>,
    sides: Vec<u8>,
    lights: Vec<Vec<[f64; 3]>>,
}

impl Sums {
    fn new(size_px: [u32; 2], colours: usize) -> Self {
        let pixels = (size_px[0] * size_px[1]) as usize;
        let places = pixels * (FACTOR * FACTOR) as usize;
        Self {
            size_px: size_px.map(|px| px as usize),
            object: vec![0; pixels],
            painted: vec![0; pixels],
            paint: 0,
            positions: vec![[0.0; 3]; places],
            sides: vec![0; places],
            lights: vec![vec![[0.0; 3]; pixels]; colours],
        }
    }

    fn add(&mut self, x: usize, y: usize, place: &Place) {
        let factor = FACTOR as usize;
        let pixel = y / factor * self.size_px[0] + x / factor;
        let fine = y * self.size_px[0] * factor + x;
        self.object[pixel] += u32::from(place.is_object);
        if let Some((side, point)) = &place.paint {
            self.painted[pixel] += 1;
            self.positions[fine] = point.coords.into();
            self.sides[fine] = 1 + Side::ALL.iter().position(|s| s == side).unwrap_or_default() as u8;
        }
        for (picture, light) in self.lights.iter_mut().zip(&place.lights) {
            (0..3).for_each(|c| picture[pixel][c] += light[c] / f64::from(FACTOR * FACTOR));
        }
    }

    /// `around`: the mesh's projected corners, from the middle of the first pixel.
    fn finished(self, around: Option<BoxPx>) -> Drawn {
        let [width, height] = self.size_px.map(|px| px as u32);
        let mask = |counts: &[u32]| {
            let level = |count: u32| (255.0 * f64::from(count) / f64::from(FACTOR * FACTOR)).round() as u8;
            GrayImage::from_fn(width, height, |x, y| Luma([level(counts[(y * width + x) as usize])]))
        };
        let picture = |lights: &Vec<[f64; 3]>| {
            RgbImage::from_fn(width, height, |x, y| Rgb(light::rgb_of(lights[(y * width + x) as usize])))
        };
        let kept: u32 = self.painted.iter().sum();
        let clipped = around.map(|b| b.clipped(f64::from(width), f64::from(height)));
        Drawn {
            object_mask: mask(&self.object),
            paint_mask: mask(&self.painted),
            pictures: self.lights.iter().map(picture).collect(),
            positions: self.positions,
            sides: GrayImage::from_raw(width * FACTOR, height * FACTOR, self.sides).unwrap_or_default(),
            box_xyxy_px: clipped.filter(BoxPx::is_solid),
            kept: f64::from(kept) / self.paint.max(1) as f64,
        }
    }
}
