//! The image: each texel is the mean, in linear light, of the colours of its place on the surface.

use std::collections::VecDeque;
use std::convert::Infallible;

use image::{Rgb, RgbImage};

use super::BakedFace;
use scaleproof_core::workers;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::light;
use scaleproof_surface::texture::Texture;

/// Points along each side of a texel at which colours are taken.
const SAMPLES: usize = 4;
/// Rows that one thread fills at a time.
const BAND: usize = 64;
/// A point counts as on a face's edge by this share of the face.
const EDGE: f64 = 1e-9;

/// A face with its corners in texels, from the image's top left corner.
struct Placed<'a> {
    face: &'a BakedFace,
    chart: u32,
    corners: [[f64; 2]; 3],
    doubled_area: f64,
}

impl Placed<'_> {
    /// Shares of the corners at a place; `None` outside.
    fn shares(&self, p: [f64; 2]) -> Option<[f64; 3]> {
        let [a, b, c] = self.corners;
        let shares = [cross(b, c, p), cross(c, a, p), cross(a, b, p)].map(|part| part / self.doubled_area);
        shares.iter().all(|share| *share >= -EDGE).then_some(shares)
    }

    /// The texels that the box around it meets, along an axis.
    fn span(&self, axis: usize, from: usize, to: usize) -> std::ops::Range<usize> {
        let values = self.corners.map(|p| p[axis]);
        let low = values.into_iter().fold(f64::INFINITY, f64::min).floor();
        let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max).floor() + 1.0;
        let clamped = |v: f64| v.clamp(from as f64, to as f64) as usize;
        clamped(low)..clamped(high)
    }
}

/// Rows of texels on their way.
struct Band {
    width: usize,
    top: usize,
    bottom: usize,
    /// 1 + the chart whose colours a texel takes; 0 as long as none does.
    owner: Vec<u32>,
    sum: Vec<[f32; 3]>,
    count: Vec<u16>,
}

/// Texels that no chart has take the colour of the nearest one that has some, so that no filter draws a border.
pub(super) fn fill(mesh: &Mesh, texture: &Texture, charts: &[Vec<BakedFace>], [width, height]: [u32; 2]) -> RgbImage {
    let faces = placed(charts, [width, height]);
    let (width, height) = (width as usize, height as usize);
    let tops: Vec<usize> = (0..height).step_by(BAND).collect();
    let band = |_: &mut (), top: &usize| {
        let mut band = Band::new(width, *top, (*top + BAND).min(height));
        band.claim(&faces);
        band.gather(mesh, texture, &faces);
        Ok::<_, Infallible>(band.colours())
    };
    let Ok(bands) = workers::map(&tops, || Ok(()), band, || {});
    let mut texels: Vec<Option<[u8; 3]>> = bands.into_iter().flatten().collect();
    give_small_ones_a_texel(mesh, texture, &faces, &mut texels, [width, height]);
    spread(&mut texels, width);
    let mut image = RgbImage::new(width as u32, height as u32);
    for (pixel, texel) in image.pixels_mut().zip(texels) {
        *pixel = Rgb(texel.unwrap_or_default());
    }
    image
}

fn placed(charts: &[Vec<BakedFace>], [width, height]: [u32; 2]) -> Vec<Placed<'_>> {
    let place = |(chart, face)| {
        let face: &BakedFace = face;
        let corners = face
            .uv
            .map(|[u, v]| [u * f64::from(width), (1.0 - v) * f64::from(height)]);
        let [a, b, c] = corners;
        Placed {
            face,
            chart,
            corners,
            doubled_area: cross(a, b, c),
        }
    };
    let numbered = (1_u32..).zip(charts);
    numbered
        .flat_map(|(chart, faces)| faces.iter().map(move |face| (chart, face)))
        .map(place)
        .collect()
}

impl Band {
    fn new(width: usize, top: usize, bottom: usize) -> Self {
        let texels = width * (bottom - top);
        Self {
            width,
            top,
            bottom,
            owner: vec![0; texels],
            sum: vec![[0.0; 3]; texels],
            count: vec![0; texels],
        }
    }

    /// A texel belongs to the chart that its centre lies in.
    fn claim(&mut self, faces: &[Placed]) {
        self.each_texel(faces, |band, face, [x, y], texel| {
            if band.owner[texel] == 0 && face.shares([x as f64 + 0.5, y as f64 + 0.5]).is_some() {
                band.owner[texel] = face.chart;
            }
        });
    }

    /// Adds the colours of each texel's points in its chart. A texel whose centre lies in no chart belongs to the first with a point in it.
    fn gather(&mut self, mesh: &Mesh, texture: &Texture, faces: &[Placed]) {
        self.each_texel(faces, |band, face, [x, y], texel| {
            if ![0, face.chart].contains(&band.owner[texel]) {
                return;
            }
            for point in 0..SAMPLES * SAMPLES {
                let part = |i: usize| (i as f64 + 0.5) / SAMPLES as f64;
                let p = [x as f64 + part(point % SAMPLES), y as f64 + part(point / SAMPLES)];
                let Some(shares) = face.shares(p) else { continue };
                let linear = light::linear_of(texture.colour(mesh, &face.face.at(shares)));
                band.owner[texel] = face.chart;
                (0..3).for_each(|c| band.sum[texel][c] += linear[c] as f32);
                band.count[texel] += 1;
            }
        });
    }

    fn each_texel(&mut self, faces: &[Placed], mut visit: impl FnMut(&mut Self, &Placed, [usize; 2], usize)) {
        for face in faces.iter().filter(|face| face.doubled_area != 0.0) {
            for y in face.span(1, self.top, self.bottom) {
                for x in face.span(0, 0, self.width) {
                    visit(self, face, [x, y], (y - self.top) * self.width + x);
                }
            }
        }
    }

    fn colours(self) -> Vec<Option<[u8; 3]>> {
        let mean = |(sum, count): ([f32; 3], u16)| {
            (count > 0).then(|| light::rgb_of(sum.map(|v| f64::from(v) / f64::from(count))))
        };
        self.sum.into_iter().zip(self.count).map(mean).collect()
    }
}

/// A face between the points gets the texel that it lies in, when no other has it.
fn give_small_ones_a_texel(
    mesh: &Mesh,
    texture: &Texture,
    faces: &[Placed],
    texels: &mut [Option<[u8; 3]>],
    [width, height]: [usize; 2],
) {
    for face in faces {
        let [x, y] = [0, 1].map(|axis| face.corners.iter().map(|p| p[axis] / 3.0).sum::<f64>());
        let (x, y) = (
            (x.max(0.0) as usize).min(width - 1),
            (y.max(0.0) as usize).min(height - 1),
        );
        let texel = &mut texels[y * width + x];
        if texel.is_none() {
            *texel = Some(texture.colour(mesh, &face.face.at([1.0 / 3.0; 3])));
        }
    }
}

/// Gives every texel without a colour that of the nearest with one.
fn spread(texels: &mut [Option<[u8; 3]>], width: usize) {
    let height = texels.len() / width;
    let mut border: VecDeque<usize> = (0..texels.len()).filter(|i| texels[*i].is_some()).collect();
    while let Some(from) = border.pop_front() {
        let (x, y) = (from % width, from / width);
        let beside = [
            (x > 0).then(|| from - 1),
            (x + 1 < width).then(|| from + 1),
            (y > 0).then(|| from - width),
            (y + 1 < height).then(|| from + width),
        ];
        for to in beside.into_iter().flatten() {
            if texels[to].is_none() {
                texels[to] = texels[from];
                border.push_back(to);
            }
        }
    }
}

/// Twice the signed area of a triangle.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
