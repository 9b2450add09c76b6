//! What an image from elsewhere may cost, by its use. Every image that this program decodes is measured here first, by its header.
//!
//! A few kilobytes can claim to be terabytes of pixels, and a progressive JPEG can make a decoder go over every pixel again for each scan,
//! which takes ten bytes. So five things are bounded: the file's bytes, its pixels, the scans, the pixels times the scans (the time), and what
//! decoding holds in memory. `docs/guide/limits.md` has the table, with what the worst image within each budget takes.

use super::problem::DecodeProblem;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    pub bytes: u64,
    pub megapixels: u64,
    /// Megapixels times scans, of a JPEG. A scan whose data is not there takes up to 3.5 ms a megapixel: decoders
    /// go on with zeros.
    pub scanned_megapixels: u64,
    /// What decoding may hold at once: the pixels, and the coefficients of a progressive JPEG.
    pub memory: u64,
}

impl Budget {
    /// Files that a user names, or lays into a watched folder: the largest cameras have 200 megapixels.
    pub const FILE: Budget = Budget {
        bytes: 512 << 20,
        megapixels: 250,
        scanned_megapixels: 2_000,
        memory: 1536 << 20,
    };

    /// What a browser sends. A phone's 50-megapixel JPEG has 15 MB.
    pub const UPLOAD: Budget = Budget {
        bytes: 32 << 20,
        megapixels: 120,
        scanned_megapixels: 600,
        memory: 512 << 20,
    };

    /// What may be held only to show an image small; JPEGs are decoded reduced for that.
    pub const PREVIEW_MEMORY: u64 = 256 << 20;

    /// No encoder makes more scans: libjpeg's usual script has 10, others stay below 20.
    pub const SCANS: u64 = 64;

    pub(super) fn check_bytes(&self, bytes: usize) -> Result<(), DecodeProblem> {
        if bytes as u64 <= self.bytes {
            return Ok(());
        }
        let (has, may) = (bytes >> 20, self.bytes >> 20);
        let size = format!("{has} MB, more than the {may} MB that an image may have here");
        Err(DecodeProblem::TooLarge(size))
    }

    pub fn check(&self, cost: &DecodeCost) -> Result<(), DecodeProblem> {
        let megapixels = cost.pixels / 1_000_000;
        if megapixels > self.megapixels {
            return Err(DecodeProblem::TooLarge(format!(
                "{megapixels} megapixels, more than the {} that fit in memory safely",
                self.megapixels
            )));
        }
        if cost.scans > cost.most_scans || cost.scans * megapixels > self.scanned_megapixels {
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

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecodeCost {
    pixels: u64,
    /// Bytes that the decoder writes for a pixel.
    bytes_per_pixel: u64,
    /// Bytes of coefficients, which are kept as long as the photo.
    kept: u64,
    /// 1 for what is no JPEG.
    scans: u64,
    most_scans: u64,
    /// By EXIF, by 90°: the turned image is another one.
    is_turned: bool,
}

impl DecodeCost {
    /// Of 8-bit RGB, the form that images end in.
    const RGB: u64 = 3;

    /// Of a JPEG of a width and height, so many components and scans, whose file has so many bytes.
    pub fn of_jpeg(size: [u32; 2], components: u64, scans: u64, is_progressive: bool, bytes: usize) -> DecodeCost {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        DecodeCost {
            pixels,
            bytes_per_pixel: DecodeCost::RGB,
            kept: match scans {
                // What is not zero, two bytes for the four bits of data or more that each takes, and eight bytes a block.
                0 | 1 => pixels * components / 8 + 4 * bytes as u64,
                // Coefficients of 2 bytes, one a pixel and component at most.
                _ => pixels * 2 * components,
            },
            scans,
            // A sequential frame has each component in one scan.
            most_scans: if is_progressive { Budget::SCANS } else { components },
            // It is made upright at once.
            is_turned: false,
        }
    }

    /// Of a PNG, whose decoder writes so many bytes for a pixel.
    pub fn of_png(size: [u32; 2], bytes_per_pixel: u64, is_turned: bool) -> DecodeCost {
        DecodeCost {
            pixels: u64::from(size[0]) * u64::from(size[1]),
            bytes_per_pixel,
            kept: 0,
            scans: 1,
            most_scans: 1,
            is_turned,
        }
    }

    pub(super) fn pixel_bytes(&self) -> u64 {
        self.pixels * self.bytes_per_pixel
    }

    /// What decoding at 1/`reduction` of the size holds at most, in bytes: while the decoder works, while its form is made into RGB, and while
    /// that is turned.
    pub(super) fn memory(&self, reduction: u32) -> u64 {
        let reduced = self.pixels / (u64::from(reduction) * u64::from(reduction));
        let decoding = self.kept + reduced * self.bytes_per_pixel;
        let forming = match self.bytes_per_pixel {
            DecodeCost::RGB => 0,
            other => reduced * (other + DecodeCost::RGB),
        };
        let turning = u64::from(self.is_turned) * reduced * 2 * DecodeCost::RGB;
        decoding.max(forming).max(turning)
    }
}
