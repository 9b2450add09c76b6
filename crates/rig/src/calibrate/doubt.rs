//! Checks that refuse photos which determine no camera, and cautions about a weak one.

use super::board_photo::{BoardPhoto, LEAST_PHOTOS, UnusedPhoto};
use super::error::{CalibrationCaution, CalibrationError};
use super::fit::{CameraFit, View};
use super::ladder::{CandidateModel, normal};
use super::model::LensModel;
use super::result::{COVERAGE, Calibration};
use super::sharpness::BLURRED_PX;
use super::target::Target;
use scaleproof_core::message::bail;
use scaleproof_core::statistics::upper_median;

/// Ratio to the usual edge width of the set above which a photo can be blurred, so that a soft lens is not held against every photo.
const BLUR_TIMES: f64 = 2.0;
/// Least angle between the normals of some two boards. Parallel planes give the same two constraints over and over (Zhang
/// 2000, section 3.3), and with the centre unknown that leaves the focal length open, however small the residuals.
const LEAST_SPREAD_DEG: f64 = 12.0;
/// Largest relative σ of the focal length with the principal point free. It goes into every distance as it is.
const MOST_FOCAL_SIGMA: f64 = 0.01;
/// Largest residual as a share of the image's diagonal: larger ones are of another board or another camera. 2.4 px at 1280×960.
const MOST_RMS_SHARE: f64 = 0.0015;
/// Ratio of the focal length's standard deviation to what the corners explain, above which there is a caution: more than chance among five photos.
const FOCAL_TIMES: f64 = 2.0;
/// Number of photos below which the uncertainties are themselves uncertain.
const FEW_PHOTOS: usize = 10;

/// Leaves out blurred photos and those of another size than most.
pub(super) fn alike(
    board_photos: Vec<BoardPhoto>,
    mut left_out: Vec<UnusedPhoto>,
) -> (Vec<BoardPhoto>, Vec<UnusedPhoto>) {
    let count = |size: (u32, u32)| board_photos.iter().filter(|s| s.size == size).count();
    // The first of the most frequent sizes.
    let most = board_photos.iter().map(|s| count(s.size)).max().unwrap_or(0);
    let usual = board_photos.iter().map(|s| s.size).find(|size| count(*size) == most);
    let (w, h) = usual.unwrap_or_default();
    let widths: Vec<f64> = board_photos.iter().filter_map(|s| s.edge_width_px).collect();
    let blurred = BLURRED_PX.max(BLUR_TIMES * upper_median(&widths).unwrap_or(0.0));
    let mut kept = Vec::new();
    for board_photo in board_photos {
        let (width, height) = board_photo.size;
        let reason = if board_photo.size != (w, h) {
            format!(
                "it is {width}×{height} and most photos are {w}×{h}: a camera file holds for one size; use original photos, whose EXIF data says how they were turned"
            )
        } else if let Some(width) = board_photo.edge_width_px.filter(|width| *width > blurred) {
            format!(
                "it is blurred: its edges are {width:.0} px wide, more than {blurred:.0} px; hold board and camera still"
            )
        } else {
            kept.push(board_photo);
            continue;
        };
        let file = board_photo.file;
        left_out.push(UnusedPhoto { file, reason });
    }
    (kept, left_out)
}

/// Refuses too few photos.
pub(super) fn enough(
    board_photos: &[BoardPhoto],
    left_out: &[UnusedPhoto],
    target: Target,
) -> Result<(), CalibrationError> {
    if board_photos.len() >= LEAST_PHOTOS {
        return Ok(());
    }
    let first = left_out.first().map(|out| format!("{}: {}", out.file, out.reason));
    let first = first.unwrap_or_else(|| "give more photos".to_owned());
    let usable = board_photos.len();
    if usable == 0 {
        bail!("no photo shows {}; {first}", target.name());
    }
    let all = usable + left_out.len();
    bail!("only {usable} of {all} photos can be used, at least {LEAST_PHOTOS} are needed; {first}")
}

/// Refuses photos that all show a board from one side. Tags that stand up are no plane, so that one side may be enough of a scene.
pub(super) fn seen_from_several_sides(fit: &CameraFit, target: Target) -> Result<(), CalibrationError> {
    if matches!(target, Target::Scene(_)) {
        return Ok(());
    }
    let normals: Vec<_> = fit.poses.iter().map(normal).collect();
    let pairs = normals
        .iter()
        .enumerate()
        .flat_map(|(i, a)| normals[..i].iter().map(move |b| (a, b)));
    let spread_deg = pairs.map(|(a, b)| a.angle(b).to_degrees()).fold(0.0, f64::max);
    if spread_deg < LEAST_SPREAD_DEG {
        return Err(CalibrationError::SameTilt { spread_deg });
    }
    Ok(())
}

/// Refuses photos whose focal length is known only because the principal point is held, or not even then.
pub(super) fn determined(
    models: &[CandidateModel],
    chosen: usize,
    views: &[View],
    target: Target,
) -> Result<(), CalibrationError> {
    let fit = &models[chosen].fit;
    let model = fit.model.max(LensModel::FC);
    let open = |percent: &str| CalibrationError::FocalOpen {
        percent: percent.to_owned(),
        advice: target.focal_advice(),
    };
    let covariance = fit.covariance(model, views).ok_or_else(|| open("more than 100"))?;
    let share = covariance[(0, 0)].max(0.0).sqrt() / fit.camera.values[0];
    if share > MOST_FOCAL_SIGMA {
        return Err(open(&format!("{:.1}", 100.0 * share)));
    }
    Ok(())
}

/// Refuses a camera that does not explain its own photos.
pub(super) fn fits(
    fit: &CameraFit,
    views: &[View],
    (width, height): (u32, u32),
    target: Target,
) -> Result<(), CalibrationError> {
    let rms_px = fit.rms_px(views);
    let limit_px = MOST_RMS_SHARE * f64::from(width).hypot(f64::from(height));
    if rms_px > limit_px {
        let question = target.misfit_question();
        bail!("the corners are {rms_px:.1} px off, root mean square (limit {limit_px:.1} px): {question}");
    }
    Ok(())
}

/// Returns cautions about a camera that was found.
pub(super) fn cautions(found: &Calibration) -> Vec<CalibrationCaution> {
    let mut cautions = Vec::new();
    let mut say = |sentence: String| cautions.push(CalibrationCaution(sentence));
    let photos = found.photos.len();
    if photos < FEW_PHOTOS {
        say(format!(
            "{photos} photos are few, {FEW_PHOTOS} to 20 make the uncertainties believable"
        ));
    }
    let missing = missing_corners(&found.coverage);
    if !missing.is_empty() {
        let is_turned = found.photos.iter().any(|photo| photo.turned_deg != 0);
        let sensor = if is_turned {
            " (as the sensor sees it, before EXIF turns it)"
        } else {
            ""
        };
        let missing = match &missing[..] {
            [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            one => one.concat(),
        };
        let (what, how) = match found.board {
            Some(_) => ("the board", "hold the board into the corners"),
            None => ("a tag", "turn the camera so that tags get into the corners"),
        };
        say(format!(
            "no photo shows {what} in the {missing} of the image{sensor}, so the camera is a guess there: {how}"
        ));
    }
    let folded = found.map.cells.iter().filter(|c| c.sigma_px.is_none()).count();
    if folded > 0 {
        say(format!(
            "the lens model does not reach {folded} of {} cells of the image, near its edge; do not use points there",
            found.map.cells.len()
        ));
    }
    let tilted = found.photos.iter().filter(|p| p.tilt_deg > 20.0).count();
    if tilted < 4 && found.board.is_some() {
        say(format!(
            "only {tilted} photos show the board tilted by more than 20°, which is what the focal length comes from"
        ));
    }
    if found.focal_raised > FOCAL_TIMES {
        say(format!(
            "the photos disagree about the focal length {:.0} times as much as their corners explain, which its σ contains: lock the focus, {}",
            found.focal_raised,
            match found.board {
                Some(_) => "and keep the board flat",
                None => "switch stabilisation off, and walk slowly",
            }
        ));
    }
    if found.lost_corners > 0 {
        say(format!(
            "{} single corners disagreed with the rest and were left out",
            found.lost_corners
        ));
    }
    if found.chosen_model().model == LensModel::Rational {
        say("the largest model was chosen: this lens may need one that this program does not have".into());
    }
    cautions
}

/// Returns the corners of the image, a fifth of each side, where no board corner was seen.
fn missing_corners(coverage: &[u32]) -> Vec<&'static str> {
    let corners = [
        ("top left", 0, 0),
        ("top right", 8, 0),
        ("bottom left", 0, 8),
        ("bottom right", 8, 8),
    ];
    let is_empty = |x: usize, y: usize| {
        (y..y + 2).all(|row| (x..x + 2).all(|column| coverage.get(row * COVERAGE + column).is_none_or(|n| *n == 0)))
    };
    let missing = corners.into_iter().filter(|(_, x, y)| is_empty(*x, *y));
    missing.map(|(name, ..)| name).collect()
}
