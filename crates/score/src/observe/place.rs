//! Ground truth box and pose of a photo.

use crate::observe::{NotScoredReason, Observation, ScoringJob};
use scaleproof_core::geometry::BoxPx;
use scaleproof_pose::locate::{Located, Warning, locate_tags};

/// Ground truth box of the model in a photo, and the located pose.
pub(crate) struct PlacedModel {
    pub located: Option<Located>,
    pub truth: BoxPx,
}

/// Returns the session's own truth and viewpoint where it has them, else those from the tags, or the reason why there is none.
pub(crate) fn place(job: &ScoringJob, seen: &Observation) -> Result<PlacedModel, NotScoredReason> {
    let scene = &job.session.scene;
    let given = job.entry.box_xyxy_px;
    let given = given.map(|b| b.clipped(seen.width.into(), seen.height.into()));
    if given.is_some_and(|b| !b.is_solid()) {
        return Err(NotScoredReason::new(
            "box_xyxy_px lies outside the photo: is it another photo's?",
        ));
    }
    if let (Some(truth), false) = (given, job.needs_tags()) {
        return Ok(PlacedModel { located: None, truth });
    }
    let camera = job.session.known_camera().map_err(NotScoredReason::new)?;
    let size = (seen.width, seen.height);
    let photo = locate_tags(seen.tags.clone(), size, seen.turned_deg, scene, camera);
    if let Some(truth) = given {
        let located = photo.result.ok();
        return Ok(PlacedModel { located, truth });
    }
    let (located, fitted) = photo.pose_and_camera().map_err(NotScoredReason::new)?;
    let outline = &job.session.outline;
    let truth = outline
        .box_in_photo(&located.pose, &fitted.camera)
        .map_err(NotScoredReason::new)?;
    if located.warnings.contains(&Warning::OpenPose) {
        // Only the bin is certain: the box must be the same by both poses.
        let rival = located.lone.as_ref().and_then(|lone| lone.rival);
        let other = rival.and_then(|rival| outline.box_in_photo(&rival.pose, &fitted.camera).ok());
        let iou = other.map_or(0.0, |other| truth.iou(&other));
        if iou < SAME_BOX_IOU {
            return Err(NotScoredReason(format!(
                "its one tag says from which bin the photo was taken, but not where the model's box is (two poses, whose boxes have an IoU of \
                 {iou:.2}; {SAME_BOX_IOU} is needed): let a second tag be seen, or give box_xyxy_px"
            )));
        }
    }
    Ok(PlacedModel {
        truth,
        located: Some(located),
    })
}

/// Least IoU at which boxes by the two poses of a lone tag are one box: the strictest threshold of COCO's average precision, at which the same
/// detection is a hit by either.
const SAME_BOX_IOU: f64 = 0.95;
