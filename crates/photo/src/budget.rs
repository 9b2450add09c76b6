//! Limits on the cost of foreign images, by their use. Every image that this program decodes is first checked here, by its header.
//!
//! A few kilobytes can claim to be terabytes of pixels, and each scan of a progressive JPEG, which takes ten bytes, can make a decoder process every
//! pixel again. So five values are bounded: the file's bytes, its pixels, the scans, the pixels times the scans (the time), and the memory for
//! decoding. `docs/guide/limits.md` has the table, with the cost of the worst image within each budget.

use super::error::DecodeProblem;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    pub bytes: u64,
    pub megapixels: u64,
    /// Megapixels times scans, of a JPEG. A scan without data takes up to 3.5 ms per megapixel: decoders continue with zeros.
    pub scanned_megapixels: u64,
    /// Maximum memory for decoding, bytes: the pixels, and the coefficients of a progressive JPEG.
    pub memory: u64,
}

impl Budget {
    /// Budget of files that a user names, or puts into a watched folder: the largest cameras have 200 megapixels.
    pub const FILE: Budget = Budget {
        bytes: 512 << 20,
        megapixels: 250,
        scanned_megapixels: 2_000,
        memory: 1536 << 20,
    };

    /// Budget of uploads from a browser. A phone's 50-megapixel JPEG has 15 MB.
    pub const UPLOAD: Budget = Budget {
        bytes: 32 << 20,
        megapixels: 120,
        scanned_megapixels: 600,
        memory: 512 << 20,
    };

    /// Maximum memory for showing an image at a small size; JPEGs are decoded reduced for that.
    pub const PREVIEW_MEMORY: u64 = 256 << 20;

    /// Maximum number of scans: libjpeg's usual script has 10, others stay below 20.
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
    /// Bytes that the decoder writes per pixel.
    bytes_per_pixel: u64,
    /// Bytes of coefficients, kept as long as the photo.
    kept: u64,
    /// Number of scans; 1 if it is not a JPEG.
    scans: u64,
    most_scans: u64,
    /// True if EXIF turns the image by 90° in a separate step, into a second buffer.
    is_turned: bool,
}

impl DecodeCost {
    /// Bytes per pixel of 8-bit RGB, the final form of images.
    const RGB: u64 = 3;

    /// Returns the cost of a JPEG of a width and height, with this number of components and scans, from a file of `bytes` bytes.
    pub fn of_jpeg(size: [u32; 2], components: u64, scans: u64, is_progressive: bool, bytes: usize) -> DecodeCost {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        DecodeCost {
            pixels,
            bytes_per_pixel: DecodeCost::RGB,
            kept: match scans {
                // Non-zero values: two bytes for each four or more bits of data, and eight bytes per block.
                0 | 1 => pixels * components / 8 + 4 * bytes as u64,
                // Coefficients of 2 bytes, at most one per pixel and component.
                _ => pixels * 2 * components,
            },
            scans,
            // A sequential frame has each component in one scan.
            most_scans: if is_progressive { Budget::SCANS } else { components },
            // Turned while its pixels are made, without a second buffer.
            is_turned: false,
        }
    }

    /// Returns the cost of a PNG whose decoder writes this number of bytes per pixel.
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

    /// Returns the maximum memory of decoding at 1/`reduction` of the size, in bytes: while the decoder works, while its output is converted to RGB,
    /// and while that is turned.
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
