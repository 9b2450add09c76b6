//! Tags and a camera become the pose of the camera, its viewpoint and bin, or a reason why not.

mod doubt;
pub mod reprojection;
mod solver;

use nalgebra::Point3;

use crate::camera::Camera;
use crate::geometry::{Rigid, angle};
use crate::scene::{Bin, Scene, Tag, Viewpoint};
use crate::tags::SeenTag;

pub use doubt::Abstention;

/// A photo with a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// `T_camera_model`: model frame to camera frame, mm.
    pub pose: Rigid,
    pub viewpoint: Viewpoint,
    pub bin: Bin,
    /// Ids of the tags the pose rests on, ascending.
    pub tags: Vec<u32>,
    /// Ids of tags that were seen but not used: not in the scene, seen twice, or partly covered.
    pub ignored_tags: Vec<u32>,
    /// Root mean square distance between seen and projected corners, px.
    pub rms_px: f64,
}

/// A tag of the scene together with where its corners were seen.
#[derive(Debug, Clone)]
struct Match<'a> {
    tag: &'a Tag,
    corners_px: [[f64; 2]; 4],
    is_whole: bool,
}

impl Match<'_> {
    /// Area in the picture, px² (shoelace formula).
    fn area_px(&self) -> f64 {
        let c = &self.corners_px;
        let twice: f64 = (0..4)
            .map(|i| c[i][0] * c[(i + 1) % 4][1] - c[(i + 1) % 4][0] * c[i][1])
            .sum();
        twice.abs() / 2.0
    }
}

/// Corresponding corners: model frame in mm, picture in px.
struct Corners {
    model_mm: Vec<Point3<f64>>,
    image_px: Vec<[f64; 2]>,
}

/// A refined pose and how far it leaves the corners from where they were seen.
#[derive(Debug, Clone, PartialEq)]
struct Candidate {
    pose: Rigid,
    rms_px: f64,
}

/// Locates the camera from the tags of one photo.
///
/// SQPnP over all corners (Terzakis & Lourakis 2020) and both planar branches (IPPE: Collins & Bartoli 2014) of the largest
/// tags each start one Levenberg–Marquardt refinement over all corners, distortion included. The best pose and the best
/// *different* one are compared, and a pose that cannot exclude its rival is not returned.
pub fn locate(seen: &[SeenTag], scene: &Scene, camera: &Camera) -> Result<Located, Abstention> {
    let (matches, ignored_tags) = match_tags(seen, scene)?;
    let corners = corners(&matches);
    let starts = solver::starts(&matches, &corners, camera);
    let candidates = starts
        .iter()
        .filter_map(|start| solver::refine(start, &corners, camera))
        .filter_map(|pose| {
            Some(Candidate {
                rms_px: rms_px(&pose, &corners, camera)?,
                pose,
            })
        })
        .collect();
    let best = doubt::undoubted(candidates, &matches, camera)?;
    Ok(located(best, scene, &matches, ignored_tags))
}

/// Refuses a photo of another size than the camera was calibrated for: focal length and centre would be wrong.
pub fn check_size(width: u32, height: u32, camera: &Camera) -> Result<(), Abstention> {
    if (width, height) == (camera.width, camera.height) {
        Ok(())
    } else {
        Err(Abstention::WrongCameraSize {
            width,
            height,
            camera_width: camera.width,
            camera_height: camera.height,
        })
    }
}

fn located(best: Candidate, scene: &Scene, matches: &[Match], ignored_tags: Vec<u32>) -> Located {
    let centre = best.pose.inverse() * Point3::origin();
    let viewpoint = Viewpoint::of_camera(centre, scene.model.target_mm());
    let mut tags: Vec<u32> = matches.iter().map(|m| m.tag.id).collect();
    tags.sort_unstable();
    Located {
        bin: scene.bins.bin_of(&viewpoint),
        viewpoint,
        tags,
        ignored_tags,
        rms_px: best.rms_px,
        pose: best.pose,
    }
}

/// The seen tags that stand in the scene, without those that could mislead.
///
/// An id seen twice is left out both times: one of the two is a copy or a ghost, and nothing tells which. A tag that is partly
/// covered is left out when two whole ones remain.
fn match_tags<'a>(seen: &[SeenTag], scene: &'a Scene) -> Result<(Vec<Match<'a>>, Vec<u32>), Abstention> {
    let times = |tag: &SeenTag| seen.iter().filter(|t| (t.family, t.id) == (tag.family, tag.id)).count();
    let (mut matches, mut ignored) = (Vec::new(), Vec::new());
    for tag in seen {
        match scene.tag(tag.family, tag.id) {
            Some(known) if times(tag) == 1 => matches.push(Match {
                tag: known,
                corners_px: tag.corners_px,
                is_whole: tag.is_whole,
            }),
            _ => ignored.push(tag.id),
        }
    }
    if matches.iter().filter(|m| m.is_whole).count() >= 2 {
        ignored.extend(matches.iter().filter(|m| !m.is_whole).map(|m| m.tag.id));
        matches.retain(|m| m.is_whole);
    }
    ignored.sort_unstable();
    ignored.dedup();
    match (matches.is_empty(), ignored.is_empty()) {
        (true, true) => Err(Abstention::NoTags),
        (true, false) => Err(Abstention::NoKnownTag { ids: ignored }),
        (false, _) => Ok((matches, ignored)),
    }
}

fn corners(matches: &[Match]) -> Corners {
    Corners {
        model_mm: matches.iter().flat_map(|m| m.tag.corners_mm()).collect(),
        image_px: matches.iter().flat_map(|m| m.corners_px).collect(),
    }
}

/// Root mean square reprojection error in px; `None` when a corner falls behind the camera or outside the camera model.
fn rms_px(pose: &Rigid, corners: &Corners, camera: &Camera) -> Option<f64> {
    let mut sum = 0.0;
    for (point, [u, v]) in corners.model_mm.iter().zip(&corners.image_px) {
        let [x, y] = camera.project(&(pose * point))?;
        sum += (x - u).powi(2) + (y - v).powi(2);
    }
    let rms = (sum / corners.image_px.len() as f64).sqrt();
    rms.is_finite().then_some(rms)
}

/// How different two poses are: the turn between them in degrees, and the distance between the camera centres relative to
/// the distance from the model's origin.
fn difference(a: &Rigid, b: &Rigid) -> (f64, f64) {
    let turn = a.rotation.angle_to(&b.rotation).to_degrees();
    let (ca, cb) = (a.inverse() * Point3::origin(), b.inverse() * Point3::origin());
    (
        angle::turn(0.0, turn).abs(),
        (ca - cb).norm() / ca.coords.norm().max(1.0),
    )
}
