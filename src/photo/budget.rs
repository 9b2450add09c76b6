//! What a picture from elsewhere may cost, by its use. Every picture that this program decodes is measured here first, by its header.
//!
//! A few kilobytes can claim to be terabytes of pixels, and a progressive JPEG can make a decoder go over every pixel again for each scan,
//! which takes ten bytes. So five things are bounded: the file's bytes, its pixels, the scans, the pixels times the scans (the time), and what
//! decoding holds in memory. The README has the table, with what the worst picture within each budget takes.

use super::{DecodeProblem, Outline};

/// The bounds of one use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Of the file.
    pub bytes: u64,
    pub megapixels: u64,
    /// Megapixels times scans, of a JPEG. A scan of nothing but zeros takes up to 0.6 ms a megapixel.
    pub scanned_megapixels: u64,
    /// What decoding may hold at once: the pixels, and the coefficients of a progressive JPEG.
    pub memory: u64,
}

impl Budget {
    /// Files that a user names, or lays into a watched folder: the largest cameras have 200 megapixels.
    pub const FILE: Budget = Budget {
        bytes: 512 << 20,
        megapixels: 250,
        scanned_megapixels: 2_500,
        memory: 1536 << 20,
    };

    /// What a browser sends. A phone's 50-megapixel JPEG has 15 MB.
    pub const UPLOAD: Budget = Budget {
        bytes: 32 << 20,
        megapixels: 120,
        scanned_megapixels: 1_200,
        memory: 512 << 20,
    };

    /// What may be held only to show a picture small; JPEGs are decoded reduced for that.
    pub const PREVIEW_MEMORY: u64 = 256 << 20;

    /// No encoder makes more scans: libjpeg's usual script has 10, others stay below 20.
    pub const SCANS: u64 = 64;

    pub(super) fn check_bytes(&self, bytes: usize) -> Result<(), DecodeProblem> {
        match bytes as u64 > self.bytes {
            true => Err(DecodeProblem::TooLarge(format!(
                "{} MB, more than the {} MB that a picture may have here",
                bytes >> 20,
                self.bytes >> 20
            ))),
            false => Ok(()),
        }
    }

    pub(super) fn check(&self, cost: &Cost) -> Result<(), DecodeProblem> {
        let megapixels = cost.pixels / 1_000_000;
        if megapixels > self.megapixels {
            return Err(DecodeProblem::TooLarge(format!(
                "{megapixels} megapixels, more than the {} that fit in memory safely",
                self.megapixels
            )));
        }
        if cost.scans > Budget::SCANS || cost.scans * megapixels > self.scanned_megapixels {
            return Err(DecodeProblem::TooManyScans(cost.scans));
        }
        let memory = cost.memory(1);
        if memory > self.memory {
            return Err(DecodeProblem::TooLarge(format!(
                "{megapixels} megapixels that take {} MB to decode, more than {} MB",
                memory >> 20,
                self.memory >> 20
            )));
        }
        Ok(())
    }
}

/// What decoding a picture takes, as its header says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cost {
    pub pixels: u64,
    /// Bytes that the decoder writes for a pixel.
    pub bytes_per_pixel: u64,
    /// 1 for what is no JPEG.
    pub scans: u64,
    /// Coefficients that are kept until the last scan: of a progressive JPEG three a pixel at most, of 2 bytes.
    pub is_progressive: bool,
}

impl Cost {
    /// Of 8-bit RGB, the form that pictures end in.
    const RGB: u64 = 3;

    /// Of a JPEG of width × height `size`.
    pub fn of_jpeg(size: [u32; 2], outline: &Outline) -> Cost {
        Cost {
            pixels: u64::from(size[0]) * u64::from(size[1]),
            bytes_per_pixel: Cost::RGB,
            scans: outline.scans,
            is_progressive: outline.is_progressive,
        }
    }

    /// Of a PNG, whose decoder writes so many bytes for a pixel.
    pub fn of_png(size: [u32; 2], bytes_per_pixel: u64) -> Cost {
        Cost {
            pixels: u64::from(size[0]) * u64::from(size[1]),
            bytes_per_pixel,
            scans: 1,
            is_progressive: false,
        }
    }

    /// What decoding at 1/`reduction` of the size holds, in bytes.
    pub fn memory(&self, reduction: u32) -> u64 {
        let coefficients = if self.is_progressive { 6 } else { 0 };
        // Another form than RGB is made into it while both are there.
        let form = match self.bytes_per_pixel {
            Cost::RGB => 0,
            _ => Cost::RGB,
        };
        let reduced = u64::from(reduction) * u64::from(reduction);
        self.pixels * coefficients + self.pixels * (self.bytes_per_pixel + form) / reduced
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photos_of_real_cameras_are_within_and_bombs_are_not() {
        let jpeg = |megapixels: u64, scans: u64, is_progressive: bool| Cost {
            pixels: megapixels * 1_000_000,
            bytes_per_pixel: 3,
            scans,
            is_progressive,
        };
        for (budget, cost, is_within) in [
            (Budget::FILE, jpeg(200, 1, false), true),
            (Budget::FILE, jpeg(108, 10, true), true),
            (Budget::FILE, jpeg(251, 1, false), false),
            (Budget::FILE, jpeg(12, 65, true), false),
            (Budget::FILE, jpeg(200, 20, true), false),
            (Budget::UPLOAD, jpeg(50, 10, true), true),
            (Budget::UPLOAD, jpeg(108, 1, false), true),
            (Budget::UPLOAD, jpeg(121, 1, false), false),
            (Budget::UPLOAD, jpeg(108, 10, true), false),
        ] {
            assert_eq!(budget.check(&cost).is_ok(), is_within, "{budget:?} {cost:?}");
        }
    }
}
