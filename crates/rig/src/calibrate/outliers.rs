//! Outliers: photos and corners that disagree with all the others.

use nalgebra::Point3;

use super::board_photo::{BoardPhoto, LEAST_PHOTOS, UnusedPhoto};
use super::fit::{self, CameraFit, View};
use super::model::LensModel;
use scaleproof_core::statistics::upper_median;

/// Models fitted in turn for the judge of photos, the last rich enough that a lens is no outlier.
const JUDGE: [LensModel; 3] = [LensModel::FC, LensModel::K1K2, LensModel::PlumbBob];
/// Share of the squared residuals below which a fisheye judges instead.
const FISHEYE_SHARE: f64 = 0.5;
/// Ratio to the median photo's residual, and px, above which a photo is left out.
const PHOTO_TIMES: f64 = 4.0;
const PHOTO_PX: f64 = 1.0;
/// Robust standard deviations, and px, above which a corner is left out.
const CORNER_TIMES: f64 = 8.0;
const CORNER_PX: f64 = 1.0;
/// Share of lost corners above which a photo is left out whole.
const LOST_SHARE: f64 = 0.2;

/// Photos that stay and those left out, and the fit of the smallest model over the rest.
pub(super) struct Cleaned {
    pub board_photos: Vec<BoardPhoto>,
    pub dropped: Vec<UnusedPhoto>,
    /// Corners left out of photos that stay.
    pub lost_corners: usize,
    pub first: CameraFit,
}

/// Leaves out, one at a time, the photo that disagrees most, then single corners. `None` when nothing can be fitted.
pub(super) fn clean(mut board_photos: Vec<BoardPhoto>, size: (u32, u32), places: &[Point3<f64>]) -> Option<Cleaned> {
    let (mut dropped, mut lost_corners) = (Vec::new(), 0);
    loop {
        let views: Vec<View> = board_photos.iter().map(|s| s.view(places)).collect();
        let first = fit::first(LensModel::F, size, &views)?;
        let length = |residuals: &Vec<[f64; 2]>| residuals.iter().map(|[x, y]| x.hypot(*y)).collect();
        // Without a judge nothing is left out.
        let judged = judge(&first, size, &views).map_or_else(Vec::new, |judge| judge.residuals(&views));
        let lengths: Vec<Vec<f64>> = judged.iter().map(length).collect();
        if let Some((worst, reason)) = worst_photo(&lengths).filter(|_| board_photos.len() > LEAST_PHOTOS) {
            let file = board_photos.remove(worst).file;
            dropped.push(UnusedPhoto { file, reason });
            continue;
        }
        let lost = drop_corners(&mut board_photos, &lengths);
        lost_corners += lost;
        if lost == 0 {
            return Some(Cleaned {
                board_photos,
                dropped,
                lost_corners,
                first,
            });
        }
    }
}

/// Fits the camera that photos are judged by.
pub(super) fn judge(first: &CameraFit, size: (u32, u32), views: &[View]) -> Option<CameraFit> {
    let judge = JUDGE.into_iter().try_fold(first.clone(), |start, model| {
        fit::fit(model, views, start.camera, start.poses)
    });
    let is_enough = |judge: &CameraFit| judge.rms_px(views) < PHOTO_PX.min(CORNER_PX);
    if judge.as_ref().is_some_and(is_enough) {
        return judge;
    }
    let share = judge.as_ref().map_or(f64::INFINITY, |judge| FISHEYE_SHARE * judge.cost);
    let fisheye = fit::first(LensModel::Fisheye, size, views).filter(|fisheye| fisheye.cost < share);
    fisheye.or(judge)
}

/// Returns the photo that does not fit the others, and the sentence that says so.
fn worst_photo(lengths: &[Vec<f64>]) -> Option<(usize, String)> {
    let mean_square = |l: &Vec<f64>| l.iter().map(|v| v * v).sum::<f64>() / l.len().max(1) as f64;
    let rms: Vec<f64> = lengths.iter().map(|l| mean_square(l).sqrt()).collect();
    let usual = upper_median(&rms).unwrap_or(0.0);
    let limit = corner_limit(lengths);
    let lost = |l: &[f64]| l.iter().filter(|d| **d > limit).count() as f64 > LOST_SHARE * l.len() as f64;
    let (worst, rms_px) = rms.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    let disagrees = *rms_px > PHOTO_PX.max(PHOTO_TIMES * usual) && lost(&lengths[worst]);
    disagrees.then(|| {
        let sentence = format!(
            "its corners are {rms_px:.1} px off where the other photos are {usual:.2} px off: did the board bend or move, or the \
             zoom change?"
        );
        (worst, sentence)
    })
}

fn drop_corners(board_photos: &mut [BoardPhoto], lengths: &[Vec<f64>]) -> usize {
    let limit = corner_limit(lengths);
    let mut lost = 0;
    for (board_photo, lengths) in board_photos.iter_mut().zip(lengths) {
        let mut lengths = lengths.iter();
        let before = board_photo.corners.len();
        let is_kept = |_: &_| lengths.next().is_none_or(|d| *d <= limit);
        board_photo.corners.retain(is_kept);
        lost += before - board_photo.corners.len();
    }
    lost
}

/// Returns the residual above which a corner is left out, px. The median length of a residual is 1.18 σ of one axis (Rayleigh).
fn corner_limit(lengths: &[Vec<f64>]) -> f64 {
    let sigma = upper_median(&lengths.concat()).unwrap_or(0.0) / 1.1774;
    CORNER_PX.max(CORNER_TIMES * sigma)
}
