//! When and how a photo was taken, as EXIF tells it.

use exif::{In, Reader, Tag};

/// What a reader of a report wants to know of a photo's taking; nothing where EXIF is silent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shot {
    /// `2026-05-01 12:30:05`, by the camera's clock.
    pub taken: Option<String>,
    /// `1/125 s, f/1.8, ISO 64`: as many of the three as are there.
    pub exposure: Option<String>,
}

/// Longer values are damaged ones.
const LONGEST: usize = 40;

impl Shot {
    /// Reads an EXIF block. Empty when it is damaged.
    pub(super) fn from_exif(block: Vec<u8>) -> Shot {
        let Ok(exif) = Reader::new().read_raw(block) else {
            return Shot::default();
        };
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
