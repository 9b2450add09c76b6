//! Estimation of the pose from the tags of one photo.

use super::abstention::Abstention;
use super::consensus::{self, Consensus, is_poor_fit};
use super::doubt;
use super::located::{Located, Warning};
use super::lone_tag::{LoneTag, Rival};
use super::matches::{self, Corners};
use super::refine::{self, NO_HUBER};
use super::resampled::Resampled;
use super::solver::{PoseCandidate, Solver};
use super::uncertainty::{self, Sigma, Uncertainty};
use super::{camera_doubt, plain_view};
use crate::camera::Camera;
use crate::scene::{Scene, Viewpoint};
use crate::tags::SeenTag;

/// Bin probability below which the pose has a warning.
const SURE_BIN: f64 = 0.95;

/// Locates the camera from the tags of one photo, by the default solver.
pub fn locate(seen: &[SeenTag], scene: &Scene, camera: &Camera) -> Result<Located, Abstention> {
    locate_by(Solver::default(), seen, scene, camera)
}

/// Locates the camera from the tags of one photo.
///
/// The best pose and the best *different* one are compared, and a pose that cannot exclude its rival is not returned, nor one
/// whose azimuth the tags leave open.
pub fn locate_by(solver: Solver, seen: &[SeenTag], scene: &Scene, camera: &Camera) -> Result<Located, Abstention> {
    let (matches, mut ignored_tags) = matches::match_tags(seen, scene)?;
    let Consensus {
        matches,
        candidates,
        left_out,
    } = if solver == Solver::EveryBranch {
        consensus::find(matches, scene, camera)?
    } else {
        Consensus::unchecked(solver, solver.used(matches), camera)
    };
    let (best, rival) = doubt::without_rival(candidates, &matches, camera)?;
    let has_outliers = !left_out.is_empty();
    ignored_tags.extend(left_out);
    ignored_tags.sort_unstable();
    let corners = Corners::new(&matches);
    let (best, mut uncertainty) = finished(solver, &best, &corners, camera).ok_or(Abstention::Degenerate {
        sigma_deg: 180.0,
        edge_deg: 0.0,
    })?;
    let by_camera = camera_doubt::covariance(&best.pose, &corners, camera).unwrap_or_default();
    uncertainty.covariance += by_camera;
    let target_mm = scene.model.target_mm();
    let viewpoint = Viewpoint::of_pose(&best.pose, target_mm);
    let is_poor_fit = is_poor_fit(best.rms_px, camera);
    let bin = scene.bins.bin_of(&viewpoint);
    let likelihood = |rival: &PoseCandidate| uncertainty.likelihood(rival, &best, corners.image_px.len());
    let mut lone = None;
    let (sigma, bin_probability) = if let [only] = &matches[..] {
        let resampled = Resampled::new(only, uncertainty.noise_px, scene, camera);
        let left_open = LoneTag {
            rival: rival.as_ref().map(|rival| {
                Rival::new(
                    rival.pose,
                    &Viewpoint::of_pose(&rival.pose, target_mm),
                    likelihood(rival),
                )
            }),
            bins: resampled.bins(&scene.bins),
        };
        doubt::settled_alone(
            only,
            (&best, rival.as_ref()),
            &resampled,
            &viewpoint,
            &scene.bins,
            &left_open,
        )?;
        plain_view::check_plain_view(only, &best.pose, seen, scene, camera)?;
        lone = Some(left_open);
        let drawn = resampled.covariance(&best.pose);
        uncertainty.covariance = drawn.map_or(uncertainty.covariance, |drawn| drawn + by_camera);
        let sigma = resampled
            .sigma(&viewpoint)
            .and(&Sigma::new(&by_camera, &best.pose, target_mm));
        (sigma, resampled.share_in(&bin, &scene.bins))
    } else {
        let mut sigma = Sigma::new(&uncertainty.covariance, &best.pose, target_mm);
        if has_outliers && is_poor_fit {
            sigma = doubt::misfit_sigma(sigma);
        }
        doubt::settled(&sigma, scene.bins.azimuth_to_edge_deg(viewpoint.azimuth_deg))?;
        let of_best = uncertainty::bin_probability(&bin, &scene.bins, &viewpoint, &sigma);
        // An excluded rival keeps the weight of its likelihood.
        let with_rival = rival.as_ref().map_or(of_best, |rival| {
            let weight = likelihood(rival);
            let is_same_bin = scene.bins.bin_of(&Viewpoint::of_pose(&rival.pose, target_mm)) == bin;
            (of_best + weight * f64::from(u8::from(is_same_bin))) / (1.0 + weight)
        });
        (sigma, with_rival)
    };
    let near_edge = (bin_probability < SURE_BIN).then_some(Warning::NearBinEdge);
    let poor_fit = is_poor_fit.then_some(Warning::PoorFit);
    let open_pose = doubt::is_open(&sigma).then_some(Warning::OpenPose);
    let mut tags: Vec<u32> = matches.iter().map(|m| m.tag.id).collect();
    tags.sort_unstable();
    Ok(Located {
        pose: best.pose,
        uncertainty,
        viewpoint,
        sigma,
        bin,
        bin_probability,
        lone,
        warnings: near_edge.into_iter().chain(poor_fit).chain(open_pose).collect(),
        tags,
        ignored_tags,
        rms_px: best.rms_px,
    })
}

/// Returns a solver's final pose and its uncertainty. `None` if the corners do not determine the pose.
fn finished(
    solver: Solver,
    best: &PoseCandidate,
    corners: &Corners,
    camera: &Camera,
) -> Option<(PoseCandidate, Uncertainty)> {
    let (pose, uncertainty) = match solver {
        Solver::EveryBranch => uncertainty::robust(&best.pose, corners, camera)?,
        _ => (best.pose, uncertainty::at(&best.pose, corners, camera, NO_HUBER)?),
    };
    let rms_px = refine::rms_px(&pose, corners, camera)?;
    Some((PoseCandidate { pose, rms_px }, uncertainty))
}
