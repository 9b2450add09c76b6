//! Calibration of a camera from photos of a board, or of tags whose places are known: the smallest model that fits, with its uncertainty, or a reason
//! why there is none.

mod detect;
mod doubt;
mod film;
mod fit;
mod jackknife;
mod ladder;
mod model;
mod outliers;
mod page;
mod sharpness;
mod shutter;
mod summary;
mod target;
mod uncertainty;

use std::path::{Path, PathBuf};

use nalgebra::{DMatrix, Point3};

use scaleproof_core::{files, workers};
use scaleproof_photo::Photo;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::Camera;

pub use detect::check;
pub use doubt::{CalibrationCaution, CalibrationError};
pub use film::{Film, FilmError, look_at_video};
pub use fit::{View, refit};
pub use ladder::CandidateModel;
pub use model::LensModel;
pub use page::page;
pub use shutter::Motion;
use summary::numbers;
pub use summary::{CalibrationAnswer, answer, table};
pub use target::Target;
pub use uncertainty::UncertaintyMap;

/// A corner of the board, or of a tag of the scene, in a photo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenCorner {
    /// Index into [`Definition::corners_mm`]; of a scene, four times the tag's place in it and the corner.
    pub id: usize,
    /// Place in the photo; pixel (0, 0) is the centre of the top-left pixel.
    pub px: [f64; 2],
}

/// Least number of photos of a calibration.
pub const LEAST_PHOTOS: usize = 4;

/// A photo in which the board (or tags of the scene) was found. Everything is in the sensor's frame, whichever way the camera was held, so that boards of mixed
/// orientation share one camera, and `Camera::for_photo` turns that camera with each photo.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardPhoto {
    pub file: String,
    /// Width and height in the sensor's frame, px.
    pub size: (u32, u32),
    /// Degrees by which EXIF turns it clockwise to make it upright: 0, 90, 180 or 270.
    pub turned_deg: u32,
    pub corners: Vec<SeenCorner>,
    /// Width of the edges at the corners, px; `None` where it could not be measured.
    pub edge_width_px: Option<f64>,
}

impl BoardPhoto {
    fn view(&self, places: &[Point3<f64>]) -> View {
        View {
            points_mm: self.corners.iter().map(|c| places[c.id]).collect(),
            seen_px: self.corners.iter().map(|c| c.px).collect(),
        }
    }
}

/// A photo that had no part in the camera, and the reason, as a sentence.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct UnusedPhoto {
    pub file: String,
    pub reason: String,
}

/// Corners, residuals and pose of one photo of the camera.
#[derive(Debug, Clone)]
pub struct PhotoResult {
    pub file: String,
    /// As [`BoardPhoto::turned_deg`].
    pub turned_deg: u32,
    /// Corners in the photo, px, and seen minus projected, px.
    pub corners_px: Vec<[f64; 2]>,
    pub residuals_px: Vec<[f64; 2]>,
    pub rms_px: f64,
    /// Angle between the board's normal, or that of a scene's table, and the optical axis.
    pub tilt_deg: f64,
    pub distance_mm: f64,
    pub edge_width_px: Option<f64>,
}

/// A calibrated camera and its uncertainty.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The board; `None` where it was the tags of a scene.
    pub board: Option<Definition>,
    pub camera: Camera,
    /// Every model that could be fitted, from the smallest up.
    pub models: Vec<CandidateModel>,
    /// Index of the camera's model in `models`.
    pub chosen: usize,
    /// Standard deviations of fx, fy, cx, cy (px), then the camera's coefficients; 0 for what the model does not fit. By the scatter of the corners, or by
    /// leaving photos out where that is larger.
    pub sigmas: [f64; model::ALL],
    /// Root mean square residual over all corners, px.
    pub rms_px: f64,
    pub photos: Vec<PhotoResult>,
    pub left_out: Vec<UnusedPhoto>,
    /// Corners left out of photos that stay.
    pub lost_corners: usize,
    /// Corners seen in each cell of a 10 × 10 grid over the image, row by row.
    pub coverage: Vec<u32>,
    pub map: UncertaintyMap,
    /// Ratio of the focal length's standard deviation, from leaving photos out, to that by the scatter of the corners alone.
    pub focal_raised: f64,
    pub cautions: Vec<CalibrationCaution>,
}

impl Calibration {
    pub fn chosen_model(&self) -> &CandidateModel {
        &self.models[self.chosen]
    }
}

/// Cells of the coverage grid along each side.
pub const COVERAGE: usize = 10;

/// Finds the board in every photo; those without are named with the reason. Both lists keep the photos' order.
pub fn look(photos: &[PathBuf], board: &Definition, on_done: impl Fn() + Sync) -> (Vec<BoardPhoto>, Vec<UnusedPhoto>) {
    let found = workers::map(
        photos,
        || Ok::<(), std::convert::Infallible>(()),
        |(), path| Ok(look_at(path, board)),
        on_done,
    );
    let (mut board_photos, mut left_out) = (Vec::new(), Vec::new());
    for result in found.unwrap_or_else(|never| match never {}) {
        match result {
            Ok(board_photo) => board_photos.push(board_photo),
            Err(out) => left_out.push(out),
        }
    }
    (board_photos, left_out)
}

fn look_at(path: &Path, board: &Definition) -> Result<BoardPhoto, UnusedPhoto> {
    let file = files::name_of(path);
    let out = |e: &dyn std::error::Error| UnusedPhoto {
        file: file.clone(),
        reason: e.to_string(),
    };
    let photo = Photo::open(path).map_err(|e| out(&e))?;
    let luma = photo.sensor_luma().map_err(|e| out(&e))?;
    let corners = detect::find(&luma, board).map_err(|e| out(&e))?;
    Ok(BoardPhoto {
        edge_width_px: sharpness::edge_width_px(&luma, &corners),
        file,
        size: luma.dimensions(),
        turned_deg: photo.turned_deg,
        corners,
    })
}

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
    let cleaned = outliers::clean(board_photos, size, &places).ok_or(CalibrationError::NoFit)?;
    left_out.extend(cleaned.dropped);
    let views: Vec<View> = cleaned.board_photos.iter().map(|s| s.view(&places)).collect();
    doubt::seen_from_several_sides(&cleaned.first, target)?;
    let mut models = ladder::fit_ladder(target.models(), cleaned.first, size, &views);
    let chosen = ladder::choose(&models).ok_or(CalibrationError::NoFit)?;
    let fit = models[chosen].fit.clone();
    doubt::determined(&models, chosen, &views, target)?;
    doubt::fits(&fit, &views, size, target)?;
    let scatter = fit.covariance(fit.model, &views).ok_or(CalibrationError::NoFit)?;
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
        rms_px: rms_px(&fit, &views),
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
fn read_out(
    photos: &[BoardPhoto],
    size: (u32, u32),
    places: &[Point3<f64>],
    motion: &Motion,
) -> Option<shutter::ReadOut> {
    if motion.is_empty() {
        return None;
    }
    let cleaned = outliers::clean(photos.to_vec(), size, places)?;
    let views: Vec<View> = cleaned.board_photos.iter().map(|photo| photo.view(places)).collect();
    let judge = outliers::judge(&cleaned.first, size, &views)?;
    Some(shutter::ReadOut::of(&judge, &views, &cleaned.board_photos, motion))
}

fn rms_px(fit: &fit::CameraFit, views: &[View]) -> f64 {
    let corners: usize = views.iter().map(|v| v.seen_px.len()).sum();
    (fit.cost / corners as f64).sqrt()
}

fn sigmas(fit: &fit::CameraFit, covariance: &DMatrix<f64>) -> [f64; model::ALL] {
    let numbers = fit.model.parameters_to_numbers();
    let variances = (&numbers * covariance * numbers.transpose()).diagonal();
    std::array::from_fn(|i| variances[i].max(0.0).sqrt())
}

fn photo_results(
    board_photos: &[BoardPhoto],
    fit: &fit::CameraFit,
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
