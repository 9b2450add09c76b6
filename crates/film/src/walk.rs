//! A video of a walk round the model, from its frames to the photos: looked at, chosen, kept.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::choose::{Chosen, Wish};
use crate::hold::Held;
use crate::keep::{KeepError, Keeper, Kept, PhotosOf};
use crate::look::{Look, Looker, Unplaced};
use crate::motion;
use crate::pairs::Wanted;
use scaleproof_capture::MAX_BLUR_PX;
use scaleproof_core::files::FileState;
use scaleproof_core::spelling::count;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bin, Scene, Viewpoint};
use scaleproof_pose::tags::{StartError, TagDetectorChoice, limit_scale};
use scaleproof_video::{Selection, Video, VideoError};

/// A hand turns back within a tenth of a second: of fewer frames a second than this the motion in each is not known.
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
    /// The viewpoints that frames are to be pairs of.
    pub wanted: Wanted,
}

/// Why frames were not looked at.
#[derive(Debug, thiserror::Error)]
pub enum LookError {
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error("{error}")]
    Video {
        error: VideoError,
        /// Up to when frames are whole, s; `None` without any.
        whole_s: Option<f64>,
    },
    #[error("interrupted")]
    Interrupted,
}

/// So much before the damage frames are surely whole, s: ffmpeg decodes some frames ahead.
const AHEAD_S: f64 = 0.5;

/// Why a video is not one that a walk can be looked at in.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error(transparent)]
    Video(#[from] VideoError),
    #[error(
        "{video}: {reason}; videos are cropped otherwise than photos, so the camera file must be of its videos", video = video.display()
    )]
    OtherCamera { video: PathBuf, reason: String },
}

/// Describes a video whose frames a camera file fits.
///
/// # Errors
/// No ffmpeg; a file that is no video, or none that can be decoded within bounds; frames of another shape than the camera file's.
pub fn open_video(path: &Path, camera: &Camera) -> Result<Video, OpenError> {
    let video = Video::open(path)?;
    match camera.for_photo(video.width, video.height, video.turned_deg) {
        Ok(_) => Ok(video),
        Err(reason) => Err(OpenError::OtherCamera {
            video: path.to_owned(),
            reason: reason.to_string(),
        }),
    }
}

/// Every so-manieth frame is looked at where nobody says otherwise.
pub fn usual_step(video: &Video) -> u64 {
    let per_s = video.frames_per_s.unwrap_or(LOOKS_PER_S);
    (per_s / LOOKS_PER_S).round().max(1.0) as u64
}

impl Walk {
    /// Looks at the frames of a part. `looked` hears of each frame, and says whether to go on. Frames that may be chosen by `wish` are held, for [`Walk::keep`].
    ///
    /// # Errors
    /// The video breaks off; `looked` says no.
    pub fn looks(
        &self,
        part: &Selection,
        wish: &Wish,
        mut looked: impl FnMut(&[Look]) -> bool,
    ) -> Result<(Vec<Look>, Held), LookError> {
        let (mut looks, mut held) = (Vec::new(), Held::default());
        let (scene, camera) = (&self.scene, &self.camera);
        let mut looker = Looker::new(scene, camera, self.video.turned_deg, TagDetectorChoice::default())?;
        let failed = |error: VideoError, looks: &[Look]| {
            let whole_s = match &error {
                VideoError::Damaged { after_s, .. } if !looks.is_empty() && *after_s > AHEAD_S => {
                    Some(after_s - AHEAD_S)
                }
                _ => None,
            };
            LookError::Video { error, whole_s }
        };
        for frame in self.video.pictures(part).map_err(|e| failed(e, &[]))? {
            let frame = frame.map_err(|e| failed(e, &looks))?;
            let planes = frame.image.planes().cloned();
            looks.push(looker.look(frame));
            motion::set(&mut looks);
            if let Some(planes) = planes {
                held.add(planes, &looks, wish, |looks| self.choose(looks, wish));
            }
            if !looked(&looks) {
                return Err(LookError::Interrupted);
            }
        }
        Ok((looks, held))
    }

    /// Number of frames to look at, by the header.
    pub fn expected(&self, part: &Selection) -> usize {
        let video = &self.video;
        let whole_s = video.duration_s.unwrap_or(0.0);
        let seconds = part.to_s.unwrap_or(whole_s).min(whole_s) - part.from_s;
        let all = video.frames.map(|frames| frames as f64);
        let rate = video.frames_per_s.or_else(|| Some(all? / whole_s)).unwrap_or(0.0);
        (seconds * rate / part.every as f64).clamp(0.0, 1e9).round() as usize
    }

    /// Demands on its frames.
    pub fn wish(&self, per_bin: usize, apart_s: f64) -> Wish<'_> {
        Wish {
            bins: &self.scene.bins,
            most_blur_px: MAX_BLUR_PX * limit_scale([self.video.width, self.video.height]),
            per_bin,
            apart_s,
        }
    }

    /// The best frames of each bin, or the nearest to the wanted viewpoints.
    pub fn choose(&self, looks: &[Look], wish: &Wish) -> Vec<Chosen> {
        match &*self.wanted.viewpoints {
            [] => wish.best(looks),
            wanted => wish.nearest(looks, wanted),
        }
    }

    /// Writes what [`Walk::choose`] chooses into a new folder. Frames that are not held are decoded again. `goes_on` is asked
    /// after each frame.
    ///
    /// # Errors
    /// As [`Keeper::write`].
    pub fn keep(
        &self,
        photos: PhotosOf,
        looks: &[Look],
        wish: &Wish,
        held: &Held,
        folder: &Path,
        goes_on: impl FnMut() -> bool,
    ) -> Result<Vec<Kept>, KeepError> {
        let keeper = Keeper {
            video: &self.video,
            hashed: (&self.name, &self.sha256),
            state: &self.state,
            scene: &self.scene,
            camera: &self.camera,
            detector: TagDetectorChoice::default(),
            most_blur_px: wish.most_blur_px,
            photos,
            held,
            wanted: &self.wanted.viewpoints,
        };
        let choose = |unfit: &BTreeSet<usize>| {
            let mut left = looks.to_vec();
            for at in unfit {
                left[*at].shows = Err(Unplaced::Unsure);
            }
            self.choose(&left, wish)
        };
        keeper.write(folder, looks, choose, goes_on)
    }

    /// Bins of the scene without a photo.
    pub fn empty_bins(&self, kept: &[Kept]) -> Vec<Bin> {
        let bins = &self.scene.bins;
        let all = Viewpoint::combinations(&bins.azimuth_centres(), &bins.pitch_deg, &bins.distance_mm);
        let empty = all.iter().map(|viewpoint| bins.bin_of(viewpoint));
        empty.filter(|bin| kept.iter().all(|one| one.bin != *bin)).collect()
    }

    /// Wanted photos without a pair.
    pub fn unpaired(&self, kept: &[Kept]) -> Vec<String> {
        let is_paired = |at: usize| kept.iter().any(|one| one.pair.is_some_and(|(place, _)| place == at));
        let all = self.wanted.files.iter().enumerate();
        all.filter(|(at, _)| !is_paired(*at))
            .map(|(_, file)| file.clone())
            .collect()
    }

    /// Cautions to read before the photos are believed, as sentences.
    pub fn notes(&self, kept: &[Kept]) -> Vec<String> {
        let mut notes: Vec<String> = self.video.colour_note().into_iter().collect();
        let faults = self.wanted.faults.iter();
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
