//! Chosen frames become photos: in their colours, located once more the one way, and written with what was measured.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use image::RgbImage;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cache::FrameCache;
use crate::choose::Chosen;
use crate::tracking::FrameResult;
use scaleproof_capture::{Guidance, Judge, Measures, Sidecar, Tolerance, sidecar_of, slug};
use scaleproof_core::files::{self, FileError, FileState};
use scaleproof_core::geometry::rigid;
use scaleproof_photo as photo;
use scaleproof_photo::{Budget, Photo, PhotoError};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Located, Sigma};
use scaleproof_pose::scene::{Bin, Scene, Viewpoint};
use scaleproof_pose::tags::{StartError, TagDetectorChoice};
use scaleproof_session::{PhotoEntry, VideoFrame};
use scaleproof_video::{Frame, Planes, Selection, Video, VideoError};

/// Quality of the JPEGs.
const QUALITY: u8 = 95;
/// The longer side of a frame on the contact sheet, px.
const THUMBNAIL_PX: u32 = 320;
/// Maximum number of rounds in which frames that turn out unfit at full size are replaced by others.
const MOST_ROUNDS: usize = 4;

/// Reason why frames could not be written.
#[derive(Debug, thiserror::Error)]
pub enum KeepError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Video(#[from] VideoError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error("interrupted")]
    Interrupted,
}

/// Photos that are made of frames: their texture, place and format.
#[derive(Debug, Clone, Copy)]
pub struct PhotosOf<'a> {
    pub variant: &'a str,
    pub place: &'a str,
    /// PNG instead of JPEG.
    pub png: bool,
}

/// Sources that the photos are made of.
pub struct FrameWriter<'a> {
    pub video: &'a Video,
    /// The video's name and SHA-256.
    pub hashed: (&'a str, &'a str),
    /// The video as it was before it was hashed.
    pub state: &'a FileState,
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub detector: TagDetectorChoice,
    /// Largest blur by which frames were chosen, px (standard deviation).
    pub most_blur_px: f64,
    pub photos: PhotosOf<'a>,
    /// Frames that need not be decoded again.
    pub held: &'a FrameCache,
    /// Viewpoints that frames were chosen for; empty if they were chosen by bins.
    pub targets: &'a [Viewpoint],
}

/// A frame that is a photo now.
#[derive(Debug, Clone)]
pub struct SavedFrame {
    /// Its name in the folder.
    pub file: String,
    /// Its index among the tracked frames.
    pub at: usize,
    pub frame: VideoFrame,
    pub bin: Bin,
    pub viewpoint: Viewpoint,
    pub sigma: Sigma,
    pub measures: Measures,
    /// Index of the target viewpoint it was chosen for, and how far its own is from that.
    pub pair: Option<(usize, PairDifference)>,
    /// Advice to a photographer, a sentence, where the light of the frame is not right.
    pub advice: Option<String>,
    pub thumbnail: RgbImage,
}

/// Differences between the viewpoints of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct PairDifference {
    /// The way between the two camera centres as an angle at the farther one's distance.
    pub apart_deg: f64,
    pub azimuth_deg: f64,
    pub pitch_deg: f64,
    pub distance_mm: f64,
}

impl PairDifference {
    /// From one viewpoint to the other.
    pub fn between(from: &Viewpoint, to: &Viewpoint) -> PairDifference {
        PairDifference {
            apart_deg: crate::choose::apart_deg(from, to),
            azimuth_deg: scaleproof_core::geometry::angle::turn(from.azimuth_deg, to.azimuth_deg),
            pitch_deg: to.pitch_deg - from.pitch_deg,
            distance_mm: to.distance_mm - from.distance_mm,
        }
    }
}

/// Returns the parts of a video with these frames, given by their numbers in order. Each part begins at a tracked frame, and no frame is decoded for
/// two parts.
fn parts(numbers: &[u64], looks: &[FrameResult]) -> Vec<Selection> {
    let before = |number: u64| Some(&looks[looks.partition_point(|look| look.number <= number).checked_sub(1)?]);
    let key = |number: u64| before(number).map(|look| look.key);
    let parts = numbers.chunk_by(|one, next| key(*one) == key(*next));
    let selection = |numbers: &[u64]| Selection {
        begin: before(numbers[0]).map(|look| (look.number, look.time_s)),
        numbers: Some(numbers.to_vec()),
        is_whole: false,
        ..Selection::default()
    };
    parts.map(selection).collect()
}

/// Iterates over frames, or over the one error by which there are none.
fn each<T>(
    frames: Result<impl Iterator<Item = Result<T, VideoError>>, VideoError>,
) -> impl Iterator<Item = Result<T, VideoError>> {
    let (frames, error) = match frames {
        Ok(frames) => (Some(frames), None),
        Err(error) => (None, Some(Err(error))),
    };
    frames.into_iter().flatten().chain(error)
}

impl FrameWriter<'_> {
    /// Writes what is chosen into a new folder, whole or not at all; frames that turn out unfit are replaced as `choose` says without them. No folder
    /// is made for no frame.
    ///
    /// # Errors
    /// The video breaks off; the folder cannot be written; `goes_on`, which is called after each frame, returns false.
    pub fn write(
        &self,
        folder: &Path,
        looks: &[FrameResult],
        choose: impl Fn(&BTreeSet<usize>) -> Vec<Chosen>,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<Vec<SavedFrame>, KeepError> {
        let mut outcome = Ok(Vec::new());
        let made = files::make_folder(folder, |inside| {
            outcome = self.fill(inside, looks, &choose, &mut goes_on);
            let is_some = outcome.as_ref().is_ok_and(|kept| !kept.is_empty());
            is_some
                .then_some(())
                .ok_or_else(|| FileError::cannot_write(folder, "nothing was chosen"))
        });
        match (outcome, made) {
            (Ok(kept), Err(e)) if !kept.is_empty() => Err(e.into()),
            (outcome, _) => outcome,
        }
    }

    fn fill(
        &self,
        folder: &Path,
        looks: &[FrameResult],
        choose: &impl Fn(&BTreeSet<usize>) -> Vec<Chosen>,
        goes_on: &mut impl FnMut() -> bool,
    ) -> Result<Vec<SavedFrame>, KeepError> {
        let mut judge = Judge::new(self.scene, self.detector, false)?;
        let (mut unfit, mut kept) = (BTreeSet::new(), BTreeMap::<usize, SavedFrame>::new());
        for _ in 0..MOST_ROUNDS {
            let chosen: BTreeMap<usize, Chosen> = choose(&unfit).into_iter().map(|one| (one.at, one)).collect();
            for (_, old) in kept.extract_if(.., |at, _| !chosen.contains_key(at)) {
                self.remove(folder, &old.file)?;
            }
            let missing: BTreeMap<u64, Chosen> = chosen
                .into_iter()
                .filter(|(at, _)| !kept.contains_key(at))
                .map(|(at, one)| (looks[at].number, one))
                .collect();
            if missing.is_empty() {
                break;
            }
            let numbers: Vec<u64> = missing.keys().copied().collect();
            for frame in self.frames(&numbers, looks) {
                let frame = frame?;
                let Some(one) = missing.get(&frame.number) else {
                    continue;
                };
                match self.photo(folder, &frame, one, &looks[one.at], &mut judge)? {
                    Some(photo) => drop(kept.insert(one.at, photo)),
                    None => drop(unfit.insert(one.at)),
                }
                if !goes_on() {
                    return Err(KeepError::Interrupted);
                }
            }
        }
        // Photos of one film under the hash of another would be nobody's.
        self.state.check()?;
        Ok(kept.into_values().collect())
    }

    /// Returns frames by their numbers: those that are cached, then the others as they are decoded.
    fn frames(
        &self,
        numbers: &[u64],
        looks: &[FrameResult],
    ) -> impl Iterator<Item = Result<Frame<RgbImage>, VideoError>> {
        let look = |number: &u64| looks.binary_search_by_key(number, |look| look.number).ok();
        let held = |number: &u64| Some((looks[look(number)?], self.held.frame(*number)?.clone()));
        let (held, planes): (Vec<FrameResult>, Vec<Planes>) = numbers.iter().filter_map(held).unzip();
        let others: Vec<u64> = (numbers.iter().copied())
            .filter(|number| self.held.frame(*number).is_none())
            .collect();
        let colours = (!held.is_empty()).then(|| each(self.video.colours(planes)));
        let held = held
            .into_iter()
            .zip(colours.into_iter().flatten())
            .map(|(look, image)| {
                Ok(Frame {
                    number: look.number,
                    time_s: look.time_s,
                    key: look.key,
                    image: image?,
                })
            });
        // The next part is begun before this one is gone through, and is decoded meanwhile.
        let mut begun = (parts(&others, looks).into_iter())
            .map(|part| self.video.rgb(&part))
            .peekable();
        let decoded = std::iter::from_fn(move || {
            let part = begun.next();
            let _ = begun.peek();
            part
        });
        held.chain(decoded.flat_map(each))
    }

    fn remove(&self, folder: &Path, file: &str) -> Result<(), FileError> {
        [file.to_owned(), sidecar_of(file)]
            .iter()
            .try_for_each(|name| files::chosen::remove(folder, &folder.join(name)))
    }

    /// Writes the photo of one frame, and what is known of it beside it; `None` when at full size it is not what it was taken for.
    fn photo(
        &self,
        folder: &Path,
        frame: &Frame<RgbImage>,
        one: &Chosen,
        look: &FrameResult,
        judge: &mut Judge,
    ) -> Result<Option<SavedFrame>, KeepError> {
        let turned_deg = self.video.turned_deg;
        let (bytes, ending) = match self.photos.png {
            true => (photo::sensor_png(&frame.image, turned_deg), "png"),
            false => (photo::sensor_jpeg(&frame.image, turned_deg, QUALITY), "jpg"),
        };
        let file = format!("{}_{:06}.{ending}", slug(self.photos.variant), frame.number);
        let path = folder.join(&file);
        let no_image = || FileError::cannot_write(&path, "a frame of this size makes no image file");
        let photo = Photo::from_bytes(Path::new(&file), bytes.ok_or_else(no_image)?, Budget::FILE)?;
        let target = self.target(one);
        let bins = &self.scene.bins;
        let guidance = Guidance::at(&[target], Tolerance::of_bins(bins, &bins.distance_mm), bins);
        let judged = judge.judge(&photo.luma()?, photo.turned_deg, self.camera, &guidance);
        // A frame that was looked at reduced hid what fills single pixels.
        let is_sharp = (judged.measures.blur_px).is_none_or(|px| px <= self.most_blur_px);
        let located = judged.located.filter(|located| is_sharp && located.bin == one.bin);
        let moved = look.shows.as_ref().ok().and_then(|view| view.moved);
        let (Some(located), Some(moved)) = (located, moved) else {
            return Ok(None);
        };
        let light = judged.verdict.err().filter(|advice| {
            use scaleproof_capture::Advice::{TooBright, TooDark};
            matches!(advice, TooBright | TooDark)
        });
        let video_frame = VideoFrame {
            video: self.hashed.0.to_owned(),
            sha256: self.hashed.1.to_owned(),
            number: frame.number,
            time_s: frame.time_s,
        };
        let kept = SavedFrame {
            at: one.at,
            bin: one.bin,
            viewpoint: located.viewpoint,
            sigma: located.sigma.and(&moved),
            measures: judged.measures,
            pair: one
                .pair
                .map(|(place, _)| (place, PairDifference::between(&target, &located.viewpoint))),
            advice: light.map(|advice| advice.to_string()),
            thumbnail: photo::boxed(
                &frame.image,
                photo::fitting(frame.image.dimensions().into(), THUMBNAIL_PX),
            ),
            frame: video_frame,
            file,
        };
        let beside = folder.join(sidecar_of(&kept.file));
        let sidecar = self.sidecar(&kept, target, &located, photo.sha256.clone());
        let text = serde_json::to_string_pretty(&sidecar).map_err(|e| FileError::content(&beside, e))?;
        files::replace_atomically(folder, &path, photo.bytes())?;
        files::replace_atomically(folder, &beside, (text + "\n").as_bytes())?;
        Ok(Some(kept))
    }

    /// Returns the viewpoint that a frame was chosen for: another photo's, or the middle of its bin.
    fn target(&self, one: &Chosen) -> Viewpoint {
        let target = one.pair.and_then(|(place, _)| self.targets.get(place));
        target.copied().unwrap_or(Viewpoint {
            azimuth_deg: one.bin.azimuth_deg,
            pitch_deg: one.bin.pitch_deg,
            distance_mm: one.bin.distance_mm,
        })
    }

    fn sidecar(&self, kept: &SavedFrame, target: Viewpoint, located: &Located, sha256: String) -> Sidecar {
        Sidecar {
            photo: PhotoEntry {
                file: kept.file.clone(),
                variant: self.photos.variant.to_owned(),
                place: Some(self.photos.place.to_owned()),
                frame: Some(kept.frame.clone()),
                ..PhotoEntry::default()
            },
            sha256,
            source: format!(
                "{}, frame {} at {:.3} s",
                kept.frame.video, kept.frame.number, kept.frame.time_s
            ),
            target,
            viewpoint: kept.viewpoint,
            sigma: kept.sigma,
            T_camera_model: rigid::rows(&located.pose),
            tags: located.tags.clone(),
            rms_px: located.rms_px,
            gates: kept.measures,
            is_by_hand: false,
            camera: None,
        }
    }
}
