//! Estimation of the camera pose from tags: the pose, its viewpoint and bin, or the reason for abstaining.

mod abstention;
mod alike;
mod camera_doubt;
mod consensus;
pub mod diagnosis;
mod doubt;
mod factor;
mod lone_tag;
mod matches;
mod part_sizes;
mod photo;
mod plain_view;
mod planar;
mod refine;
mod relabelled;
mod resampled;
mod solver;
mod sqpnp;
mod uncertainty;

use nalgebra::Point3;
use serde::Serialize;

use crate::camera::Camera;
use crate::scene::{Bin, Scene, Viewpoint};
use crate::tags::SeenTag;
use consensus::Consensus;
use matches::Corners;
use refine::NO_HUBER;
use resampled::Resampled;
use scaleproof_core::geometry::Rigid;
use solver::PoseCandidate;

pub use abstention::Abstention;
pub use alike::{LocateFiles, MOST_LISTED};
pub use camera_doubt::FOCAL_SHARE;
pub use diagnosis::Diagnosis;
pub use factor::spread;
pub use lone_tag::{BinProbability, LoneTag, Rival};
pub use matches::{Ignored, IgnoredTag, area_px};
pub use photo::{LocatedPhoto, locate_luma, locate_photo, locate_tags};
pub use planar::planar_branches;
pub use relabelled::{CardFault, Relabelled};
pub use solver::Solver;
pub use sqpnp::sqpnp;
pub use uncertainty::{SPREAD, Sigma, Uncertainty, bin_probability, expected_px2};

/// Pose of a photo, with its viewpoint, bin and uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// `T_camera_model`: model frame to camera frame, mm.
    pub pose: Rigid,
    /// Covariance and corner noise of the pose.
    pub uncertainty: Uncertainty,
    /// Viewpoint of the camera relative to the model.
    pub viewpoint: Viewpoint,
    /// Standard deviations of the viewpoint.
    pub sigma: Sigma,
    /// Bin of the scene that contains the viewpoint.
    pub bin: Bin,
    /// Probability that the bin is the right one.
    pub bin_probability: f64,
    /// Alternative poses and bins, if the pose rests on one tag.
    pub lone: Option<LoneTag>,
    /// Reasons for reduced confidence in the pose.
    pub warnings: Vec<Warning>,
    /// Ids of the tags the pose rests on, ascending.
    pub tags: Vec<u32>,
    /// Tags that were seen but not used, by id.
    pub ignored_tags: Vec<IgnoredTag>,
    /// Root mean square distance between seen and projected corners, px.
    pub rms_px: f64,
}

/// Reason for reduced confidence in a pose (explained in codes.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Warning {
    /// The camera stood so near to the edge of its bin that the bin is right with less than 95 % probability.
    NearBinEdge,
    /// The tags agree with each other worse than tags do in a good photo by a right camera: a crop, another camera, a bent card.
    PoorFit,
    /// A lone tag leaves its pose open, and only the bin is sure: the other pose (`rival`) is in the same one.
    OpenPose,
}

/// Bin probability below which the pose has a warning.
const SURE_BIN: f64 = 0.95;

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
    let viewpoint = viewpoint(&best.pose, scene);
    let is_poor_fit = is_poor_fit(best.rms_px, camera);
    let bin = scene.bins.bin_of(&viewpoint);
    let likelihood = |rival: &PoseCandidate| uncertainty.likelihood(rival, &best, corners.image_px.len());
    let mut lone = None;
    let (sigma, bin_probability) = if let [only] = &matches[..] {
        let resampled = Resampled::new(only, uncertainty.noise_px, scene, camera);
        let left_open = LoneTag {
            rival: rival
                .as_ref()
                .map(|rival| Rival::new(rival.pose, &self::viewpoint(&rival.pose, scene), likelihood(rival))),
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
            let is_same_bin = scene.bins.bin_of(&self::viewpoint(&rival.pose, scene)) == bin;
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

/// Returns true if a pose's tags fit worse than a camera's noise explains. `rms_px` refers to the camera's own image size.
pub fn is_poor_fit(rms_px: f64, camera: &Camera) -> bool {
    rms_px * camera.deg_per_px() > consensus::MAX_NOISE_DEG
}

fn viewpoint(pose: &Rigid, scene: &Scene) -> Viewpoint {
    Viewpoint::from_camera(pose.inverse() * Point3::origin(), scene.model.target_mm())
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
