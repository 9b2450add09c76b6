//! A printer, and a camera before the print: everything that stands between a chart's file and its photo. The formulas of colour
//! are written out here, so that they are not the program's.

use std::collections::HashMap;

use image::codecs::jpeg::JpegEncoder;
use image::{ImageBuffer, Rgb, RgbImage, imageops};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_surface::pattern::colour::Lab;

/// Linear light.
pub type Picture = ImageBuffer<Rgb<f32>, Vec<f32>>;

/// A printer: dot gain, inks that are not pure, black that is not black, paper that is not white.
#[derive(Clone, Copy)]
pub struct Printer {
    /// Exponent on the light of each channel: above 1 darkens the middle tones.
    pub dot_gain: f64,
    /// What each channel takes from the others.
    pub impurity: f64,
    /// Light that the blackest ink still reflects, as a share of the paper's.
    pub black: f64,
    /// Reflectance of the paper.
    pub paper: [f64; 3],
}

/// An office inkjet on plain paper, roughly: a third of sRGB.
pub const PLAIN_PAPER: Printer = Printer {
    dot_gain: 1.15,
    impurity: 0.12,
    black: 0.035,
    paper: [0.86, 0.88, 0.92],
};

impl Printer {
    /// Light relative to the paper's.
    pub fn relative(&self, asked: [u8; 3]) -> [f64; 3] {
        let light = asked.map(|v| linear(v).powf(self.dot_gain));
        [0, 1, 2].map(|i| {
            let others = (light[(i + 1) % 3] + light[(i + 2) % 3]) / 2.0;
            let inked = (1.0 - self.impurity) * light[i] + self.impurity * others;
            self.black + (1.0 - self.black) * inked
        })
    }

    /// What a perfect reader reads.
    pub fn truth(&self, asked: [u8; 3]) -> Lab {
        Lab::from_linear(self.relative(asked))
    }

    fn printed(&self, sheet: &RgbImage) -> Picture {
        let mut known: HashMap<[u8; 3], Rgb<f32>> = HashMap::new();
        Picture::from_fn(sheet.width(), sheet.height(), |x, y| {
            let asked = sheet.get_pixel(x, y).0;
            *known.entry(asked).or_insert_with(|| {
                let relative = self.relative(asked);
                Rgb([0, 1, 2].map(|i| (relative[i] * self.paper[i]) as f32))
            })
        })
    }
}

/// One photo.
#[derive(Clone, Copy)]
pub struct View {
    pub seed: u64,
    pub width: u32,
    pub height: u32,
    /// How much of the image the sheet fills, and how askew its corners are, as shares of the image.
    pub fill: f64,
    pub askew: f64,
    pub turn_deg: f64,
    /// Camera's light over the paper's, per channel: exposure and white balance.
    pub gain: [f64; 3],
    /// Fall-off of the light over the image along x and y, and from the middle to a corner (vignetting).
    pub slope: [f64; 2],
    pub vignette: f64,
    /// Standard deviation of the lens blur, px.
    pub blur_px: f64,
    /// Standard deviation of the noise, in 8-bit levels.
    pub noise: f64,
    pub jpeg_quality: u8,
    /// Barrel distortion at the image's corners, as a share of their distance from the middle.
    pub barrel: f64,
    /// How far the middle of the sheet is from where flat paper has it, px.
    pub bend_px: f64,
}

/// An ordinary photo by hand.
pub const VIEW: View = View {
    seed: 1,
    width: 1200,
    height: 1600,
    fill: 0.86,
    askew: 0.05,
    turn_deg: 0.0,
    gain: [0.72, 0.8, 0.62],
    slope: [0.12, -0.08],
    vignette: 0.0,
    blur_px: 1.0,
    noise: 2.0,
    jpeg_quality: 90,
    barrel: 0.0,
    bend_px: 0.0,
};

/// Photographs a page: `sheet` is what the printer was asked for.
pub fn photo(sheet: &RgbImage, printer: &Printer, view: &View) -> RgbImage {
    photo_with(sheet, printer, view, |_| {})
}

/// A photo like [`photo`] of a print to which something was done in between.
pub fn photo_with(sheet: &RgbImage, printer: &Printer, view: &View, touch: impl FnOnce(&mut Picture)) -> RgbImage {
    let mut rng = Pcg64Mcg::seed_from_u64(view.seed);
    let mut print = printer.printed(sheet);
    touch(&mut print);
    let corners = corners(view, &mut rng, f64::from(sheet.width()) / f64::from(sheet.height()));
    let (w, h) = (f64::from(sheet.width()) - 1.0, f64::from(sheet.height()) - 1.0);
    let to_sheet = homography(&corners, &[[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]]);
    let desk = Rgb([0.18_f32, 0.13, 0.09]);
    let mut seen = Picture::from_fn(view.width, view.height, |x, y| {
        averaged(&print, &to_sheet, view, (x, y), desk)
    });
    if view.blur_px > 0.0 {
        seen = imageops::blur(&seen, view.blur_px as f32);
    }
    RgbImage::from_fn(view.width, view.height, |x, y| {
        let light = light(view, x, y);
        let pixel = seen.get_pixel(x, y).0;
        Rgb([0, 1, 2].map(|i| {
            let value = f64::from(pixel[i]) * light * view.gain[i];
            (encoded(value) + view.noise * normal(&mut rng))
                .round()
                .clamp(0.0, 255.0) as u8
        }))
    })
}

/// As a camera stores it.
pub fn jpeg(photo: &RgbImage, quality: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode_image(photo)
        .unwrap();
    bytes
}

fn light(view: &View, x: u32, y: u32) -> f64 {
    let (u, v) = (
        2.0 * f64::from(x) / f64::from(view.width) - 1.0,
        2.0 * f64::from(y) / f64::from(view.height) - 1.0,
    );
    (1.0 + view.slope[0] * u + view.slope[1] * v) * (1.0 - view.vignette * (u * u + v * v) / 2.0)
}

/// The sheet's corners in the image: fitted in, turned, and each moved by chance.
fn corners(view: &View, rng: &mut Pcg64Mcg, aspect: f64) -> [[f64; 2]; 4] {
    let (w, h) = (f64::from(view.width), f64::from(view.height));
    let half_height = view.fill * (h / 2.0).min(w / 2.0 / aspect);
    let half_width = half_height * aspect;
    let (sin, cos) = view.turn_deg.to_radians().sin_cos();
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
        let (x, y) = (x * half_width, y * half_height);
        let moved = |rng: &mut Pcg64Mcg| rng.random_range(-1.0..=1.0) * view.askew * w;
        [
            w / 2.0 + cos * x - sin * y + moved(rng),
            h / 2.0 + sin * x + cos * y + moved(rng),
        ]
    })
}

/// Four bilinear looks a pixel.
fn averaged(print: &Picture, to_sheet: &Matrix3<f64>, view: &View, at: (u32, u32), desk: Rgb<f32>) -> Rgb<f32> {
    let mut sum = [0.0_f32; 3];
    for i in 0..4 {
        let (dx, dy) = (f64::from(i % 2) / 2.0 - 0.25, f64::from(i / 2) / 2.0 - 0.25);
        let [x, y] = straightened(view, f64::from(at.0) + dx, f64::from(at.1) + dy);
        let p = to_sheet * Vector3::new(x, y, 1.0);
        let pixel = imageops::interpolate_bilinear(print, (p.x / p.z) as f32, (p.y / p.z) as f32).unwrap_or(desk);
        sum.iter_mut().zip(pixel.0).for_each(|(sum, v)| *sum += v / 4.0);
    }
    Rgb(sum)
}

/// Where a flat sheet and a straight lens would have the point that is seen here.
fn straightened(view: &View, x: f64, y: f64) -> [f64; 2] {
    let (w, h) = (f64::from(view.width) / 2.0, f64::from(view.height) / 2.0);
    let (u, v) = (x - w, y - h);
    let grown = 1.0 + view.barrel * (u * u + v * v) / (w * w + h * h);
    let bowed = view.bend_px * (1.0 - (v / h).powi(2)).max(0.0);
    [w + grown * u + bowed, h + grown * v]
}

/// Through four points exactly.
fn homography(from: &[[f64; 2]; 4], to: &[[f64; 2]; 4]) -> Matrix3<f64> {
    let mut a = SMatrix::<f64, 8, 8>::zeros();
    let mut b = SVector::<f64, 8>::zeros();
    for (i, ([x, y], [u, v])) in from.iter().zip(to).enumerate() {
        let (x, y) = (*x, *y);
        a.row_mut(2 * i)
            .copy_from_slice(&[x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y]);
        a.row_mut(2 * i + 1)
            .copy_from_slice(&[0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y]);
        (b[2 * i], b[2 * i + 1]) = (*u, *v);
    }
    let h = a.lu().solve(&b).unwrap();
    Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0)
}

/// IEC 61966-2-1.
fn linear(level: u8) -> f64 {
    let v = f64::from(level) / 255.0;
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

fn encoded(light: f64) -> f64 {
    let v = light.max(0.0);
    255.0
        * if v <= 0.003_130_8 {
            12.92 * v
        } else {
            1.055 * v.powf(1.0 / 2.4) - 0.055
        }
}

/// Normal noise of σ = 1 (Box–Muller).
fn normal(rng: &mut Pcg64Mcg) -> f64 {
    let (a, b): (f64, f64) = (rng.random::<f64>().max(1e-12), rng.random());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}
