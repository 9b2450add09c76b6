//! A photo: its file, its header, and its pixels at the size and place needed.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use image::{GrayImage, RgbImage, imageops};

use super::budget::Budget;
use super::decode::{Header, heif_kind};
use super::error::{DecodeProblem, PhotoError};
use super::exif_tags::{Lens, Shot};
use super::jpeg::{Coefficients, Colours, REDUCTIONS};
use super::luma::{JpegLuma, Luma};
use super::orientation::{turned_deg, turned_to_sensor};
use super::{exif_tags, heif, resize};
use scaleproof_core::files;

/// Photo whose file is read and hashed and whose header is parsed. The data of a JPEG is decoded once, when pixels are first requested; damage inside
/// is found then. Pixels of any size are computed from the decoded coefficients.
#[derive(Debug)]
pub struct Photo {
    path: PathBuf,
    bytes: Vec<u8>,
    /// SHA-256 of the file, hex; for an HEIC file of its PNG.
    pub sha256: String,
    /// Width of the upright photo, px.
    pub width: u32,
    /// Height of the upright photo, px.
    pub height: u32,
    /// Clockwise rotation, by EXIF, that makes the sensor's image upright: 0, 90, 180 or 270. A mirrored image is mirrored back in addition.
    pub turned_deg: u32,
    exif: Option<Vec<u8>>,
    header: Header,
    budget: Budget,
    coefficients: OnceLock<Coefficients>,
}

impl Photo {
    /// Reads a JPEG or PNG file, regardless of its name; an HEIC file as a PNG, if the system has a decoder. Returns an error for a truncated JPEG;
    /// [`Photo::note`] reports one whose data is complete.
    pub fn open(path: &Path) -> Result<Photo, PhotoError> {
        let bytes = files::read_at_most(path, Budget::FILE.bytes)?;
        let is_heif = heif_kind(&bytes).is_some();
        let Some(png) = (if is_heif { heif::as_png(path, &bytes)? } else { None }) else {
            return Photo::from_bytes(path, bytes, Budget::FILE);
        };
        // Its pixels are upright; the camera needs the sensor's orientation.
        let exif = heif::exif(&bytes);
        Ok(Photo {
            turned_deg: turned_deg(exif_tags::orientation(exif.as_deref())),
            exif,
            ..Photo::from_bytes(path, png, Budget::FILE)?
        })
    }

    /// Reads a JPEG or PNG from bytes in memory, within a budget; `path` is their name in messages.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>, budget: Budget) -> Result<Photo, PhotoError> {
        let mut header = Header::read(&bytes, &budget).map_err(|problem| problem.at(path))?;
        let [width, height] = header.upright_size();
        let coefficients = OnceLock::new();
        if header.lacks_end() {
            // Only decoding shows if it is complete.
            let read = header.coefficients(&bytes, &budget);
            let read = read.map_err(|problem| match problem {
                DecodeProblem::Damaged(_) => DecodeProblem::Truncated.at(path),
                other => other.at(path),
            })?;
            if let Some(read) = read {
                coefficients.get_or_init(|| read);
            }
        }
        Ok(Photo {
            path: path.to_owned(),
            sha256: files::sha256_hex(&bytes),
            bytes,
            width,
            height,
            turned_deg: turned_deg(header.orientation),
            exif: header.exif.take(),
            header,
            budget,
            coefficients,
        })
    }

    /// Returns the file's bytes as they were read.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the file's bytes as they were read, without a copy.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Returns the lens data from EXIF.
    pub fn lens(&self) -> Lens {
        exif_tags::read(self.exif.as_deref())
            .map(Lens::from_exif)
            .unwrap_or_default()
    }

    /// Returns time and exposure from EXIF.
    pub fn shot(&self) -> Shot {
        exif_tags::read(self.exif.as_deref())
            .map(Shot::from_exif)
            .unwrap_or_default()
    }

    /// Returns the memory in bytes for decoding at 1/`reduction` of the size.
    pub fn memory(&self, reduction: u32) -> u64 {
        self.header.cost.memory(reduction)
    }

    /// Returns a harmless peculiarity of its file, as a sentence.
    pub fn note(&self) -> Option<String> {
        let path = self.path.display();
        let sentence = || format!("{path} has no end-of-image marker, as a copy that was cut; its data is complete");
        self.header.lacks_end().then(sentence)
    }

    /// Returns `jpg` or `png`, by the content.
    pub fn extension(&self) -> &'static str {
        if self.header.colours().is_some() { "jpg" } else { "png" }
    }

    /// Returns true for a JPEG for print, whose colours depend on a printer.
    pub fn is_cmyk(&self) -> bool {
        matches!(self.header.colours(), Some(Colours::Cmyk | Colours::Ycck))
    }

    /// Returns luma at full size, upright: the Y' that a JPEG stores (ITU-T T.871), else computed from the colours. Every tag and every board is
    /// measured on it.
    pub fn luma(&self) -> Result<GrayImage, PhotoError> {
        match self.coefficients()? {
            Some(coefficients) if self.header.has_luma() => Ok(coefficients.luma(1, self.header.orientation)),
            _ => Ok(imageops::grayscale(&self.rgb(1)?)),
        }
    }

    /// Returns luma at full size, upright, as [`Photo::luma`]; if a JPEG stores it, pixels are computed only where they are read.
    ///
    /// # Errors
    /// As [`Photo::luma`]: damage shows here.
    pub fn luma_where_seen(&self) -> Result<Box<dyn Luma + '_>, PhotoError> {
        let size = [self.width, self.height];
        Ok(match self.coefficients()? {
            Some(coefficients) if self.header.has_luma() => {
                Box::new(JpegLuma::new(coefficients, self.header.orientation, size))
            }
            _ => Box::new(self.luma()?),
        })
    }

    /// Returns a JPEG's coefficients, read when they are first needed; `None` for a PNG.
    fn coefficients(&self) -> Result<Option<&Coefficients>, PhotoError> {
        if let Some(read) = self.coefficients.get() {
            return Ok(Some(read));
        }
        let read = self.header.coefficients(&self.bytes, &self.budget);
        let read = read.map_err(|e| e.at(&self.path))?;
        Ok(read.map(|read| self.coefficients.get_or_init(|| read)))
    }

    /// Returns luma in the sensor's own frame, not rotated by EXIF: one camera model is valid for photos in any orientation.
    pub fn sensor_luma(&self) -> Result<GrayImage, PhotoError> {
        Ok(turned_to_sensor(self.luma()?, self.turned_deg))
    }

    /// Returns colours at 1/`reduction` of the size, upright; `reduction` is 1 or a result of [`Photo::reduction`].
    pub fn rgb(&self, reduction: u32) -> Result<RgbImage, PhotoError> {
        match self.coefficients()? {
            Some(coefficients) => Ok(coefficients.rgb(reduction, self.header.orientation)),
            None => self.header.png(&self.bytes, &self.budget).map_err(|e| e.at(&self.path)),
        }
    }

    /// Returns the colours resized as [`opencv_linear`](crate::opencv_linear) does the whole photo, computing only the rows it reads; `None` if all would be computed
    /// anyway: for a PNG, a photo that is not upright, or one that is hardly reduced.
    pub fn rgb_opencv_linear(&self, size: [u32; 2]) -> Result<Option<RgbImage>, PhotoError> {
        let is_upright = self.header.orientation == image::metadata::Orientation::NoTransforms;
        let wanted = resize::opencv_linear_rows([self.width, self.height], size).filter(|_| is_upright);
        let (Some(wanted), Some(coefficients)) = (wanted, self.coefficients()?) else {
            return Ok(None);
        };
        let found = coefficients.rgb_rows(|row| wanted[row]);
        Ok(Some(resize::opencv_linear_of(&found, &wanted, self.width, size)))
    }

    /// Returns the strongest reduction, of 8, 4, 2 and 1, that still leaves `least` pixels (width, height) of the upright image.
    ///
    /// Only divisors of both sides: a reduced pixel is then exactly a square of the photo's pixels, up to the border.
    pub fn reduction(&self, least: [u32; 2]) -> u32 {
        let side_serves = |r: u32, side: u32, least: u32| side.is_multiple_of(r) && side / r >= least;
        let serves = |r: &u32| side_serves(*r, self.width, least[0]) && side_serves(*r, self.height, least[1]);
        let found = REDUCTIONS.into_iter().find(serves);
        found.filter(|_| self.header.has_luma()).unwrap_or(1)
    }
}
