//! When a pose may be believed, and the sentence a photographer gets when it may not.

use nalgebra::Point3;

use super::abstention::Abstention;
use super::matches::Match;
use super::solver::PoseCandidate;
use super::uncertainty::Sigma;
use crate::camera::Camera;
use scaleproof_core::geometry::{Rigid, angle};
use scaleproof_core::statistics::normal::upper_tail;

/// Residuals above this angle mean a wrong scene or camera, not noise. An angle, so that it holds at every resolution: at
/// the 1180 px focal length of the skyline session it is 3.1 px, where the worst honest photo (grazing, far tags) has 1.7 px.
const MAX_RMS_DEG: f64 = 0.15;

/// Two or three tags bend a pose to fit a moved one or a wrong camera, so that this share of it must do: more would tell, but there are
/// none.
const FEW_TAGS: f64 = 0.3;

/// The rival's residual must be this many times the best pose's. Measured on synthetic views: with the ratio of
/// best to rival below 0.2, single-tag frames are more than 10° wrong in 0.23 % instead of 2.1 %.
const MIN_RIVAL_RATIO: f64 = 5.0;

/// Corner noise below which a smaller residual is luck: four corners have eight numbers for six unknowns.
const NOISE_FLOOR_PX: f64 = 0.1;

/// A lone tag must be tilted by this much. Nearer to frontal its two branches melt into one pose, so there is no rival left to
/// exclude, and the tilt itself is noise: a corner error of 0.5 % of the tag's size is 3.5° of tilt at 5°, 1.6° at 10°. Of the sweeps of
/// `chart stability`, 10° let one more view of a nearly frontal tag pass into a wrong bin.
const MIN_LONE_TILT_DEG: f64 = 15.0;

/// Poses closer than this are one pose.
const SAME_TURN_DEG: f64 = 3.0;
const SAME_PLACE: f64 = 0.03;

/// An azimuth known no better than this is not known: the first derivatives no longer say how far it may be off.
const MAX_SIGMA_DEG: f64 = 5.0;
/// A pose in a wrong bin by more than this must be rarer than [`MAX_WRONG_BIN`] for each photo. Only photos near an edge come up
/// to it, so that the share among all is far below.
const WRONG_BIN_MARGIN_DEG: f64 = 1.0;
const MAX_WRONG_BIN: f64 = 0.01;

/// The residual above which tags disagree, px.
pub(super) fn limit_px(camera: &Camera) -> f64 {
    MAX_RMS_DEG / camera.deg_per_px()
}

/// The best pose and the best different one, if the best fits and the other does not fit almost as well.
pub(super) fn without_rival(
    mut found: Vec<PoseCandidate>,
    matches: &[Match],
    camera: &Camera,
) -> Result<(PoseCandidate, Option<PoseCandidate>), Abstention> {
    found.sort_by(|a, b| a.rms_px.total_cmp(&b.rms_px));
    let Some(best) = found.first() else {
        return Err(Abstention::BehindCamera);
    };
    let only = if let [only] = matches { Some(only) } else { None };
    let (tags, id) = (matches.len(), matches.first().map_or(0, |first| first.tag.id));
    let share = if (2..=3).contains(&tags) { FEW_TAGS } else { 1.0 };
    let (rms_px, limit_px) = (best.rms_px, share * limit_px(camera));
    if rms_px > limit_px {
        return Err(match only {
            Some(_) => Abstention::OneTagBent { id, rms_px, limit_px },
            None => Abstention::HighResidual { rms_px, limit_px },
        });
    }
    if only.is_some_and(|only| !only.is_whole) {
        return Err(Abstention::OneTagCovered { id });
    }
    let rival = found.iter().find(|c| is_different(&c.pose, &best.pose));
    if let Some(rival) = rival.filter(|r| r.rms_px < MIN_RIVAL_RATIO * rms_px.max(NOISE_FLOOR_PX)) {
        let (best_px, rival_px) = (rms_px, rival.rms_px);
        return Err(match only {
            Some(_) => Abstention::OneTagAmbiguous { id, best_px, rival_px },
            None => Abstention::RivalPose {
                tags,
                best_px,
                rival_px,
            },
        });
    }
    let tilt_deg = only.map(|only| tilt_deg(only, best));
    if let Some(tilt_deg) = tilt_deg.filter(|tilt| *tilt < MIN_LONE_TILT_DEG) {
        return Err(Abstention::OneTagFrontal { id, tilt_deg });
    }
    Ok((best.clone(), rival.cloned()))
}

/// The standard deviation of an azimuth whose tags fit badly although outliers were rejected: one bad card leaves the others in agreement, so
/// the camera file or the scene is wrong, and the rest was chosen to fit it. Focal lengths 12 % to 50 % off gave azimuths up to 8° off.
const MISFIT_SIGMA_DEG: f64 = 3.0;

/// What the viewpoint's σ becomes where the inlier tags fit badly.
pub(super) fn misfit_sigma(sigma: Sigma) -> Sigma {
    Sigma {
        azimuth_deg: sigma.azimuth_deg.max(MISFIT_SIGMA_DEG),
        pitch_deg: sigma.pitch_deg.max(MISFIT_SIGMA_DEG),
        ..sigma
    }
}

/// Refuses a viewpoint whose azimuth the tags leave open, so far that its bin may well be another. `edge_deg`: from the azimuth to
/// its bin's edge.
pub(super) fn settled(sigma: &Sigma, edge_deg: f64) -> Result<(), Abstention> {
    let sigma_deg = sigma.azimuth_deg;
    let wrong = upper_tail((edge_deg + WRONG_BIN_MARGIN_DEG) / sigma_deg);
    if sigma_deg <= MAX_SIGMA_DEG && wrong <= MAX_WRONG_BIN {
        Ok(())
    } else {
        Err(Abstention::Degenerate { sigma_deg, edge_deg })
    }
}

/// The angle between a tag's normal and the line of sight to its centre.
fn tilt_deg(m: &Match, found: &PoseCandidate) -> f64 {
    let to_camera = found.pose.inverse() * Point3::origin() - m.tag.centre_mm;
    m.tag.normal().angle(&to_camera).to_degrees()
}

/// True for poses that are not one pose up to noise.
pub(super) fn is_different(a: &Rigid, b: &Rigid) -> bool {
    let turn_deg = angle::turn(0.0, a.rotation.angle_to(&b.rotation).to_degrees()).abs();
    let (ca, cb) = (a.inverse() * Point3::origin(), b.inverse() * Point3::origin());
    // Relative to the distance from the model's origin.
    let place = (ca - cb).norm() / ca.coords.norm().max(1.0);
    turn_deg > SAME_TURN_DEG || place > SAME_PLACE
}
