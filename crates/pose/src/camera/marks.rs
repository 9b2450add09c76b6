//! What no format has a place for, in comments that every format allows: that a camera is a guess, and standard deviations.

use super::{Camera, CameraFault, Guess, yaml};

const GUESS: &str = "# scaleproof: focal length guessed from EXIF, within percent: ";
const SIGMA: &str = "# scaleproof: standard deviations of fx, fy, cx, cy in px: ";

/// The comment lines of a camera, each with its line end; none when there is nothing to say.
pub(super) fn write(camera: &Camera) -> String {
    let guess = camera.guess.map(|guess| (GUESS, yaml::list(&[guess.focal_percent])));
    let sigma = camera.sigma_px.map(|sigma| (SIGMA, yaml::list(&sigma)));
    let lines = guess.into_iter().chain(sigma);
    lines.map(|(mark, numbers)| format!("{mark}{numbers}\n")).collect()
}

/// The camera with what the comments of its file say. A mark whose number was spoilt is refused: without it a guess would
/// pass for a calibration.
pub(super) fn read(text: &str, camera: Camera) -> Result<Camera, CameraFault> {
    let guess = numbers::<1>(text, GUESS)?.map(|[focal_percent]| Guess { focal_percent });
    Ok(Camera {
        guess,
        sigma_px: numbers::<4>(text, SIGMA)?,
        ..camera
    })
}

fn numbers<const N: usize>(text: &str, mark: &'static str) -> Result<Option<[f64; N]>, CameraFault> {
    let Some(list) = text.lines().find_map(|line| line.trim().strip_prefix(mark.trim_end())) else {
        return Ok(None);
    };
    let numbers: Option<Vec<f64>> = list.split(',').map(|word| word.trim().parse().ok()).collect();
    numbers
        .filter(|numbers| numbers.iter().all(|v| v.is_finite() && *v >= 0.0))
        .and_then(|numbers| numbers.try_into().ok())
        .map(Some)
        .ok_or(CameraFault::Comment { mark, count: N })
}
