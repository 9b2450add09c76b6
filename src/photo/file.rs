//! A picture file whose pixels are decoded only as far as somebody needs them.

use std::path::{Path, PathBuf};

use image::metadata::Orientation;
use image::{DynamicImage, GrayImage, ImageDecoder, RgbImage};
use zune_core::colorspace::ColorSpace;

use super::heif;
use super::{
    Budget, Cost, DecodeProblem, Kind, Outline, PhotoError, converted, damaged, decode, jpeg_header, jpeg_pixels,
    lies_across, orientation_of, png_header, turned_deg,
};
use crate::files;

/// How much smaller a JPEG can be decoded: its blocks of 8 × 8 pixels come back as 1 × 1, 2 × 2 or 4 × 4.
const REDUCTIONS: [u32; 3] = [8, 4, 2];

/// A photo's file, read, hashed and its header understood. Damage inside shows when it is decoded.
#[derive(Debug)]
pub struct PhotoFile {
    path: PathBuf,
    bytes: Vec<u8>,
    /// SHA-256 of the file, hex; of an HEIC file that of its PNG.
    pub sha256: String,
    /// Of the upright picture, in pixels.
    pub width: u32,
    pub height: u32,
    /// How far EXIF turned the picture clockwise: 0, 90, 180 or 270.
    pub turned_deg: u32,
    orientation: Orientation,
    budget: Budget,
    cost: Cost,
    /// `None` for a PNG.
    jpeg: Option<Outline>,
    /// A JPEG that keeps brightness by itself, as almost all do: the others are CMYK or plain RGB.
    has_luma: bool,
}

impl PhotoFile {
    /// Reads a JPEG or PNG file, whatever its name says; an HEIC file as a PNG, where the system has a decoder. A cut JPEG is refused here
    /// already.
    pub fn open(path: &Path) -> Result<PhotoFile, PhotoError> {
        let bytes = files::read_at_most(path, Budget::FILE.bytes)?;
        let Some(picture) = converted(path, &bytes)? else {
            return PhotoFile::of_bytes(path, bytes, Budget::FILE);
        };
        // Its pixels are upright; how the sensor lay is for the camera.
        let turned_deg = turned_deg(orientation_of(heif::exif(&bytes).as_deref()));
        let upright = PhotoFile::of_bytes(path, picture, Budget::FILE)?;
        Ok(PhotoFile { turned_deg, ..upright })
    }

    /// The same of bytes that are in memory, within a budget; `path` is what messages call them.
    pub fn of_bytes(path: &Path, bytes: Vec<u8>, budget: Budget) -> Result<PhotoFile, PhotoError> {
        let header = Header::of(&bytes, &budget).map_err(|problem| problem.at(path))?;
        let [width, height] = match lies_across(header.orientation) {
            true => [header.size[1], header.size[0]],
            false => header.size,
        };
        Ok(PhotoFile {
            path: path.to_owned(),
            sha256: files::sha256_hex(&bytes),
            bytes,
            width,
            height,
            turned_deg: turned_deg(header.orientation),
            orientation: header.orientation,
            budget,
            cost: header.cost,
            jpeg: header.jpeg,
            has_luma: header.has_luma,
        })
    }

    /// The file's bytes as they were read.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The same, without a copy.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// What holding the picture at 1/`reduction` of its size takes while it is decoded, in bytes.
    pub fn memory(&self, reduction: u32) -> u64 {
        self.cost.memory(reduction)
    }

    /// `jpg` or `png`, by the content.
    pub fn extension(&self) -> &'static str {
        match self.jpeg {
            Some(_) => "jpg",
            None => "png",
        }
    }

    /// Brightness at full size, upright: the Y' that a JPEG keeps (ITU-T T.871), else made from the colours. Decoding it alone
    /// takes less than half the time of decoding colours too.
    pub fn grey(&self) -> Result<GrayImage, PhotoError> {
        let Some(outline) = self.jpeg.filter(|_| self.has_luma) else {
            return Ok(image::imageops::grayscale(&self.rgb(1)?));
        };
        let luma = || {
            let (pixels, [width, height], _) = jpeg_pixels(&self.bytes, &outline, ColorSpace::Luma, &self.budget)?;
            GrayImage::from_raw(width, height, pixels).ok_or_else(|| damaged("it is no grey picture"))
        };
        let mut picture = DynamicImage::from(luma().map_err(|problem| problem.at(&self.path))?);
        picture.apply_orientation(self.orientation);
        Ok(picture.into_luma8())
    }

    /// Colours at 1/`reduction` of the size, upright; `reduction` is 1 or what [`PhotoFile::reduction`] gave.
    pub fn rgb(&self, reduction: u32) -> Result<RgbImage, PhotoError> {
        let full_size = || Ok(decode(&self.bytes, &self.budget)?.rgb);
        if reduction == 1 {
            return full_size().map_err(|problem: DecodeProblem| problem.at(&self.path));
        }
        let [width, height] = [self.width / reduction, self.height / reduction];
        let stored = match lies_across(self.orientation) {
            true => [height, width],
            false => [width, height],
        };
        let picture = reduced(&self.bytes, stored).and_then(|reduced| match reduced {
            Some(reduced) => {
                let mut picture = DynamicImage::from(reduced);
                picture.apply_orientation(self.orientation);
                Ok(picture.into_rgb8())
            }
            None => Ok(image::imageops::thumbnail(&full_size()?, width, height)),
        });
        picture.map_err(|problem| problem.at(&self.path))
    }

    /// The strongest reduction, of 8, 4, 2 and 1, that still leaves `least` pixels (width, height) of the upright picture.
    ///
    /// Only what divides both sides: then a reduced pixel is exactly a square of the photo's pixels, up to the border.
    pub fn reduction(&self, least: [u32; 2]) -> u32 {
        let serves = |r: &u32| {
            self.width.is_multiple_of(*r)
                && self.height.is_multiple_of(*r)
                && self.width / r >= least[0]
                && self.height / r >= least[1]
        };
        match self.has_luma {
            true => REDUCTIONS.into_iter().find(serves).unwrap_or(1),
            false => 1,
        }
    }
}

/// What stands at the beginning of a picture file.
struct Header {
    /// Width, height as stored.
    size: [u32; 2],
    cost: Cost,
    orientation: Orientation,
    jpeg: Option<Outline>,
    has_luma: bool,
}

impl Header {
    fn of(bytes: &[u8], budget: &Budget) -> Result<Header, DecodeProblem> {
        let (size, cost, exif, jpeg, has_luma) = match Kind::of(bytes)? {
            Kind::Jpeg(outline) => {
                let (decoder, size, cost) = jpeg_header(bytes, &outline, ColorSpace::RGB, budget)?;
                let colours = decoder.input_colorspace();
                let has_luma = matches!(colours, Some(ColorSpace::YCbCr | ColorSpace::Luma));
                (size, cost, decoder.exif().cloned(), Some(outline), has_luma)
            }
            Kind::Png => {
                let (mut decoder, cost) = png_header(bytes, budget)?;
                let (width, height) = decoder.dimensions();
                let exif = decoder.exif_metadata().ok().flatten();
                ([width, height], cost, exif, None, false)
            }
        };
        Ok(Header {
            size,
            cost,
            orientation: orientation_of(exif.as_deref()),
            jpeg,
            has_luma,
        })
    }
}

/// A JPEG decoded at a half, a quarter or an eighth of its stored width and height (scaled inverse DCT). `None` for the rare
/// kinds that only the other decoder reads. The same damage is refused as at full size.
fn reduced(bytes: &[u8], [width, height]: [u32; 2]) -> Result<Option<RgbImage>, DecodeProblem> {
    let mut decoder = jpeg_decoder::Decoder::new(bytes);
    // A JPEG's sides fit 16 bits.
    let asked = (width as u16, height as u16);
    let decoded = decoder
        .scale(asked.0, asked.1)
        .and_then(|size| Ok((size, decoder.decode()?)));
    let (size, mut pixels) = match decoded {
        Ok(decoded) => decoded,
        Err(jpeg_decoder::Error::Unsupported(_)) => return Ok(None),
        Err(e) => return Err(damaged(e)),
    };
    let count = width as usize * height as usize;
    if pixels.len() == count {
        pixels = pixels.iter().flat_map(|grey| [*grey; 3]).collect();
    }
    match size == asked && pixels.len() == 3 * count {
        true => Ok(RgbImage::from_raw(width, height, pixels)),
        false => Err(damaged("its header contradicts itself")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::jpeg::JpegEncoder;

    /// A JPEG of 64 × 48 pixels in a file, its left half red.
    fn half_red(folder: &Path) -> PathBuf {
        let picture = RgbImage::from_fn(64, 48, |x, _| {
            image::Rgb(if x < 32 { [200, 30, 20] } else { [90, 100, 110] })
        });
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, 95)
            .encode_image(&picture)
            .unwrap();
        let path = folder.join("photo.jpg");
        std::fs::write(&path, bytes).unwrap();
        path
    }

    #[test]
    fn a_reduced_picture_shows_the_same_at_each_size() {
        let folder = tempfile::tempdir().unwrap();
        let file = PhotoFile::open(&half_red(folder.path())).unwrap();
        assert_eq!((file.width, file.height), (64, 48));
        for reduction in [1, 2, 4, 8] {
            let picture = file.rgb(reduction).unwrap();
            assert_eq!(picture.dimensions(), (64 / reduction, 48 / reduction));
            let [left, right] = [8, 56].map(|x| picture.get_pixel(x / reduction, 24 / reduction).0);
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
        let file = PhotoFile::open(&half_red(folder.path())).unwrap();
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
        assert_eq!(PhotoFile::open(&png).unwrap().reduction([1, 1]), 1);
    }

    #[test]
    fn brightness_alone_is_that_of_the_colours() {
        let folder = tempfile::tempdir().unwrap();
        let file = PhotoFile::open(&half_red(folder.path())).unwrap();
        let (grey, rgb) = (file.grey().unwrap(), file.rgb(1).unwrap());
        for (grey, rgb) in grey.pixels().zip(rgb.pixels()) {
            // ITU-T T.871, from rounded and clipped colours.
            let [r, g, b] = rgb.0.map(f64::from);
            let luma = 0.299 * r + 0.587 * g + 0.114 * b;
            assert!((f64::from(grey.0[0]) - luma).abs() <= 2.0, "{grey:?} {rgb:?}");
        }
    }
}
