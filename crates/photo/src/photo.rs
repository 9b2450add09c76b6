//! Photos: decoded upright and only as far as somebody needs them, or refused with the reason. A file is never written back.

mod budget;
mod decode;
mod encode;
mod heif;
mod jpeg;
mod lens;
mod luma;
mod problem;
mod resize;
mod shot;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use image::{GrayImage, RgbImage, imageops};

use decode::{Header, heif_kind, orientation_of, turned_deg};
use scaleproof_core::files;

pub use budget::Budget;
pub use decode::open_png;
pub use encode::{as_jpeg, preview_jpeg};
pub use heif::reads_heif;
use jpeg::Coefficients;
pub use lens::Lens;
use luma::JpegLuma;
pub use luma::Luma;
pub use resize::{boxed, opencv_linear, shrunk};
use shot::Shot;

/// Why a photo could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // each variant is its sentence
pub enum PhotoError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("{path} is not a JPEG or PNG image: use a photo straight from the camera", path = path.display())]
    NotAnImage { path: PathBuf },
    #[error("{}", convert_sentence(path, kind))]
    Heif { path: PathBuf, kind: &'static str },
    #[error("{path} ends in the middle of the image: copy it from the camera again", path = path.display())]
    Truncated { path: PathBuf },
    #[error("{path} has {size}: scale it down", path = path.display())]
    TooLarge { path: PathBuf, size: String },
    #[error("{path} is a JPEG of {scans} scans, which no camera writes and which take too long to decode: save it again", path = path.display())]
    TooManyScans { path: PathBuf, scans: u64 },
    #[error("{path} cannot be decoded ({reason}): copy it from the camera again", path = path.display())]
    Damaged { path: PathBuf, reason: String },
}

/// What to do with an image of another kind that phones make.
fn convert_sentence(path: &Path, kind: &str) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let how = match kind {
        "HEIC" => "set the iPhone to Settings › Camera › Formats › Most Compatible, or convert it",
        _ => "convert it to JPEG",
    };
    format!(
        "{} is {} {kind} image, which this program does not read: {how} with `heif-dec '{name}' '{stem}.jpg'` (Debian: apt install \
         libheif-examples, where it may be called heif-convert), and see that it stands upright",
        path.display(),
        if kind == "AVIF" { "an" } else { "a" },
    )
}

/// How much smaller a JPEG can be decoded: its blocks of 8 × 8 pixels come back as 1 × 1, 2 × 2 or 4 × 4.
pub const REDUCTIONS: [u32; 3] = [8, 4, 2];

/// A photo: its file is read and hashed and its header understood. The data of a JPEG is decoded once, when pixels are first requested;
/// damage inside shows then. Pixels of any size follow from what is kept of it.
#[derive(Debug)]
pub struct Photo {
    path: PathBuf,
    bytes: Vec<u8>,
    /// SHA-256 of the file, hex; of an HEIC file that of its PNG.
    pub sha256: String,
    /// Width of the upright photo, px.
    pub width: u32,
    /// Height of the upright photo, px.
    pub height: u32,
    /// How far EXIF turns the sensor's image clockwise to make it upright: 0, 90, 180 or 270. A mirrored image is mirrored back besides.
    pub turned_deg: u32,
    /// Its EXIF block, if it has one.
    exif: Option<Vec<u8>>,
    header: Header,
    budget: Budget,
    coefficients: OnceLock<Coefficients>,
}

impl Photo {
    /// Reads a JPEG or PNG file, whatever its name says; an HEIC file as a PNG, where the system has a decoder. A cut JPEG is refused here
    /// already.
    pub fn open(path: &Path) -> Result<Photo, PhotoError> {
        let bytes = files::read_at_most(path, Budget::FILE.bytes)?;
        let converted = match heif_kind(&bytes) {
            Some(_) => heif::as_png(path, &bytes)?,
            None => None,
        };
        let Some(png) = converted else {
            return Photo::from_bytes(path, bytes, Budget::FILE);
        };
        // Its pixels are upright; how the sensor lay is for the camera.
        let exif = heif::exif(&bytes);
        Ok(Photo {
            turned_deg: turned_deg(orientation_of(exif.as_deref())),
            exif,
            ..Photo::from_bytes(path, png, Budget::FILE)?
        })
    }

    /// Reads a JPEG or PNG from bytes in memory, within a budget; `path` is what messages call them.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>, budget: Budget) -> Result<Photo, PhotoError> {
        let (header, exif) = Header::of(&bytes, &budget).map_err(|problem| problem.at(path))?;
        let [width, height] = header.upright_size();
        Ok(Photo {
            path: path.to_owned(),
            sha256: files::sha256_hex(&bytes),
            bytes,
            width,
            height,
            turned_deg: turned_deg(header.orientation),
            exif,
            header,
            budget,
            coefficients: OnceLock::new(),
        })
    }

    /// The file's bytes as they were read.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The file's bytes as they were read, without a copy.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// What EXIF says about the lens.
    pub fn lens(&self) -> Lens {
        self.exif.clone().map(Lens::from_exif).unwrap_or_default()
    }

    /// When and how it was taken, as EXIF says.
    pub fn shot(&self) -> Shot {
        self.exif.clone().map(Shot::from_exif).unwrap_or_default()
    }

    /// How many bytes decoding at 1/`reduction` of the size holds.
    pub fn memory(&self, reduction: u32) -> u64 {
        self.header.cost.memory(reduction)
    }

    /// `jpg` or `png`, by the content.
    pub fn extension(&self) -> &'static str {
        self.header.extension()
    }

    /// A JPEG for print, whose colours depend on a printer.
    pub fn is_cmyk(&self) -> bool {
        self.header.is_cmyk()
    }

    /// Luma at full size, upright: the Y' that a JPEG stores (ITU-T T.871), else computed from the colours. Every tag and every board is
    /// measured on it.
    pub fn luma(&self) -> Result<GrayImage, PhotoError> {
        match self.coefficients()? {
            Some(coefficients) if self.header.has_luma() => Ok(coefficients.luma(1, self.header.orientation)),
            _ => Ok(imageops::grayscale(&self.rgb(1)?)),
        }
    }

    /// Luma at full size, upright, as of [`Photo::luma`]; where a JPEG stores it, pixels are only computed where somebody looks.
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

    /// What a JPEG's data says, read when it is first needed; `None` for a PNG.
    fn coefficients(&self) -> Result<Option<&Coefficients>, PhotoError> {
        if let Some(read) = self.coefficients.get() {
            return Ok(Some(read));
        }
        let read = self.header.coefficients(&self.bytes, &self.budget);
        Ok(match read.map_err(|e| e.at(&self.path))? {
            Some(read) => Some(self.coefficients.get_or_init(|| read)),
            None => None,
        })
    }

    /// Luma in the sensor's own frame, which EXIF's turn does not touch: one camera holds for photos held any way.
    pub fn sensor_luma(&self) -> Result<GrayImage, PhotoError> {
        let upright = self.luma()?;
        Ok(match self.turned_deg {
            90 => imageops::rotate270(&upright),
            180 => imageops::rotate180(&upright),
            270 => imageops::rotate90(&upright),
            _ => upright,
        })
    }

    /// Colours at 1/`reduction` of the size, upright; `reduction` is 1 or what [`Photo::reduction`] gave.
    pub fn rgb(&self, reduction: u32) -> Result<RgbImage, PhotoError> {
        match self.coefficients()? {
            Some(coefficients) => Ok(coefficients.rgb(reduction, self.header.orientation)),
            None => {
                let decoded = self.header.png(&self.bytes, &self.budget);
                decoded.map_err(|e| e.at(&self.path))
            }
        }
    }

    /// The strongest reduction, of 8, 4, 2 and 1, that still leaves `least` pixels (width, height) of the upright image.
    ///
    /// Only what divides both sides: then a reduced pixel is exactly a square of the photo's pixels, up to the border.
    pub fn reduction(&self, least: [u32; 2]) -> u32 {
        let serves = |r: &u32| {
            self.width.is_multiple_of(*r)
                && self.height.is_multiple_of(*r)
                && self.width / r >= least[0]
                && self.height / r >= least[1]
        };
        if self.header.has_luma() {
            REDUCTIONS.into_iter().find(serves).unwrap_or(1)
        } else {
            1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::jpeg::JpegEncoder;

    /// A JPEG of 64 × 48 pixels in a file, its left half red.
    fn half_red(folder: &Path) -> PathBuf {
        let image = RgbImage::from_fn(64, 48, |x, _| {
            image::Rgb(if x < 32 { [200, 30, 20] } else { [90, 100, 110] })
        });
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, 95)
            .encode_image(&image)
            .unwrap();
        let path = folder.join("photo.jpg");
        std::fs::write(&path, bytes).unwrap();
        path
    }

    #[test]
    fn a_reduced_picture_shows_the_same_at_each_size() {
        let folder = tempfile::tempdir().unwrap();
        let file = Photo::open(&half_red(folder.path())).unwrap();
        assert_eq!((file.width, file.height), (64, 48));
        for reduction in [1, 2, 4, 8] {
            let image = file.rgb(reduction).unwrap();
            assert_eq!(image.dimensions(), (64 / reduction, 48 / reduction));
            let [left, right] = [8, 56].map(|x| image.get_pixel(x / reduction, 24 / reduction).0);
            let near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 4);
            assert!(
                near(left, [200, 30, 20]) && near(right, [90, 100, 110]),
                "{left:?} {right:?}"
            );
        }
    }

    #[test]
    fn the_strongest_reduction_that_serves_is_chosen() {
        let folder = tempfile::tempdir().unwrap();
        let file = Photo::open(&half_red(folder.path())).unwrap();
        let chosen = |least| file.reduction(least);
        assert_eq!(
            [
                chosen([8, 6]),
                chosen([9, 6]),
                chosen([32, 24]),
                chosen([33, 1]),
                chosen([65, 1])
            ],
            [8, 4, 2, 1, 1]
        );
        let png = folder.path().join("photo.png");
        file.rgb(1).unwrap().save(&png).unwrap();
        assert_eq!(Photo::open(&png).unwrap().reduction([1, 1]), 1);
    }

    #[test]
    fn luma_alone_is_that_of_the_colours() {
        let folder = tempfile::tempdir().unwrap();
        let file = Photo::open(&half_red(folder.path())).unwrap();
        let (luma, rgb) = (file.luma().unwrap(), file.rgb(1).unwrap());
        for (stored, rgb) in luma.pixels().zip(rgb.pixels()) {
            // ITU-T T.871, from rounded and clipped colours.
            let [r, g, b] = rgb.0.map(f64::from);
            let luma = 0.299 * r + 0.587 * g + 0.114 * b;
            assert!((f64::from(stored.0[0]) - luma).abs() <= 2.0, "{stored:?} {rgb:?}");
        }
    }
}
