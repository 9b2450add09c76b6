//! Published input transformations that remove the effect of an attack before a network runs.

mod frame;
mod pixels;

use image::RgbImage;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::as_jpeg;

pub use frame::Frame;

/// Published transformation of the input, with its amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defence {
    /// JPEG compression with this quality.
    Jpeg(u8),
    /// Rounding of each value to one of 2ⁿ levels.
    BitDepth(u8),
    /// Median over a square of this side, px.
    Median(u8),
    /// Enlargement by a random amount, and random padding with black.
    ResizePad,
    /// This number of random crops, whose detections are averaged.
    Crops(u8),
}

/// Kind of defence: its name, its default, minimum and maximum amount, its effect, and its source.
type Kind = (&'static str, Option<[u8; 3]>, &'static str, &'static str);

/// Kinds in the order of [`Defence`].
const KINDS: [Kind; 5] = [
    (
        "jpeg",
        Some([75, 1, 100]),
        "compressed as JPEG of this quality",
        "Dziugaite et al. 2016, Das et al. 2017; quality 75 as in Guo et al. 2018",
    ),
    (
        "bit-depth",
        Some([3, 1, 7]),
        "each value rounded to so many bits",
        "Xu et al. 2018; 3 bits as in Guo et al. 2018",
    ),
    (
        "median",
        Some([2, 2, 15]),
        "the median over a square of so many pixels a side",
        "Xu et al. 2018",
    ),
    (
        "resize-pad",
        None,
        "made 310 to 330 of 299 as large, padded with black to 331 of 299, at random",
        "Xie et al. 2018",
    ),
    (
        "crops",
        Some([30, 1, 100]),
        "the mean over so many random crops of 80 % of the sides",
        "Guo et al. 2018, who crop to 40 %",
    ),
];

/// Sizes by Xie et al.: images of 299 px are enlarged to 310 to 330 px, then padded to 331 px.
const RESIZED: [u32; 4] = [299, 310, 330, 331];

/// Side of a crop as a share of the picture's: a crop to 40 %, as of photos filled by one object, would cut off the object to be detected.
const CROP: f64 = 0.8;

impl Defence {
    /// Names without amounts.
    pub const NAMES: [&str; 5] = [KINDS[0].0, KINDS[1].0, KINDS[2].0, KINDS[3].0, KINDS[4].0];

    /// Parses a name with or without an amount, as in `jpeg` or `jpeg=50`.
    ///
    /// # Errors
    /// The fault, as a sentence.
    pub fn named(text: &str) -> Result<Self, String> {
        let (name, amount) = text.split_once('=').map_or((text, None), |(name, n)| (name, Some(n)));
        let Some(at) = KINDS.iter().position(|kind| kind.0 == name) else {
            let names = Self::NAMES.join(", ");
            return Err(format!(
                "there is no defence “{name}”: take one of {names}, or exec:PROGRAM"
            ));
        };
        let amount = match (KINDS[at].1, amount) {
            (None, None) => 0,
            (None, Some(_)) => return Err(format!("{name} has no amount: write {name} alone")),
            (Some([usual, ..]), None) => usual,
            (Some([usual, least, most]), Some(given)) => {
                let number = given.parse().ok().filter(|n| (least..=most).contains(n));
                number.ok_or_else(|| {
                    format!("{text}: give a whole number from {least} to {most}, as in {name}={usual}")
                })?
            }
        };
        Ok(match at {
            0 => Self::Jpeg(amount),
            1 => Self::BitDepth(amount),
            2 => Self::Median(amount),
            3 => Self::ResizePad,
            _ => Self::Crops(amount),
        })
    }

    /// Returns the name with its amount, as [`Defence::named`] parses it.
    pub fn name(self) -> String {
        let name = self.kind().0;
        match self {
            Self::Jpeg(n) | Self::BitDepth(n) | Self::Median(n) | Self::Crops(n) => format!("{name}={n}"),
            Self::ResizePad => name.to_owned(),
        }
    }

    /// Returns its effect, as the end of a sentence.
    pub fn does(self) -> &'static str {
        self.kind().2
    }

    /// Returns its source: authors and year.
    pub fn source(self) -> &'static str {
        self.kind().3
    }

    fn kind(self) -> Kind {
        KINDS[match self {
            Self::Jpeg(_) => 0,
            Self::BitDepth(_) => 1,
            Self::Median(_) => 2,
            Self::ResizePad => 3,
            Self::Crops(_) => 4,
        }]
    }

    /// Returns the frames that replace a picture of width × height `size`, px: mostly one. Random choices follow from `seed`.
    pub fn frames(self, size: [u32; 2], seed: u64) -> Vec<Frame> {
        let mut rng = Pcg32::seed_from_u64(seed);
        match self {
            Self::Jpeg(_) | Self::BitDepth(_) | Self::Median(_) => vec![Frame::whole(size)],
            Self::ResizePad => {
                let [from, least, most, padded] = RESIZED;
                let larger = rng.random_range(least..=most);
                let [resized, padded] = [larger, padded].map(|to| size.map(|side| side * to / from));
                let at = [0, 1].map(|i| rng.random_range(0..=padded[i] - resized[i]));
                vec![Frame::padded(size, resized, at, padded)]
            }
            Self::Crops(count) => {
                let part = size.map(|side| ((f64::from(side) * CROP).round() as u32).max(1));
                let mut crop = || Frame::crop([0, 1].map(|i| rng.random_range(0..=size[i] - part[i])), part);
                (0..count).map(|_| crop()).collect()
            }
        }
    }

    /// Returns the image of one of these frames; `None` if it cannot be encoded as JPEG.
    pub fn image(self, picture: &RgbImage, frame: &Frame) -> Option<RgbImage> {
        Some(match self {
            Self::Jpeg(quality) => as_jpeg(picture, quality)?,
            Self::BitDepth(bits) => pixels::rounded(picture, bits),
            Self::Median(side) => pixels::median(picture, side),
            Self::ResizePad | Self::Crops(_) => frame.cut(picture),
        })
    }
}
