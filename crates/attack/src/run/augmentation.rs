//! Expectation over transformation (EOT; Athalye et al., ICML 2018): random changes of the pattern's position and of the image,
//! each with its vector–Jacobian product.

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg32;
use serde::{Serialize, Serializer};

use super::cells::{Rgb, of_image, to_image};
use super::resample::Resample;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::statistics::normal;
use scaleproof_frames::surrogate::projection::repeated::Jitter;
use scaleproof_frames::surrogate::projection::world::Misplacement;
use scaleproof_gradients::separable::{Separable, Tap};
use scaleproof_photo::as_jpeg;
use scaleproof_photo::defence::{Defence, Frame};

/// Kind of augmentation: its name, and the function that adds it.
type Kind = (&'static str, fn(&mut Eot));

/// Ranges that augmentations are drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Eot {
    /// Shift of the texture on the model, to either side, in repeats.
    pub shift_tiles: f64,
    /// Size of the pattern against its true size, to either side of 1.
    pub tile_scale: f64,
    /// Turn of the pattern on each side of the model, to either side, degrees; not for Repeated Texture Projection.
    pub turn_deg: f64,
    /// Error of the pose: the largest shift of the paint in the image along each axis, px, and its largest turn, degrees; not for Repeated Texture
    /// Projection.
    pub pose: f64,
    /// True when images are predicted by any of the closed forms that can be fitted, not only by the default.
    pub any_renderer: bool,
    /// Exponent of the image's values, as of a camera's tone curve: drawn from this one, below 1, to its inverse.
    pub tone: f64,
    /// Added to the image, to either side, in sRGB of 0 to 1.
    pub brightness: f64,
    /// Factor about middle grey: drawn from this one, below 1, to its inverse.
    pub contrast: f64,
    /// Size of the image about its middle: from one to another.
    pub scale: [f64; 2],
    /// Largest shift of the image, px: it is chance which of a detector's cells the model falls into.
    pub offset_px: f64,
    /// Standard deviation of the noise of each value, in sRGB of 0 to 1.
    pub noise: f64,
    /// Factor of each channel: drawn from this one, below 1, to its inverse.
    pub white_balance: f64,
    /// Largest standard deviation of the blur, px.
    pub blur_px: f64,
    /// JPEG compression, from the best quality down to this one; 100 for none.
    pub jpeg_quality: u8,
    /// Share of images that get the background of another view.
    pub background: f64,
    /// Defence that is applied to the image last of all.
    #[serde(serialize_with = "by_name")]
    pub defence: Option<Defence>,
}

fn by_name<S: Serializer>(defence: &Option<Defence>, to: S) -> Result<S::Ok, S::Error> {
    defence.map(Defence::name).serialize(to)
}

impl Eot {
    /// No augmentation.
    pub const NONE: Self = Self {
        shift_tiles: 0.0,
        tile_scale: 0.0,
        turn_deg: 0.0,
        pose: 0.0,
        any_renderer: false,
        tone: 1.0,
        brightness: 0.0,
        contrast: 1.0,
        scale: [1.0, 1.0],
        offset_px: 0.0,
        noise: 0.0,
        white_balance: 1.0,
        blur_px: 0.0,
        jpeg_quality: 100,
        background: 0.0,
        defence: None,
    };

    /// The default: no shift of the pattern (print fixes its place), and the changes of the image that a camera makes.
    pub const USUAL: Self = Self {
        brightness: 0.08,
        contrast: 0.85,
        scale: [0.6, 1.15],
        offset_px: 12.0,
        noise: 0.01,
        ..Self::NONE
    };

    /// Kinds that can be added to the default, by name.
    pub const KINDS: [Kind; 14] = [
        ("brightness", |eot| eot.brightness = 0.25),
        ("contrast", |eot| eot.contrast = 0.7),
        ("far", |eot| eot.scale[0] = 0.25),
        ("noise", |eot| eot.noise = 0.04),
        ("white-balance", |eot| eot.white_balance = 0.8),
        ("blur", |eot| eot.blur_px = 1.5),
        ("jpeg", |eot| eot.jpeg_quality = 30),
        ("background", |eot| eot.background = 0.5),
        ("shift", |eot| eot.shift_tiles = 0.5),
        ("size", |eot| eot.tile_scale = eot.tile_scale.max(0.1)),
        ("turn", |eot| eot.turn_deg = 5.0),
        ("pose", |eot| eot.pose = 2.0),
        ("renderer", |eot| eot.any_renderer = true),
        ("tone", |eot| eot.tone = 0.75),
    ];

    /// Draws an error of the pattern's place.
    pub fn misplaced(&self, rng: &mut impl Rng) -> Misplacement {
        let mut either = |by: f64| by * rng.random_range(-1.0..1.0);
        Misplacement {
            size: 1.0 + either(self.tile_scale),
            turn_deg: either(self.turn_deg),
            seen_off_px: [either(self.pose), either(self.pose)],
            seen_turned_deg: either(self.pose),
        }
    }

    /// Returns true when the pattern's place ever has an error.
    pub fn misplaces(&self) -> bool {
        [self.tile_scale, self.turn_deg, self.pose].iter().any(|by| *by > 0.0)
    }
}

/// Draw of the augmentations for one image.
#[derive(Debug, Clone, PartialEq)]
pub struct Augmentation {
    /// φ_rd, the random shift of the texture, and for Repeated Texture Projection its size.
    pub jitter: Jitter,
    pub brightness: f64,
    pub contrast: f64,
    pub scale: f64,
    pub offset_px: [f64; 2],
    noise: f64,
    noise_seed: u64,
    white_balance: Rgb,
    blur_px: f64,
    jpeg_quality: u8,
    defence: Option<Defence>,
    /// View that the background is of, as a share of all views; `None` for its own.
    pub background: Option<f64>,
    tone: f64,
    /// Choice among a view's places of the pattern, as a share of them; 0 is the true one.
    pub laid: f64,
    /// Choice among a view's renderers, as a share of them; 0 is the default.
    pub renderer: f64,
}

impl Augmentation {
    /// No augmentation.
    pub const NONE: Self = Self {
        jitter: Jitter::NONE,
        brightness: 0.0,
        contrast: 1.0,
        scale: 1.0,
        offset_px: [0.0, 0.0],
        noise: 0.0,
        noise_seed: 0,
        white_balance: [1.0; 3],
        blur_px: 0.0,
        jpeg_quality: 100,
        defence: None,
        background: None,
        tone: 1.0,
        laid: 0.0,
        renderer: 0.0,
    };

    /// Draws from the ranges.
    pub fn random(eot: &Eot, rng: &mut impl Rng) -> Self {
        let mut either = |by: f64| by * rng.random_range(-1.0..1.0);
        let jitter = Jitter {
            shift_tiles: [either(eot.shift_tiles), either(eot.shift_tiles)],
            scale: 1.0 + either(eot.tile_scale),
        };
        let (brightness, contrast) = (either(eot.brightness), eot.contrast.powf(either(1.0)));
        let offset_px = [either(eot.offset_px), either(eot.offset_px)];
        let [low, high] = eot.scale;
        let scale = low + (high - low) * rng.random::<f64>();
        let noise_seed: u64 = rng.random();
        // From a generator of their own: runs without them draw what they drew before there were any.
        let mut more = Pcg32::seed_from_u64(noise_seed ^ 0xa06);
        Self {
            white_balance: std::array::from_fn(|_| eot.white_balance.powf(more.random_range(-1.0..1.0))),
            blur_px: eot.blur_px * more.random::<f64>(),
            jpeg_quality: more.random_range(eot.jpeg_quality..=100),
            background: (more.random::<f64>() < eot.background).then(|| more.random()),
            tone: eot.tone.powf(more.random_range(-1.0..1.0)),
            laid: more.random(),
            renderer: more.random(),
            jitter,
            brightness,
            contrast,
            offset_px,
            scale,
            noise: eot.noise,
            noise_seed,
            defence: eot.defence,
        }
    }

    /// Draws for each of some views.
    pub fn of_each(views: Vec<usize>, eot: &Eot, rng: &mut impl Rng) -> Vec<(usize, Self)> {
        views.into_iter().map(|view| (view, Self::random(eot, rng))).collect()
    }

    /// Returns a box of the image as it lies in the augmented one.
    pub fn moved(&self, b: &BoxPx, size_px: [u32; 2]) -> BoxPx {
        let middle = size_px.map(|px| 0.5 * f64::from(px));
        let (scale, offset_px) = self.placed(size_px);
        let x = |v: f64| (v - middle[0]) * scale + middle[0] + offset_px[0];
        let y = |v: f64| (v - middle[1]) * scale + middle[1] + offset_px[1];
        BoxPx::new(x(b.x1), y(b.y1), x(b.x2), y(b.y2))
    }

    /// Returns the size of the image about its middle, and its shift, px: as drawn, then as a defence cuts or pads it.
    fn placed(&self, size_px: [u32; 2]) -> (f64, [f64; 2]) {
        let frame = match self.defence {
            Some(Defence::Crops(_)) => Defence::Crops(1).frames(size_px, self.noise_seed),
            Some(defence) => defence.frames(size_px, self.noise_seed),
            None => return (self.scale, self.offset_px),
        };
        let window = frame.first().unwrap_or(&Frame::whole(size_px)).window();
        let larger = f64::from(size_px[0]) / window.width();
        let moved = |i: usize, from: f64| {
            let middle = 0.5 * f64::from(size_px[i]);
            (middle + self.offset_px[i] - from) * larger - middle
        };
        (self.scale * larger, [moved(0, window.x1), moved(1, window.y1)])
    }

    /// Applies the defence, unless that only cuts or pads the image.
    fn defended(&self, image: &[Rgb], size_px: [u32; 2]) -> Option<Vec<Rgb>> {
        let defence = self.defence?;
        let is_placed = matches!(defence, Defence::ResizePad | Defence::Crops(_));
        let made = (!is_placed).then(|| defence.image(&to_image(image, size_px[0]), &Frame::whole(size_px)));
        Some(of_image(&made??))
    }

    /// Augments an image.
    pub fn apply(&self, image: &[Rgb], size_px: [u32; 2]) -> AugmentedImage {
        let (scale, offset_px) = self.placed(size_px);
        let is_still = scale == 1.0 && offset_px == [0.0, 0.0];
        let resample = (!is_still).then(|| Resample::new(size_px, scale, offset_px));
        let mut image = resample.as_ref().map_or_else(|| image.to_vec(), |r| r.forward(image));
        let blur = (self.blur_px > LEAST_BLUR_PX).then(|| blur(size_px, self.blur_px));
        if let Some(blur) = &blur {
            image = blur.forward(&image);
        }
        let mut rng = Pcg32::seed_from_u64(self.noise_seed);
        let mut slopes = vec![[0.0; 3]; image.len()];
        for (pixel, slopes) in image.iter_mut().zip(&mut slopes) {
            for ((value, slope), balance) in pixel.iter_mut().zip(slopes).zip(self.white_balance) {
                let noise = (self.noise > 0.0).then(|| self.noise * normal::draw(&mut rng));
                let (toned, derivative) = toned(*value, self.tone);
                *value = self.contrast * (balance * toned - 0.5) + 0.5 + self.brightness + noise.unwrap_or(0.0);
                if (0.0..=1.0).contains(value) {
                    *slope = balance * self.contrast * derivative;
                }
                *value = value.clamp(0.0, 1.0);
            }
        }
        if self.jpeg_quality < 100 {
            // It stays as it is where it cannot be encoded.
            let lossy = as_jpeg(&to_image(&image, size_px[0]), self.jpeg_quality);
            image = lossy.map_or(image, |lossy| of_image(&lossy));
        }
        image = self.defended(&image, size_px).unwrap_or(image);
        AugmentedImage {
            image,
            slopes,
            resample,
            blur,
        }
    }
}

/// Augmented image with the state of its vector–Jacobian product.
#[derive(Debug, Clone)]
pub struct AugmentedImage {
    pub image: Vec<Rgb>,
    /// Derivative of each value with respect to the one that it was made of; 0 where it is clipped.
    slopes: Vec<Rgb>,
    resample: Option<Resample>,
    blur: Option<Separable>,
}

impl AugmentedImage {
    /// Converts the gradient with respect to the augmented image to that with respect to the image before. Compression counts as no change, as do
    /// fewer bits and the median: they round or choose, and have no derivative that helps (Shin & Song 2017; "straight-through", Bengio et al. 2013; BPDA,
    /// Athalye et al. 2018).
    pub fn vjp(&self, mut gradient: Vec<Rgb>) -> Vec<Rgb> {
        for (pixel, slopes) in gradient.iter_mut().zip(&self.slopes) {
            *pixel = std::array::from_fn(|c| pixel[c] * slopes[c]);
        }
        if let Some(blur) = &self.blur {
            gradient = blur.transposed(&gradient);
        }
        match &self.resample {
            Some(resample) => resample.0.transposed(&gradient),
            None => gradient,
        }
    }
}

/// Value below which the derivative of a tone curve stays the same, since that of a root grows without bound.
const DARKEST: f64 = 0.01;

/// Applies a tone curve: returns the value and its derivative.
fn toned(value: f64, exponent: f64) -> (f64, f64) {
    if exponent == 1.0 {
        return (value, 1.0);
    }
    let value = value.max(0.0);
    let slope = exponent * value.max(DARKEST).powf(exponent - 1.0);
    (value.powf(exponent), slope)
}

/// Least standard deviation of a blur that is applied.
const LEAST_BLUR_PX: f64 = 0.2;

/// Creates a Gaussian blur, up to three standard deviations; the border is repeated.
fn blur(size_px: [u32; 2], sigma_px: f64) -> Separable {
    let reach = (3.0 * sigma_px).ceil() as i64;
    let kernel = |by: i64| (-0.5 * (by as f64 / sigma_px).powi(2)).exp();
    let sum: f64 = (-reach..=reach).map(kernel).sum();
    let taps = |size: u32| {
        let last = i64::from(size) - 1;
        let tap = |at: i64| {
            let first = (at - reach).clamp(0, last);
            let mut weights = vec![0.0; ((at + reach).clamp(0, last) - first + 1) as usize];
            for by in -reach..=reach {
                weights[((at + by).clamp(0, last) - first) as usize] += kernel(by) / sum;
            }
            let first = first as usize;
            Tap { first, weights }
        };
        (0..=last).map(tap).collect()
    };
    let [columns, rows] = size_px.map(taps);
    Separable::new(size_px.map(|side| side as usize), columns, rows)
}

/// Shifts cells cyclically to the right and down by parts of the whole, between cells linearly. Shifting by the negative is the transposed map. Of
/// several square patterns below each other each is shifted by itself.
pub fn rolled(cells: &[Rgb], columns: usize, shift_tiles: [f64; 2]) -> Vec<Rgb> {
    if shift_tiles == [0.0, 0.0] {
        return cells.to_vec();
    }
    let tap = |at: usize, count: usize, shift: f64| {
        let from = at as f64 - shift * count as f64;
        let (whole, part) = (from.floor(), from - from.floor());
        let index = |i: f64| (i.rem_euclid(count as f64) as usize) % count;
        [(index(whole), 1.0 - part), (index(whole + 1.0), part)]
    };
    let cell = |i: usize| {
        let above = i / (columns * columns) * columns;
        let across = tap(i % columns, columns, shift_tiles[0]);
        let mut sum = [0.0; 3];
        for (row, wy) in tap(i / columns - above, columns, shift_tiles[1]) {
            for (column, wx) in across {
                let value = cells[(above + row) * columns + column];
                sum = std::array::from_fn(|c| sum[c] + wx * wy * value[c]);
            }
        }
        sum
    };
    (0..cells.len()).map(cell).collect()
}
