//! Advice on poses: every way of every step measured on the photos of a session, and judged.

use super::camera_check::{self, CheckedPhoto};
use super::error::AdviseError;
use super::held_out::{MethodResult, Sample};
use super::judge;
use super::measure::{Fit, Measured, TagDetectors, measure};
use super::method::{Method, Question};
use super::result::PoseAdvice;
use scaleproof_core::message::bail;
use scaleproof_core::workers;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::TagDetectorChoice;

/// Measures every way of every step on the photos of a session. `on_photo` is called after each photo.
pub fn advise_poses(
    samples: &[Sample],
    scene: &Scene,
    camera: &Camera,
    on_photo: impl Fn() + Sync,
) -> Result<PoseAdvice, AdviseError> {
    if samples.is_empty() {
        bail!("the session has no photo");
    }
    let families = scene.families();
    let reads = |choice: &TagDetectorChoice| families.iter().all(|family| choice.reads(*family));
    let detectors: Vec<TagDetectorChoice> = TagDetectorChoice::ALL.into_iter().filter(reads).collect();
    let answers_to = |question| Method::answers(question, &detectors, camera);
    let ways: Vec<Method> = Question::ALL.into_iter().flat_map(answers_to).collect();
    let open = || -> Result<TagDetectors, AdviseError> {
        let opened = detectors.iter().map(|choice| Ok((*choice, choice.open(&families)?)));
        opened.collect()
    };
    let measured = workers::map(
        samples,
        open,
        |opened, sample| Ok(measure(sample, &ways, opened, scene, camera)?),
        &on_photo,
    )?;
    let answers: Vec<&[MethodResult]> = measured.iter().map(|photo| photo.answers.as_slice()).collect();
    let fits: Vec<Fit> = measured.iter().map(|photo| photo.fit).collect();
    let disagreeing = fits.iter().filter(|fit| fit.disagrees).count();
    let photos = judged(samples, &ways, &measured);
    let camera_check = camera_check::check(&photos, &fits, scene, camera);
    Ok(judge::put_together(&ways, &answers, disagreeing, camera_check)?)
}

/// Returns the photos by which the camera file can be judged.
fn judged<'a>(samples: &'a [Sample], ways: &[Method], measured: &'a [Measured]) -> Vec<CheckedPhoto<'a>> {
    let Some(usual) = ways.iter().position(Method::is_usual) else {
        return Vec::new();
    };
    let judged = |(sample, measured): (&'a Sample, &'a Measured)| {
        let (pose, by_file) = (measured.usual.as_ref()?, &measured.answers[usual]);
        by_file.held_out_deg?;
        Some(CheckedPhoto { sample, pose, by_file })
    };
    samples.iter().zip(measured).filter_map(judged).collect()
}
