//! Rasterisation of the image: each texel is the mean, in linear light, of the colours of its place on the surface.

use std::collections::VecDeque;
use std::ops::Range;

use image::{Rgb, RgbImage};

use super::BakedFace;
use scaleproof_core::geometry::{PlaneTriangle, cells_beside};
use scaleproof_core::workers;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::light;
use scaleproof_surface::texture::Texture;

/// Number of sample points along each side of a texel.
const SAMPLES: usize = 4;
/// Number of rows that one thread fills at a time.
const BAND: usize = 64;

/// Face with its corners in texels, from the image's top left corner.
struct Placed<'a> {
    face: &'a BakedFace,
    chart: u32,
    corners: [[f64; 2]; 3],
    /// Triangle in the image; `None` if it has no area there.
    flat: Option<PlaneTriangle>,
}

/// Accumulator of a texel's colours.
#[derive(Debug, Clone, Copy, Default)]
struct Texel {
    /// 1 + the index of the chart whose colours it takes; 0 as long as none does.
    owner: u32,
    sum: [f32; 3],
    count: u16,
}

/// Band of rows of the image while their texels are filled.
struct Band {
    width: usize,
    rows: Range<usize>,
    texels: Vec<Texel>,
}

/// Renders the image. Texels of no chart get the colour of the nearest one with a colour, so that filtering shows no border.
pub(super) fn fill(mesh: &Mesh, texture: &Texture, charts: &[Vec<BakedFace>], [width, height]: [u32; 2]) -> RgbImage {
    let faces = placed(charts, [width, height]);
    let (width, height) = (width as usize, height as usize);
    let tops: Vec<usize> = (0..height).step_by(BAND).collect();
    let bands: Vec<(usize, Vec<Facet>)> = tops.into_iter().zip(by_band(&faces, height)).collect();
    let bands = workers::each(&bands, |(top, faces)| {
        let mut band = Band::new(width, *top..(*top + BAND).min(height));
        band.claim(faces);
        band.gather(mesh, texture, faces);
        band.colours()
    });
    let mut texels = bands.concat();
    give_small_ones_a_texel(mesh, texture, &faces, &mut texels, [width, height]);
    spread(&mut texels, width);
    let mut image = RgbImage::new(width as u32, height as u32);
    for (pixel, texel) in image.pixels_mut().zip(texels) {
        *pixel = Rgb(texel.unwrap_or_default());
    }
    image
}

fn placed(charts: &[Vec<BakedFace>], [width, height]: [u32; 2]) -> Vec<Placed<'_>> {
    let mut placed = Vec::new();
    for (chart, faces) in (1..).zip(charts) {
        placed.extend(faces.iter().map(|face| {
            let in_texels = |[u, v]: [f64; 2]| [u * f64::from(width), (1.0 - v) * f64::from(height)];
            let corners = face.uv.map(in_texels);
            let flat = PlaneTriangle::new(corners);
            Placed {
                face,
                chart,
                corners,
                flat,
            }
        }));
    }
    placed
}

/// Face with an area in the image.
type Facet<'a> = (&'a Placed<'a>, &'a PlaneTriangle);

/// Returns the faces that overlap each band of rows, in their order.
fn by_band<'a>(faces: &'a [Placed], height: usize) -> Vec<Vec<Facet<'a>>> {
    let mut bands = vec![Vec::new(); height.div_ceil(BAND)];
    for (face, flat) in faces.iter().filter_map(|face| Some((face, face.flat.as_ref()?))) {
        let rows = flat.cells(1, 0..height as i64);
        if !rows.is_empty() {
            let band = |row: i64| row as usize / BAND;
            (band(rows.start)..=band(rows.end - 1)).for_each(|band| bands[band].push((face, flat)));
        }
    }
    bands
}

impl Band {
    fn new(width: usize, rows: Range<usize>) -> Self {
        Self {
            width,
            texels: vec![Texel::default(); width * rows.len()],
            rows,
        }
    }

    /// Assigns texels to the chart that contains their centre.
    fn claim(&mut self, faces: &[Facet]) {
        self.each_texel(faces, |texel, face, flat, [x, y]| {
            if texel.owner == 0 && flat.barycentric([x + 0.5, y + 0.5]).is_some() {
                texel.owner = face.chart;
            }
        });
    }

    /// Adds the colours of each texel's points in its chart. A texel whose centre is in no chart belongs to the first with a point in it.
    fn gather(&mut self, mesh: &Mesh, texture: &Texture, faces: &[Facet]) {
        self.each_texel(faces, |texel, face, flat, [x, y]| {
            if ![0, face.chart].contains(&texel.owner) {
                return;
            }
            for point in 0..SAMPLES * SAMPLES {
                let part = |i: usize| (i as f64 + 0.5) / SAMPLES as f64;
                let Some(shares) = flat.barycentric([x + part(point % SAMPLES), y + part(point / SAMPLES)]) else {
                    continue;
                };
                let linear = light::linear_of(texture.colour(mesh, &face.face.at(shares)));
                texel.owner = face.chart;
                (0..3).for_each(|c| texel.sum[c] += linear[c] as f32);
                texel.count += 1;
            }
        });
    }

    /// Visits every texel that a face overlaps, face by face, with the texel's top left corner.
    fn each_texel(&mut self, faces: &[Facet], mut visit: impl FnMut(&mut Texel, &Placed, &PlaneTriangle, [f64; 2])) {
        for (face, flat) in faces {
            let (width, rows) = (self.width as i64, self.rows.start as i64..self.rows.end as i64);
            for y in flat.cells(1, rows.clone()) {
                for x in flat.cells_of_row(y, 0..width) {
                    let texel = &mut self.texels[((y - rows.start) * width + x) as usize];
                    visit(texel, face, flat, [x as f64, y as f64]);
                }
            }
        }
    }

    fn colours(self) -> Vec<Option<[u8; 3]>> {
        let mean =
            |Texel { sum, count, .. }| (count > 0).then(|| light::rgb_of(sum.map(|v| f64::from(v) / f64::from(count))));
        self.texels.into_iter().map(mean).collect()
    }
}

/// Colours the texel of each face that contains no sample point, if the texel has no colour.
fn give_small_ones_a_texel(
    mesh: &Mesh,
    texture: &Texture,
    faces: &[Placed],
    texels: &mut [Option<[u8; 3]>],
    [width, height]: [usize; 2],
) {
    for face in faces {
        let [x, y] = [0, 1].map(|axis| face.corners.iter().map(|p| p[axis] / 3.0).sum::<f64>());
        let within = |at: f64, count: usize| (at.max(0.0) as usize).min(count - 1);
        let texel = &mut texels[within(y, height) * width + within(x, width)];
        if texel.is_none() {
            *texel = Some(texture.colour(mesh, &face.face.at([1.0 / 3.0; 3])));
        }
    }
}

/// Gives every texel without a colour that of the nearest one with a colour.
fn spread(texels: &mut [Option<[u8; 3]>], width: usize) {
    let height = texels.len() / width;
    let mut border: VecDeque<usize> = (0..texels.len()).filter(|i| texels[*i].is_some()).collect();
    while let Some(from) = border.pop_front() {
        for to in cells_beside(from, width, height).into_iter().flatten() {
            if texels[to].is_none() {
                texels[to] = texels[from];
                border.push_back(to);
            }
        }
    }
}
