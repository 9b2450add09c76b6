//! Checks that a gradient of another program is the derivative of its loss: along some directions it is compared with
//! central differences.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::{ImageLoss, WhiteBoxError};

/// Least loss whose differences do not drown in rounding.
pub(super) const LEAST_LOSS: f64 = 0.01;
/// Two requests about the same image may differ so much, relatively: a graphics card adds in another order each time.
const SAME: f64 = 1e-3;
/// A derivative may be off by so much of the gradient's length.
const TOLERANCE: f64 = 0.05;
/// Directions that do not depend on the gradient: what it leaves out shows there.
const ANYWHERE: u64 = 3;
/// Values nearer to black or white are not moved: a program may clip there.
const MARGIN: f64 = 0.05;
/// Largest change of a value, growing until the loss changes by [`ENOUGH`].
const STEPS: [f64; 5] = [0.0005, 0.002, 0.008, 0.02, 0.04];
const ENOUGH: f64 = 0.05;
/// A difference of two losses in 32 bits may be off by so much.
const ROUNDING: f64 = 2e-6;

type Rgb = [f64; 3];

/// Says what is wrong with a program's gradient; `first` is what it says of `image`. Of a partial gradient only sign and scale
/// are checked, along itself.
pub(super) fn fault(
    image: &[Rgb],
    first: &ImageLoss,
    is_partial: bool,
    mut look: impl FnMut(&[Rgb]) -> Result<Option<ImageLoss>, WhiteBoxError>,
) -> Result<Option<String>, WhiteBoxError> {
    let mut loss = |image: &[Rgb]| Ok::<f64, WhiteBoxError>(look(image)?.map_or(0.0, |seen| seen.loss));
    let again = loss(image)?;
    if (again - first.loss).abs() > SAME * first.loss {
        return Ok(Some(format!(
            "its loss of one image is {:.6} and, asked again, {again:.6}: is it set to training, or does it draw at random?",
            first.loss
        )));
    }
    let own = masked(image, |i, c| first.gradient[i][c]);
    let length = dot(&own, &own).sqrt();
    if length == 0.0 {
        return Ok(Some(format!(
            "its gradient is 0 at every pixel, and its loss is {:.6}: no gradient passes rounding to 8 bits, detached tensors and chosen boxes",
            first.loss
        )));
    }
    let own: Vec<Rgb> = own.iter().map(|p| p.map(|v| v / length)).collect();
    let along = Along::measure(image, own, &first.gradient, &mut loss)?;
    if is_partial {
        return Ok(along.is_far_off().then(|| along.wrong_scale()));
    }
    let mut all = vec![along];
    for seed in 0..ANYWHERE {
        let mut rng = Pcg32::seed_from_u64(seed);
        let mut sign = || if rng.random::<bool>() { 1.0 } else { -1.0 };
        let signs: Vec<Rgb> = image.iter().map(|_| [sign(), sign(), sign()]).collect();
        let direction = masked(image, |i, c| signs[i][c]);
        all.push(Along::measure(image, direction, &first.gradient, &mut loss)?);
    }
    Ok(sentence(&all, length))
}

/// A direction in which values near black and white stay.
fn masked(image: &[Rgb], value: impl Fn(usize, usize) -> f64) -> Vec<Rgb> {
    let moves = |v: f64| (MARGIN..=1.0 - MARGIN).contains(&v);
    let of = |(i, pixel): (usize, &Rgb)| std::array::from_fn(|c| if moves(pixel[c]) { value(i, c) } else { 0.0 });
    image.iter().enumerate().map(of).collect()
}

fn dot(a: &[Rgb], b: &[Rgb]) -> f64 {
    let of_pixel = |(a, b): (&Rgb, &Rgb)| (0..3).map(|c| a[c] * b[c]).sum::<f64>();
    a.iter().zip(b).map(of_pixel).sum()
}

/// The derivative along one direction.
struct Along {
    /// Derivative by the gradient.
    said: f64,
    /// Derivatives by differences of growing steps, each with what rounding may do to it.
    found: Vec<[f64; 2]>,
}

impl Along {
    fn measure(
        image: &[Rgb],
        direction: Vec<Rgb>,
        gradient: &[Rgb],
        loss: &mut impl FnMut(&[Rgb]) -> Result<f64, WhiteBoxError>,
    ) -> Result<Along, WhiteBoxError> {
        let largest = direction.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mut found = Vec::new();
        for step in STEPS.map(|step| step / largest.max(f64::MIN_POSITIVE)) {
            let mut moved = |by: f64| {
                let pixels = image.iter().zip(&direction);
                let pixels: Vec<Rgb> = pixels.map(|(p, d)| std::array::from_fn(|c| p[c] + by * d[c])).collect();
                loss(&pixels)
            };
            let difference = moved(step)? - moved(-step)?;
            found.push([difference, ROUNDING].map(|v| v / (2.0 * step)));
            if difference.abs() > ENOUGH {
                break;
            }
        }
        let said = dot(gradient, &direction);
        Ok(Along { said, found })
    }

    /// Returns whether the gradient, divided by a factor, is the derivative.
    fn agrees(&self, factor: f64, length: f64) -> bool {
        let tolerance = TOLERANCE * (length / factor).abs();
        let is_near = |[found, rounding]: &[f64; 2]| (self.said / factor - found).abs() <= tolerance + rounding;
        self.found.iter().any(is_near)
    }

    /// Returns whether it is not even about half to twice the derivative.
    fn is_far_off(&self) -> bool {
        !(0.5..=2.0).contains(&(self.said / self.best())) && !self.agrees(1.0, self.said)
    }

    /// Describes a gradient whose direction alone is right by the two derivatives.
    fn wrong_scale(&self) -> String {
        let factor = self.said / self.best();
        let is_about = |scale: f64| (factor.abs() / scale - 1.0).abs() < 2.0 * TOLERANCE;
        let sign = if factor < 0.0 { ", and the wrong sign" } else { "" };
        let measured = self.measured();
        if !factor.is_finite() {
            format!("its loss does not change along its gradient ({measured})")
        } else if factor < 0.0 && is_about(1.0) {
            format!("its gradient has the wrong sign: it points to where the loss falls ({measured})")
        } else if is_about(255.0) || is_about(1.0 / 255.0) {
            format!("its gradient has the wrong scale{sign}: values go from 0 to 1 here, and not to 255 ({measured})")
        } else {
            format!(
                "its gradient has the wrong scale{sign}: it is {factor:.4} times the derivative of its loss ({measured})"
            )
        }
    }

    fn measured(&self) -> String {
        let (found, said) = (self.best(), self.said);
        format!("along it the loss changes by {found:.4e} a unit, and it says {said:.4e}")
    }

    /// The difference that rounding spoils least.
    fn best(&self) -> f64 {
        self.found.last().map_or(0.0, |[found, _]| *found)
    }
}

/// Describes a gradient of a length by the directions, of which the first is its own.
fn sentence(all: &[Along], length: f64) -> Option<String> {
    let agree = |factor: f64| all.iter().all(|along| along.agrees(factor, length));
    if agree(1.0) {
        return None;
    }
    let own = all.first()?;
    let factor = own.said / own.best();
    Some(if factor.is_finite() && agree(factor) {
        own.wrong_scale()
    } else {
        format!(
            "its gradient is not the derivative of its loss: {}; are channels, rows and columns those of the image, and does it pass everything that the \
             loss depends on? A hello with \"gradients\": \"partial\" says that it leaves out a part on purpose",
            own.measured()
        )
    })
}
