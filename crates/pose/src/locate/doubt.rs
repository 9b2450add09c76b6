//! Tests that decide if a pose is reliable, and the reason for the photographer if it is not.

use nalgebra::Point3;

use super::abstention::Abstention;
use super::lone_tag::LoneTag;
use super::matches::{Corners, Match};
use super::resampled::Resampled;
use super::solver::PoseCandidate;
use super::uncertainty::{self, Sigma};
use crate::camera::Camera;
use crate::scene::{Bins, Viewpoint};
use scaleproof_core::geometry::{Rigid, angle};
use scaleproof_core::statistics::normal::upper_tail;

/// Root mean square residual, as an angle, above which scene or camera are wrong. An angle, so that it holds at every resolution: at the 1180 px
/// focal length of the skyline session it is 3.1 px, where the worst correct photo (grazing, far tags) has 1.7 px.
const MAX_RMS_DEG: f64 = 0.15;

/// Maximum residual of two or three tags, relative to the value that is expected of tags of their size: so few bend a pose to fit a moved tag or a
/// wrong camera. Of 138 real pairs and triples (`swatbotics`, `veldrovive`) none is above 1.9; above are 95 % of simulated pairs with one card moved
/// by 60 mm, 42 % by 20 mm. Smaller moves widen σ.
const MOST_OF_EXPECTED: f64 = 2.0;

/// Minimum ratio of the rival's residual to the best pose's. Measured on synthetic views: with a ratio of best to rival below 0.2, single-tag frames
/// are more than 10° wrong in 0.23 % instead of 2.1 %.
const MIN_RIVAL_RATIO: f64 = 5.0;

/// Residual, px, below which differences are chance: four corners have eight numbers for six unknowns.
const NOISE_FLOOR_PX: f64 = 0.1;

/// Tilt below which a lone tag with an ambiguous azimuth is called frontal: its tilt is noise, without a rival.
const FRONTAL_DEG: f64 = 15.0;

/// Poses closer than this in rotation and relative position count as one.
const SAME_TURN_DEG: f64 = 3.0;
const SAME_PLACE: f64 = 0.03;

/// Azimuth σ above which the azimuth is unknown: first derivatives no longer describe its error. Poses of a lone tag, which are sampled, still give
/// the bins it may be in.
const MAX_SIGMA_DEG: f64 = 5.0;
/// A pose in a wrong bin by more than the margin must be rarer than [`MAX_WRONG_BIN`] for each photo. Only photos near an edge reach this limit, so
/// the share among all is far lower.
const WRONG_BIN_MARGIN_DEG: f64 = 1.0;
const MAX_WRONG_BIN: f64 = 0.01;

/// Returns the residual above which tags disagree, px.
pub(super) fn limit_px(camera: &Camera) -> f64 {
    MAX_RMS_DEG / camera.deg_per_px()
}

/// Returns the best pose and the best different one; an error if the best fits poorly or the other fits almost as well. A lone tag's rival is left to
/// [`settled_alone`].
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
    let (rms_px, mut limit_px) = (best.rms_px, limit_px(camera));
    if (2..=3).contains(&tags) {
        let expected = uncertainty::expected_rms_px(&best.pose, &Corners::new(matches), camera);
        limit_px = limit_px.min(MOST_OF_EXPECTED * expected.unwrap_or(0.0));
    }
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
    if let Some(rival) = rival.filter(|rival| only.is_none() && is_near_as_good(rival, best)) {
        return Err(Abstention::RivalPose {
            tags,
            best_px: rms_px,
            rival_px: rival.rms_px,
        });
    }
    Ok((best.clone(), rival.cloned()))
}

fn is_near_as_good(rival: &PoseCandidate, best: &PoseCandidate) -> bool {
    rival.rms_px < MIN_RIVAL_RATIO * best.rms_px.max(NOISE_FLOOR_PX)
}

/// Returns an error if a lone tag leaves the azimuth so uncertain that the bin may be wrong.
pub(super) fn settled_alone(
    only: &Match,
    (best, rival): (&PoseCandidate, Option<&PoseCandidate>),
    resampled: &Resampled,
    viewpoint: &Viewpoint,
    bins: &Bins,
    lone: &LoneTag,
) -> Result<(), Abstention> {
    if resampled.share_beyond(&bins.bin_of(viewpoint), bins, WRONG_BIN_MARGIN_DEG) <= MAX_WRONG_BIN {
        return Ok(());
    }
    let (id, tilt_deg, lone) = (only.tag.id, tilt_deg(only, best), Box::new(lone.clone()));
    Err(match rival {
        Some(rival) if is_near_as_good(rival, best) => Abstention::OneTagAmbiguous {
            id,
            best_px: best.rms_px,
            rival_px: rival.rms_px,
            lone,
        },
        _ if tilt_deg < FRONTAL_DEG => Abstention::OneTagFrontal { id, tilt_deg, lone },
        _ => Abstention::OneTagDegenerate {
            id,
            sigma_deg: resampled.sigma(viewpoint).azimuth_deg,
            edge_deg: bins.azimuth_to_edge_deg(viewpoint.azimuth_deg),
            lone,
        },
    })
}

/// Returns true if the azimuth is so uncertain that only its bin is known.
pub(super) fn is_open(sigma: &Sigma) -> bool {
    sigma.azimuth_deg > MAX_SIGMA_DEG
}

/// Standard deviation of an azimuth whose tags fit badly although outliers were rejected: one bad card leaves the others in agreement, so the camera
/// file or the scene is wrong, and the inliers were selected to fit it. Focal lengths 12 % to 50 % off gave azimuths up to 8° off.
const MISFIT_SIGMA_DEG: f64 = 3.0;

/// Returns the viewpoint's σ, raised for inlier tags that fit badly.
pub(super) fn misfit_sigma(sigma: Sigma) -> Sigma {
    Sigma {
        azimuth_deg: sigma.azimuth_deg.max(MISFIT_SIGMA_DEG),
        pitch_deg: sigma.pitch_deg.max(MISFIT_SIGMA_DEG),
        ..sigma
    }
}

/// Returns an error if the tags leave the azimuth so uncertain that the bin may be wrong. `edge_deg`: distance of the azimuth from its bin's edge.
pub(super) fn settled(sigma: &Sigma, edge_deg: f64) -> Result<(), Abstention> {
    let sigma_deg = sigma.azimuth_deg;
    let wrong = upper_tail((edge_deg + WRONG_BIN_MARGIN_DEG) / sigma_deg);
    if !is_open(sigma) && wrong <= MAX_WRONG_BIN {
        Ok(())
    } else {
        Err(Abstention::Degenerate { sigma_deg, edge_deg })
    }
}

/// Returns the angle between a tag's normal and the line of sight to its centre.
fn tilt_deg(m: &Match, found: &PoseCandidate) -> f64 {
    let to_camera = found.pose.inverse() * Point3::origin() - m.tag.centre_mm;
    m.tag.normal().angle(&to_camera).to_degrees()
}

/// Returns true for two poses that differ by more than noise.
pub(super) fn is_different(a: &Rigid, b: &Rigid) -> bool {
    let turn_deg = angle::turn(0.0, a.rotation.angle_to(&b.rotation).to_degrees()).abs();
    let (ca, cb) = (a.inverse() * Point3::origin(), b.inverse() * Point3::origin());
    // Relative to the distance from the model's origin.
    let place = (ca - cb).norm() / ca.coords.norm().max(1.0);
    turn_deg > SAME_TURN_DEG || place > SAME_PLACE
}
