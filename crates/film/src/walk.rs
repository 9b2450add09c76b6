//! A video of a walk round the model, from its frames to the photos: tracked, chosen, written.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::cache::FrameCache;
use crate::choose::{Chosen, SelectionCriteria};
use crate::keep::{FrameWriter, KeepError, PhotosOf, SavedFrame};
use crate::motion;
use crate::pairs::TargetViews;
use crate::tracking::{FrameResult, FrameTracker, NoPose};
use scaleproof_capture::MAX_BLUR_PX;
use scaleproof_core::files::FileState;
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::spelling::count;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bin, Scene, Viewpoint};
use scaleproof_pose::tags::{StartError, TagDetectorChoice, limit_scale};
use scaleproof_video::{Selection, Video, VideoError};

/// Fewest frames a second in which the camera's motion is known: a hand turns back within a tenth of a second.
const LOOKS_PER_S: f64 = 30.0;

/// A video, and what its frames are located by and chosen for.
pub struct Walk {
    pub video: Video,
    /// The video's name and SHA-256.
    pub name: String,
    pub sha256: String,
    /// The video as it was before it was hashed.
    pub state: FileState,
    pub scene: Scene,
    pub camera: Camera,
    /// Viewpoints that frames are to be pairs of.
    pub targets: TargetViews,
}

/// Reason why frames were not tracked.
#[derive(Debug, thiserror::Error)]
pub enum TrackError {
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Video(#[from] VideoError),
    #[error(transparent)]
    Message(#[from] Message),
    #[error("interrupted")]
    Interrupted,
}

/// Time before damage at which frames are surely whole, s: ffmpeg decodes some frames ahead.
const AHEAD_S: f64 = 0.5;

/// Describes a video whose frames a camera file fits.
///
/// # Errors
/// No ffmpeg; a file that is no video, or none that can be decoded within bounds; frames of another shape than the camera file's.
pub fn open_video(path: &Path, camera: &Camera) -> Result<Video, VideoError> {
    let video = Video::open(path)?;
    match camera.for_photo(video.width, video.height, video.turned_deg) {
        Ok(_) => Ok(video),
        Err(reason) => bail!(
            "{}: {reason}; videos are cropped otherwise than photos, so the camera file must be of its videos",
            path.display()
        ),
    }
}

/// Returns the default frame step: every Nth frame is tracked, some 30 a second.
pub fn usual_step(video: &Video) -> u64 {
    let per_s = video.frames_per_s.unwrap_or(LOOKS_PER_S);
    (per_s / LOOKS_PER_S).round().max(1.0) as u64
}

impl Walk {
    /// Tracks the camera through the frames of a part. `on_frame` is called after each frame, and returns false to stop. Frames that may be chosen by
    /// `criteria` are cached for [`Walk::keep`].
    ///
    /// # Errors
    /// The video breaks off; `on_frame` returns false.
    pub fn track(
        &self,
        part: &Selection,
        criteria: &SelectionCriteria,
        mut on_frame: impl FnMut(&[FrameResult]) -> bool,
    ) -> Result<(Vec<FrameResult>, FrameCache), TrackError> {
        let (mut looks, mut held) = (Vec::new(), FrameCache::default());
        let (scene, camera) = (&self.scene, &self.camera);
        let mut tracker = FrameTracker::new(scene, camera, self.video.turned_deg, TagDetectorChoice::default())?;
        let failed = |error: VideoError, looks: &[FrameResult]| {
            match &error {
                // Frames before the damage can be used.
                VideoError::Damaged { after_s, .. } if !looks.is_empty() && *after_s > AHEAD_S => message!("{error}")
                    .hint(format!("use what is before it by ‹to› {:.1}", after_s - AHEAD_S))
                    .into(),
                _ => TrackError::Video(error),
            }
        };
        for frame in self.video.pictures(part).map_err(|e| failed(e, &[]))? {
            let frame = frame.map_err(|e| failed(e, &looks))?;
            let planes = frame.image.planes().cloned();
            looks.push(tracker.track(frame));
            motion::set_motion(&mut looks);
            if let Some(planes) = planes {
                held.add(planes, &looks, criteria, |looks| self.choose(looks, criteria));
            }
            if !on_frame(&looks) {
                return Err(TrackError::Interrupted);
            }
        }
        Ok((looks, held))
    }

    /// Returns the number of frames to track, by the header.
    pub fn expected(&self, part: &Selection) -> usize {
        let video = &self.video;
        let whole_s = video.duration_s.unwrap_or(0.0);
        let seconds = part.to_s.unwrap_or(whole_s).min(whole_s) - part.from_s;
        let all = video.frames.map(|frames| frames as f64);
        let rate = video.frames_per_s.or_else(|| Some(all? / whole_s)).unwrap_or(0.0);
        (seconds * rate / part.every as f64).clamp(0.0, 1e9).round() as usize
    }

    /// Returns the criteria by which its frames are chosen.
    pub fn criteria(&self, per_bin: usize, apart_s: f64) -> SelectionCriteria<'_> {
        SelectionCriteria {
            bins: &self.scene.bins,
            most_blur_px: MAX_BLUR_PX * limit_scale([self.video.width, self.video.height]),
            per_bin,
            apart_s,
        }
    }

    /// Chooses the best frames of each bin, or the nearest to the target viewpoints.
    pub fn choose(&self, looks: &[FrameResult], criteria: &SelectionCriteria) -> Vec<Chosen> {
        match &*self.targets.viewpoints {
            [] => criteria.best(looks),
            targets => criteria.nearest(looks, targets),
        }
    }

    /// Writes what [`Walk::choose`] chooses into a new folder. Frames that are not held are decoded again. `goes_on` is called
    /// after each frame.
    ///
    /// # Errors
    /// As [`FrameWriter::write`].
    pub fn keep(
        &self,
        photos: PhotosOf,
        looks: &[FrameResult],
        criteria: &SelectionCriteria,
        held: &FrameCache,
        folder: &Path,
        goes_on: impl FnMut() -> bool,
    ) -> Result<Vec<SavedFrame>, KeepError> {
        let keeper = FrameWriter {
            video: &self.video,
            hashed: (&self.name, &self.sha256),
            state: &self.state,
            scene: &self.scene,
            camera: &self.camera,
            detector: TagDetectorChoice::default(),
            most_blur_px: criteria.most_blur_px,
            photos,
            held,
            targets: &self.targets.viewpoints,
        };
        let choose = |unfit: &BTreeSet<usize>| {
            let mut left = looks.to_vec();
            for at in unfit {
                left[*at].shows = Err(NoPose::Unsure);
            }
            self.choose(&left, criteria)
        };
        keeper.write(folder, looks, choose, goes_on)
    }

    /// Returns the bins of the scene without a photo.
    pub fn empty_bins(&self, kept: &[SavedFrame]) -> Vec<Bin> {
        let bins = &self.scene.bins;
        let all = Viewpoint::combinations(&bins.azimuth_centres(), &bins.pitch_deg, &bins.distance_mm);
        let empty = all.iter().map(|viewpoint| bins.bin_of(viewpoint));
        empty.filter(|bin| kept.iter().all(|one| one.bin != *bin)).collect()
    }

    /// Returns the target photos without a pair.
    pub fn unpaired(&self, kept: &[SavedFrame]) -> Vec<String> {
        let is_paired = |at: usize| kept.iter().any(|one| one.pair.is_some_and(|(place, _)| place == at));
        let all = self.targets.files.iter().enumerate();
        all.filter(|(at, _)| !is_paired(*at))
            .map(|(_, file)| file.clone())
            .collect()
    }

    /// Returns cautions to read before the photos are believed, as sentences.
    pub fn notes(&self, kept: &[SavedFrame]) -> Vec<String> {
        let mut notes: Vec<String> = self.video.colour_note().into_iter().collect();
        let faults = self.targets.faults.iter();
        notes.extend(faults.map(|fault| format!("no pair is looked for: {fault}")));
        let mut light: BTreeMap<&str, usize> = BTreeMap::new();
        for advice in kept.iter().filter_map(|one| one.advice.as_deref()) {
            *light.entry(advice).or_default() += 1;
        }
        let said = light
            .iter()
            .map(|(advice, number)| format!("{} of {}: {advice}", number, count(kept.len(), "chosen frame")));
        notes.extend(said);
        notes
    }
}
