//! EXIF data of a photo: its lens, and the time and exposure of the shot.

use exif::{Exif, In, Reader, Tag, Value};
use image::metadata::Orientation;

/// Reads an EXIF block (Exif 2.32, 4.6: a TIFF structure); `None` if there is none or nothing of it can be read.
///
/// A fault affects only the part that contains it: piexif, for one, omits the end of each inner directory, which invalidates no value before it.
pub(super) fn read(block: Option<&[u8]>) -> Option<Exif> {
    match Reader::new().continue_on_error(true).read_raw(block?.to_vec()) {
        Err(exif::Error::PartialResult(partial)) => Some(partial.into_inner().0),
        read => read.ok(),
    }
}

/// Returns the orientation from an EXIF block (Exif 2.32, 4.6.4: Orientation, 1 to 8); none if it is missing or unreadable, which is no reason to
/// refuse the image.
pub(super) fn orientation(block: Option<&[u8]>) -> Orientation {
    let stated = read(block).and_then(|exif| whole(&exif, Tag::Orientation));
    let known = stated.and_then(|number| Orientation::from_exif(u8::try_from(number).ok()?));
    known.unwrap_or(Orientation::NoTransforms)
}

/// Tags from which a focal length in pixels can be derived; all absent without EXIF data. Nothing is checked: cameras write strange numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lens {
    /// FocalLengthIn35mmFilm.
    pub equivalent_35_mm: Option<f64>,
    /// FocalLength.
    pub focal_mm: Option<f64>,
    /// FocalPlaneXResolution with its unit.
    pub sensor_px_per_mm: Option<f64>,
    /// DigitalZoomRatio.
    pub digital_zoom: Option<f64>,
    /// PixelXDimension and PixelYDimension: the size at which the camera recorded the photo.
    pub recorded_px: Option<(u32, u32)>,
}

impl Lens {
    pub(super) fn from_exif(exif: Exif) -> Lens {
        let number = |tag| number(&exif, tag);
        let integer = |tag| whole(&exif, tag);
        // FocalPlaneResolutionUnit: 2 inch (the default), 3 centimetre; some write 4 and 5 for mm and µm.
        let unit_mm = match integer(Tag::FocalPlaneResolutionUnit) {
            None | Some(2) => Some(25.4),
            Some(3) => Some(10.0),
            Some(4) => Some(1.0),
            Some(5) => Some(0.001),
            Some(_) => None,
        };
        let per_unit = number(Tag::FocalPlaneXResolution);
        Lens {
            equivalent_35_mm: number(Tag::FocalLengthIn35mmFilm),
            focal_mm: number(Tag::FocalLength),
            sensor_px_per_mm: per_unit.zip(unit_mm).map(|(per_unit, unit_mm)| per_unit / unit_mm),
            digital_zoom: number(Tag::DigitalZoomRatio),
            recorded_px: integer(Tag::PixelXDimension).zip(integer(Tag::PixelYDimension)),
        }
    }
}

/// Returns the first number of a tag, of any stored type: the standard names one or two types for each tag, and cameras and editors write others.
/// `None` for text and for an empty value.
fn number(exif: &Exif, tag: Tag) -> Option<f64> {
    let number = match &exif.get_field(tag, In::PRIMARY)?.value {
        Value::Byte(all) => f64::from(*all.first()?),
        Value::Short(all) => f64::from(*all.first()?),
        Value::Long(all) => f64::from(*all.first()?),
        Value::SByte(all) => f64::from(*all.first()?),
        Value::SShort(all) => f64::from(*all.first()?),
        Value::SLong(all) => f64::from(*all.first()?),
        Value::Rational(all) => all.first()?.to_f64(),
        Value::SRational(all) => all.first()?.to_f64(),
        Value::Float(all) => f64::from(*all.first()?),
        Value::Double(all) => *all.first()?,
        Value::Ascii(_) | Value::Undefined(..) | Value::Unknown(..) => return None,
    };
    number.is_finite().then_some(number)
}

/// Returns a tag's [`number`] if it is whole and not negative.
fn whole(exif: &Exif, tag: Tag) -> Option<u32> {
    let number = number(exif, tag)?;
    (number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number)).then_some(number as u32)
}

/// Time and exposure of a photo, for reports; empty if EXIF does not have them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shot {
    /// `2026-05-01 12:30:05`, by the camera's clock.
    pub taken: Option<String>,
    /// Exposure as `1/125 s, f/1.8, ISO 64`: as many of the three as are present.
    pub exposure: Option<String>,
}

/// Maximum length of a value; longer ones are damaged.
const LONGEST: usize = 40;

impl Shot {
    pub(super) fn from_exif(exif: Exif) -> Shot {
        let shown = |tag, unit: &str| {
            let text = exif.get_field(tag, In::PRIMARY)?.display_value().to_string();
            let is_good = (1..=LONGEST).contains(&text.len()) && !text.chars().any(char::is_control);
            is_good.then(|| format!("{text}{unit}"))
        };
        let aperture = shown(Tag::FNumber, "").map(|number| format!("f/{number}"));
        let iso = shown(Tag::PhotographicSensitivity, "").map(|number| format!("ISO {number}"));
        let exposure = [shown(Tag::ExposureTime, " s"), aperture, iso];
        let exposure: Vec<String> = exposure.into_iter().flatten().collect();
        Shot {
            taken: shown(Tag::DateTimeOriginal, ""),
            exposure: (!exposure.is_empty()).then(|| exposure.join(", ")),
        }
    }
}
