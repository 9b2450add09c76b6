//! Advice on a session: each step from a photo to a figure, done in smaller and larger ways on its own photos, and the smallest that is not shown
//! worse.
//!
//! No truth is needed: a pose is judged by how well it predicts the corners of a tag that it was not made of (`held_out.rs`).

mod camera_check;
mod figures;
mod held_out;
mod judge;
mod measure;
mod page;
mod paired;
mod result;
mod table;
mod way;

use scaleproof_core::spelling::count;
use scaleproof_core::workers;
use scaleproof_pose::camera::{Camera, SizeError};
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::{StartError, TagDetectorChoice};

use camera_check::Judged;
pub use figures::{FigureAdvice, advise_figures};
use held_out::Answer;
pub use held_out::Sample;
use measure::{Fit, Measured, Opened, measure};
pub use page::page;
pub use result::{Advice, CameraVerdict, Choice, PoseAdvice};
pub use table::{settings, table};
pub use way::Question;
use way::Way;

/// Reason why nothing can be advised.
#[derive(Debug, thiserror::Error)]
pub enum AdviseError {
    #[error("the session has no photo")]
    NoPhoto,
    #[error("no photo of the session is located, so that there is nothing to compare{}", also(*disagreeing))]
    NothingLocated { disagreeing: usize },
    #[error(transparent)]
    Start(#[from] StartError),
    #[error("{file}: {fault}")]
    Size { file: String, fault: SizeError },
}

/// Returns the part of a sentence on photos whose tags disagree; empty without any.
fn also(disagreeing: usize) -> String {
    let photos = (disagreeing > 0).then(|| count(disagreeing, "photo"));
    photos.map_or(String::new(), |photos| {
        format!("; the tags disagree with scene and camera in {photos}")
    })
}

/// Measures every way of every step on the photos of a session. `on_photo` is called after each photo.
pub fn advise_poses(
    samples: &[Sample],
    scene: &Scene,
    camera: &Camera,
    on_photo: impl Fn() + Sync,
) -> Result<PoseAdvice, AdviseError> {
    if samples.is_empty() {
        return Err(AdviseError::NoPhoto);
    }
    let families = scene.families();
    let reads = |choice: &TagDetectorChoice| families.iter().all(|family| choice.reads(*family));
    let detectors: Vec<TagDetectorChoice> = TagDetectorChoice::ALL.into_iter().filter(reads).collect();
    let answers_to = |question| Way::answers(question, &detectors, camera);
    let ways: Vec<Way> = Question::ALL.into_iter().flat_map(answers_to).collect();
    let open = || -> Result<Opened, AdviseError> {
        let opened = detectors.iter().map(|choice| Ok((*choice, choice.open(&families)?)));
        opened.collect()
    };
    let measured = workers::map(
        samples,
        open,
        |opened, sample| measure(sample, &ways, opened, (scene, camera)),
        &on_photo,
    )?;
    let answers: Vec<&[Answer]> = measured.iter().map(|photo| photo.answers.as_slice()).collect();
    let fits: Vec<Fit> = measured.iter().map(|photo| photo.fit).collect();
    let disagreeing = fits.iter().filter(|fit| fit.disagrees).count();
    let photos = judged(samples, &ways, &measured);
    let camera_check = camera_check::check(&photos, &fits, (scene, camera));
    judge::put_together(&ways, &answers, (disagreeing, camera_check))
}

/// Returns the photos by which the camera file can be judged.
fn judged<'a>(samples: &'a [Sample], ways: &[Way], measured: &'a [Measured]) -> Vec<Judged<'a>> {
    let Some(usual) = ways.iter().position(Way::is_usual) else {
        return Vec::new();
    };
    let judged = |(sample, measured): (&'a Sample, &'a Measured)| {
        let (pose, by_file) = (measured.usual.as_ref()?, &measured.answers[usual]);
        by_file.held_out_deg?;
        Some(Judged { sample, pose, by_file })
    };
    samples.iter().zip(measured).filter_map(judged).collect()
}
