//! Cameras without calibration: a pinhole guessed from a photo's EXIF data about its lens.

use std::ops::RangeInclusive;

use super::model::{Camera, Guess};
use scaleproof_photo::Lens;

/// Reason why no camera can be guessed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GuessError {
    #[error(
        "its EXIF data has no focal length that can be turned into pixels: use the original photo from the camera, or calibrate with a printed board"
    )]
    NoFocalLength,
    #[error(
        "its EXIF data gives two focal lengths, {a_px:.0} px and {b_px:.0} px, that contradict each other: calibrate with a printed board"
    )]
    Contradiction { a_px: f64, b_px: f64 },
    #[error(
        "it was taken with a digital zoom of {ratio:.2}, and EXIF does not say whether the focal length contains it: use a photo without zoom"
    )]
    DigitalZoom { ratio: f64 },
    #[error(
        "it is {width}×{height} but was recorded as {recorded_width}×{recorded_height}, so it was cropped: use the original photo"
    )]
    Cropped {
        width: u32,
        height: u32,
        recorded_width: u32,
        recorded_height: u32,
    },
    #[error(
        "it is {width}×{height}, a shape that no camera takes, so it was cropped or stitched: use the original photo"
    )]
    Shape { width: u32, height: u32 },
    #[error(
        "its EXIF data implies a sensor {mm:.2} mm wide, and such cameras have {least_mm} to {MOST_SENSOR_MM} mm: an editor made the photo smaller or cut it without saying so; use the original photo, or calibrate with a printed board"
    )]
    Sensor { mm: f64, least_mm: f64 },
    #[error(
        "its EXIF data implies a field of view of {deg:.1}°, and lenses have {least}° to {most}°: use the original photo, or calibrate with a printed board",
        least = VIEW_DEG.start(),
        most = VIEW_DEG.end()
    )]
    FieldOfView { deg: f64 },
}

/// Limits of a sensor's longer side: medium format has 53.9 mm, the front cameras of phones 1.4 mm (1/10 inch).
const MOST_SENSOR_MM: f64 = 60.0;
const LEAST_SENSOR_MM: f64 = 1.4;
/// Least longer side where EXIF states the pixel density: such cameras have 1/4 inch (3.2 mm) or more, and only that statement goes wrong when an
/// editor makes a photo smaller.
const LEAST_PITCHED_MM: f64 = 3.0;
/// Diagonal fields of view, from a telescope's (2400 mm on 36 × 24 mm) to a fisheye's, which no pinhole has.
const VIEW_DEG: RangeInclusive<f64> = 1.0..=160.0;
/// Aspect ratios (longer by shorter side) of cameras: 1:1, 8:7, 5:4, 4:3, 3:2, 16:10, 16:9; and the range of phones' whole screens.
const SHAPES: [f64; 7] = [1.0, 8.0 / 7.0, 5.0 / 4.0, 4.0 / 3.0, 3.0 / 2.0, 16.0 / 10.0, 16.0 / 9.0];
const SCREENS: RangeInclusive<f64> = 1.85..=2.4;
/// Aspect ratios of whole sensors, ascending; images of other ratios are mostly cropped from the first.
const SENSOR_SHAPES: [f64; 2] = [4.0 / 3.0, 3.0 / 2.0];
/// Error of a nominal focal length, percent. An iPhone 4S says 35 mm for 33.8 (36 mm by its longer side): 2 % beyond the rounding.
const NOMINAL_PERCENT: f64 = 2.0;

/// Effect of a focal length error, measured on synthetic views: 5 % move the azimuth by 0.23° in the median, and distances by 4.2 %.
const AZIMUTH_DEG_PER_PERCENT: f64 = 0.23 / 5.0;
const DISTANCE_PERCENT_PER_PERCENT: f64 = 4.2 / 5.0;

impl Guess {
    /// Returns the expected error of azimuths, in degrees (median).
    pub fn azimuth_deg(&self) -> f64 {
        self.focal_percent * AZIMUTH_DEG_PER_PERCENT
    }

    /// Returns the expected error of distances, in percent.
    pub fn distance_percent(&self) -> f64 {
        self.focal_percent * DISTANCE_PERCENT_PER_PERCENT
    }

    /// Returns the caution that applies to a pose made with a guessed camera.
    pub fn caution(&self) -> String {
        format!(
            "the camera is guessed from EXIF: distances ± {:.1} %, azimuths about {:.2}° off; calibrate for better ones",
            self.distance_percent(),
            self.azimuth_deg()
        )
    }
}

/// Focal length in pixels, and the bound of its error in percent.
type Focal = (f64, f64);

impl Camera {
    /// Guesses a pinhole for an upright photo of a size in pixels: square pixels, the principal point in the middle, the focal length from EXIF with
    /// a bound. Returns an error if the EXIF data lack it or contradict themselves.
    pub fn guessed(width: u32, height: u32, lens: &Lens) -> Result<Camera, GuessError> {
        // EXIF has 0 or no entry if no digital zoom was used. Phones crop by a few percent for stabilisation.
        let zoom = lens.digital_zoom.filter(|ratio| *ratio > 0.0).unwrap_or(1.0);
        if !(0.9..=1.1).contains(&zoom) {
            return Err(GuessError::DigitalZoom { ratio: zoom });
        }
        let resized = resized(width, height, lens)?;
        check_shape(width, height)?;
        let (a, b) = (from_35_mm(width, height, lens), from_sensor(resized, lens));
        check_sensor(width.max(height), lens, a, b)?;
        let (px, percent) = match (a, b) {
            (Some((a_px, a)), Some((b_px, b))) if (a_px / b_px - 1.0).abs() * 100.0 > a + b => {
                return Err(GuessError::Contradiction { a_px, b_px });
            }
            (Some(a), Some(b)) => [a, b][usize::from(b.1 < a.1)],
            (a, b) => a.or(b).ok_or(GuessError::NoFocalLength)?,
        };
        let deg = 2.0
            * (f64::from(width).hypot(f64::from(height)) / 2.0 / px)
                .atan()
                .to_degrees();
        if !VIEW_DEG.contains(&deg) {
            return Err(GuessError::FieldOfView { deg });
        }
        let percent = percent + (zoom - 1.0).abs() * 100.0;
        let centre = |side: u32| (f64::from(side) - 1.0) / 2.0;
        let camera = Camera {
            guess: Some(Guess {
                focal_percent: (percent * 10.0).ceil() / 10.0,
            }),
            ..Camera::pinhole(width, height, px, px, centre(width), centre(height))
        };
        camera.check().map_err(|_| GuessError::NoFocalLength)?;
        Ok(camera)
    }
}

/// Returns the scale of the photo relative to the image that the camera recorded; 1 if EXIF does not say.
fn resized(width: u32, height: u32, lens: &Lens) -> Result<f64, GuessError> {
    let Some((recorded_width, recorded_height)) = lens.recorded_px.filter(|(w, h)| *w > 0 && *h > 0) else {
        return Ok(1.0);
    };
    // EXIF gives the recorded orientation, some writers the upright one; so only the larger and the smaller side are compared.
    let (long, short) = (recorded_width.max(recorded_height), recorded_width.min(recorded_height));
    let recorded = Camera::pinhole(long, short, 1.0, 1.0, 0.0, 0.0);
    let larger = width.max(height);
    let scaled = recorded.scaled_to(larger, width.min(height));
    scaled.map_err(|_| GuessError::Cropped {
        width,
        height,
        recorded_width,
        recorded_height,
    })?;
    Ok(f64::from(larger) / f64::from(long))
}

/// Returns an error for a photo whose aspect ratio suggests cropping or stitching.
fn check_shape(width: u32, height: u32) -> Result<(), GuessError> {
    let by_shorter = f64::from(width.max(height)) / f64::from(width.min(height)).max(1.0);
    let is_likely = SCREENS.contains(&by_shorter) || is_shaped(width, height, &SHAPES);
    is_likely.then_some(()).ok_or(GuessError::Shape { width, height })
}

/// Returns an error if the focal length in mm and in px imply a sensor size that no camera has: by the pixel pitch if EXIF has it, else by the 35 mm
/// equivalent.
fn check_sensor(
    longer_px: u32,
    lens: &Lens,
    by_35_mm: Option<Focal>,
    by_pitch: Option<Focal>,
) -> Result<(), GuessError> {
    let least_mm = by_pitch.map_or(LEAST_SENSOR_MM, |_| LEAST_PITCHED_MM);
    let focal_mm = lens.focal_mm.filter(|mm| *mm > 0.0);
    let Some(((px, _), focal_mm)) = by_pitch.or(by_35_mm).zip(focal_mm) else {
        return Ok(());
    };
    let mm = f64::from(longer_px) * focal_mm / px;
    let is_likely = (least_mm..=MOST_SENSOR_MM).contains(&mm);
    is_likely.then_some(()).ok_or(GuessError::Sensor { mm, least_mm })
}

/// Returns true if the sides are in one of these proportions, within 1 % and the rounding to whole pixels.
fn is_shaped(width: u32, height: u32, shapes: &[f64]) -> bool {
    let (long, short) = (f64::from(width.max(height)), f64::from(width.min(height)));
    let fits = |shape: &f64| (long / (short * shape) - 1.0).abs() <= 0.01 + 1.0 / short;
    shapes.iter().any(fits)
}

/// Estimates the focal length from its 35 mm equivalent: the one with the same field of view on a frame of 36 × 24 mm.
///
/// CIPA DCG-001 compares diagonals; some makers compare long sides instead. Photos of another shape than a sensor's, as phones' 16:9, are mostly
/// cropped from 4:3, and the equivalent then refers to the diagonal of the whole sensor. The estimate uses the sensor's diagonal; its distance from
/// the other readings counts as uncertainty, beside the rounding to whole millimetres and the error of nominal values.
fn from_35_mm(width: u32, height: u32, lens: &Lens) -> Option<Focal> {
    // Some cameras write tens of thousands here.
    let equivalent_mm = lens.equivalent_35_mm.filter(|f| (5.0..=1500.0).contains(f))?;
    let (long, short) = (f64::from(width.max(height)), f64::from(width.min(height)));
    let sensor = if is_shaped(width, height, &SENSOR_SHAPES) {
        [long, short]
    } else {
        [long.max(short * SENSOR_SHAPES[0]), short.max(long / SENSOR_SHAPES[0])]
    };
    let by_diagonal_px = |[long, short]: [f64; 2]| equivalent_mm * long.hypot(short) / 36f64.hypot(24.0);
    let px = by_diagonal_px(sensor);
    let readings = [by_diagonal_px([long, short]), equivalent_mm * sensor[0] / 36.0];
    let furthest = readings
        .iter()
        .map(|reading| (reading / px - 1.0).abs())
        .fold(0.0, f64::max);
    let rounding = 50.0 / equivalent_mm;
    Some((px, rounding + furthest * 100.0 + NOMINAL_PERCENT + focus_percent(lens)))
}

/// Estimates the focal length in px from the focal length in mm and the pixels per mm of the sensor.
fn from_sensor(resized: f64, lens: &Lens) -> Option<Focal> {
    let (focal_mm, px_per_mm) = (lens.focal_mm?, lens.sensor_px_per_mm?);
    // Sensors have pixels of 0.5 to 20 µm.
    if !(50.0..=2000.0).contains(&px_per_mm) || !(0.5..=2000.0).contains(&focal_mm) {
        return None;
    }
    let percent = NOMINAL_PERCENT + focus_percent(lens);
    Some((focal_mm * px_per_mm * resized, percent))
}

/// Returns the growth of the image distance by focusing, percent: f / (d − f) of the focal length (thin lens), at d = 0.5 m. Without a focal length
/// in mm, that of a phone's main camera is assumed.
fn focus_percent(lens: &Lens) -> f64 {
    const NEAR_MM: f64 = 500.0;
    let focal_mm = lens.focal_mm.unwrap_or(7.0).clamp(1.0, NEAR_MM / 2.0);
    100.0 * focal_mm / (NEAR_MM - focal_mm)
}
