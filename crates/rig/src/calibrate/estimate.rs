//! Calibration from the corners seen: outliers, model ladder, uncertainty.

use nalgebra::{DMatrix, Point3};

use super::board_photo::{BoardPhoto, UnusedPhoto};
use super::error::CalibrationError;
use super::film::Film;
use super::fit::{CameraFit, View};
use super::result::{COVERAGE, Calibration, PhotoResult};
use super::shutter::{Motion, ReadOut};
use super::target::Target;
use super::{doubt, jackknife, ladder, model, outliers, uncertainty};
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::Camera;

/// Calibrates a camera from the corners seen: bad photos are left out, every model of the ladder is fitted, the smallest
/// whose held-out error is as good as the best is taken.
///
/// # Errors
/// Photos do not determine a camera; the sentence says what to photograph.
pub fn calibrate(
    board_photos: Vec<BoardPhoto>,
    left_out: Vec<UnusedPhoto>,
    board: &Definition,
) -> Result<Calibration, CalibrationError> {
    fitted(board_photos, left_out, Target::Board(board), &Motion::new())
}

/// Calibrates as [`calibrate`], from a video. The tags of a scene give no more than the focal length, the principal point, k1 and k2; the standard
/// deviations contain the possible effect of a rolling shutter.
///
/// # Errors
/// Frames do not determine a camera; the sentence says what to film.
pub fn calibrate_film(film: Film, target: Target) -> Result<Calibration, CalibrationError> {
    fitted(film.frames, film.left_out, target, &film.motion)
}

fn fitted(
    board_photos: Vec<BoardPhoto>,
    left_out: Vec<UnusedPhoto>,
    target: Target,
    motion: &Motion,
) -> Result<Calibration, CalibrationError> {
    let places = target.corners_mm();
    let (board_photos, mut left_out) = doubt::alike(board_photos, left_out);
    doubt::enough(&board_photos, &left_out, target)?;
    let size = board_photos[0].size;
    let read_out = read_out(&board_photos, size, &places, motion);
    let board_photos = match read_out {
        Some(read_out) => read_out.taken_back(board_photos, motion),
        None => board_photos,
    };
    let cleaned = outliers::clean(board_photos, size, &places).ok_or_else(CalibrationError::no_fit)?;
    left_out.extend(cleaned.dropped);
    let views: Vec<View> = cleaned.board_photos.iter().map(|s| s.view(&places)).collect();
    doubt::seen_from_several_sides(&cleaned.first, target)?;
    let mut models = ladder::fit_ladder(target.models(), cleaned.first, size, &views);
    let chosen = ladder::choose(&models).ok_or_else(CalibrationError::no_fit)?;
    let fit = models[chosen].fit.clone();
    doubt::determined(&models, chosen, &views, target)?;
    doubt::fits(&fit, &views, size, target)?;
    let scatter = fit.covariance(fit.model, &views).ok_or_else(CalibrationError::no_fit)?;
    let (covariance, focal_raised) = jackknife::raised(scatter.clone(), &fit, &views, !motion.is_empty());
    let covariance = match motion.is_empty() {
        true => covariance,
        false => covariance + jackknife::alike(&scatter, &fit, &views),
    };
    let covariance = match read_out {
        Some(read_out) => read_out.raised(covariance, &fit, &views, &cleaned.board_photos, motion),
        None => covariance,
    };
    let middle_mm = target.middle_mm();
    ladder::compare(&mut models, chosen, middle_mm);
    let photos = photo_results(&cleaned.board_photos, &fit, &views, middle_mm);
    let coverage = coverage(&photos, size);
    let map = uncertainty::map(&fit, &covariance, size);
    let sigmas = sigmas(&fit, &covariance);
    let mut camera = Camera::from_parameters(size, &fit.camera);
    camera.sigma_px = Some([sigmas[0], sigmas[1], sigmas[2], sigmas[3]]);
    let mut result = Calibration {
        board: match target {
            Target::Board(board) => Some(board.clone()),
            Target::Scene(_) => None,
        },
        camera,
        sigmas,
        rms_px: fit.rms_px(&views),
        models,
        chosen,
        photos,
        left_out,
        lost_corners: cleaned.lost_corners,
        coverage,
        map,
        focal_raised,
        cautions: Vec::new(),
    };
    result.cautions = doubt::cautions(&result);
    Ok(result)
}

/// Estimates the read-out from photos whose corners move; `None` where none do, or nothing fits.
fn read_out(photos: &[BoardPhoto], size: (u32, u32), places: &[Point3<f64>], motion: &Motion) -> Option<ReadOut> {
    if motion.is_empty() {
        return None;
    }
    let cleaned = outliers::clean(photos.to_vec(), size, places)?;
    let views: Vec<View> = cleaned.board_photos.iter().map(|photo| photo.view(places)).collect();
    let judge = outliers::judge(&cleaned.first, size, &views)?;
    Some(ReadOut::of(&judge, &views, &cleaned.board_photos, motion))
}

fn sigmas(fit: &CameraFit, covariance: &DMatrix<f64>) -> [f64; model::ALL] {
    let numbers = fit.model.parameters_to_numbers();
    let variances = (&numbers * covariance * numbers.transpose()).diagonal();
    std::array::from_fn(|i| variances[i].max(0.0).sqrt())
}

fn photo_results(
    board_photos: &[BoardPhoto],
    fit: &CameraFit,
    views: &[View],
    middle_mm: Point3<f64>,
) -> Vec<PhotoResult> {
    let photos = board_photos.iter().zip(&fit.poses).zip(fit.residuals(views));
    let results = photos.map(|((photo, pose), residuals_px)| PhotoResult {
        file: photo.file.clone(),
        turned_deg: photo.turned_deg,
        corners_px: photo.corners.iter().map(|c| c.px).collect(),
        rms_px: {
            let squared: f64 = residuals_px.iter().map(|[x, y]| x * x + y * y).sum();
            (squared / residuals_px.len().max(1) as f64).sqrt()
        },
        residuals_px,
        tilt_deg: (-ladder::normal(pose).z).clamp(-1.0, 1.0).acos().to_degrees(),
        distance_mm: (pose * middle_mm).coords.norm(),
        edge_width_px: photo.edge_width_px,
    });
    results.collect()
}

fn coverage(photos: &[PhotoResult], (width, height): (u32, u32)) -> Vec<u32> {
    let mut cells = vec![0; COVERAGE * COVERAGE];
    let cell = |at: f64, length: u32| {
        let share = ((at + 0.5) / f64::from(length)).clamp(0.0, 1.0);
        ((share * COVERAGE as f64) as usize).min(COVERAGE - 1)
    };
    for [x, y] in photos.iter().flat_map(|p| &p.corners_px) {
        cells[cell(*y, height) * COVERAGE + cell(*x, width)] += 1;
    }
    cells
}
