//! A camera without calibration: a pinhole from what a photo's EXIF data says about its lens.

use super::Camera;
use scaleproof_photo::photo::Lens;

/// How far a guessed focal length may be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guess {
    /// The true focal length lies within plus or minus so many percent.
    pub focal_percent: f64,
}

/// Why no camera can be guessed.
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
}

/// Measured on synthetic views: a focal length 5 % off moves the azimuth by 0.23° in the
/// median, and distances by 4.2 %.
const AZIMUTH_DEG_PER_PERCENT: f64 = 0.23 / 5.0;
const DISTANCE_PERCENT_PER_PERCENT: f64 = 4.2 / 5.0;

impl Guess {
    /// What the guess does to azimuths, in degrees (median).
    pub fn azimuth_deg(&self) -> f64 {
        self.focal_percent * AZIMUTH_DEG_PER_PERCENT
    }

    /// What the guess does to distances, in percent.
    pub fn distance_percent(&self) -> f64 {
        self.focal_percent * DISTANCE_PERCENT_PER_PERCENT
    }

    /// What to know before believing a pose made with a guessed camera.
    pub fn caution(&self) -> String {
        format!(
            "the camera is guessed from EXIF: distances ± {:.1} %, azimuths about {:.2}° off; calibrate for better ones",
            self.distance_percent(),
            self.azimuth_deg()
        )
    }
}

/// A focal length in pixels and its bound in percent.
type Focal = (f64, f64);

impl Camera {
    /// A pinhole for an upright photo of a size in pixels: square pixels, the principal point in the middle, the focal
    /// length from EXIF with a bound. Refuses EXIF data that lack it or contradict themselves.
    pub fn guessed(width: u32, height: u32, lens: &Lens) -> Result<Camera, GuessError> {
        // EXIF: 0 or nothing where no digital zoom was used. Phones crop by a few percent for stabilisation.
        let zoom = lens.digital_zoom.filter(|ratio| *ratio > 0.0).unwrap_or(1.0);
        if !(0.9..=1.1).contains(&zoom) {
            return Err(GuessError::DigitalZoom { ratio: zoom });
        }
        let resized = resized(width, height, lens)?;
        let (a, b) = (from_35_mm(width, height, lens), from_sensor(resized, lens));
        let (px, percent) = match (a, b) {
            (Some((a_px, a)), Some((b_px, b))) if (a_px / b_px - 1.0).abs() * 100.0 > a + b => {
                return Err(GuessError::Contradiction { a_px, b_px });
            }
            (Some(a), Some(b)) => [a, b][usize::from(b.1 < a.1)],
            (a, b) => a.or(b).ok_or(GuessError::NoFocalLength)?,
        };
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

/// How much smaller the photo is than what the camera recorded; 1 when EXIF does not say.
fn resized(width: u32, height: u32, lens: &Lens) -> Result<f64, GuessError> {
    let Some((recorded_width, recorded_height)) = lens.recorded_px.filter(|(w, h)| *w > 0 && *h > 0) else {
        return Ok(1.0);
    };
    // EXIF counts as recorded, and some writers as upright; only the larger and the smaller side are compared.
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

/// From the 35 mm equivalent: the focal length that would see as much on a frame of 36 × 24 mm.
///
/// CIPA DCG-001 compares diagonals; some makers compare long sides instead. The difference counts as uncertainty, beside the
/// rounding to whole millimetres.
fn from_35_mm(width: u32, height: u32, lens: &Lens) -> Option<Focal> {
    // Cameras are known that write tens of thousands here.
    let equivalent_mm = lens.equivalent_35_mm.filter(|f| (5.0..=1500.0).contains(f))?;
    let diagonal_px = f64::from(width).hypot(f64::from(height));
    let px = equivalent_mm * diagonal_px / 36f64.hypot(24.0);
    let by_long_side_px = equivalent_mm * f64::from(width.max(height)) / 36.0;
    let rounding = 50.0 / equivalent_mm;
    let percent = rounding + (by_long_side_px / px - 1.0).abs() * 100.0 + focus_percent(lens);
    Some((px, percent))
}

/// From the focal length in mm and the pixels per mm of the sensor.
fn from_sensor(resized: f64, lens: &Lens) -> Option<Focal> {
    /// A lens is named by a rounded focal length.
    const NOMINAL_PERCENT: f64 = 2.0;
    let (focal_mm, px_per_mm) = (lens.focal_mm?, lens.sensor_px_per_mm?);
    // Sensors have pixels of 0.5 to 20 µm.
    if !(50.0..=2000.0).contains(&px_per_mm) || !(0.5..=2000.0).contains(&focal_mm) {
        return None;
    }
    let percent = NOMINAL_PERCENT + focus_percent(lens);
    Some((focal_mm * px_per_mm * resized, percent))
}

/// A lens that focuses near moves away from the sensor: at distance d by f / (d − f) of its focal length (thin lens), here
/// at half a metre. Without the focal length in mm, that of a phone's main camera is taken.
fn focus_percent(lens: &Lens) -> f64 {
    const NEAR_MM: f64 = 500.0;
    let focal_mm = lens.focal_mm.unwrap_or(7.0).clamp(1.0, NEAR_MM / 2.0);
    100.0 * focal_mm / (NEAR_MM - focal_mm)
}
