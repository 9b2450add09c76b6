//! Video as photos for a calibration: the sharp frames that differ most.

use std::path::Path;

use image::GrayImage;

use super::board_photo::{BoardPhoto, SeenCorner, UnusedPhoto};
use super::detect::LEAST_CORNERS;
use super::shutter::Motion;
use super::target::{LEAST_TAGS, Target, corners_of};
use super::{detect, sharpness};
use scaleproof_core::statistics::upper_median;
use scaleproof_core::{files, workers};
use scaleproof_photo::turned_to_sensor;
use scaleproof_pose::tags::{CornersBy, StartError, TagDetector, TagDetectorChoice};
use scaleproof_video::{Frame, Selection, Video, VideoError};

/// Number of frames of a video that are searched, evenly over its length.
const LOOKED_AT: u64 = 360;
/// Number of frames in a row that are searched in a longer video: the frames beside one say how it moves.
const IN_A_ROW: u64 = 3;
/// Number of frames that go into the camera.
const CHOSEN: usize = 40;
/// Number of frames that are held at a time; a search for tags takes as long to start as a frame takes.
const HELD: usize = 16;
/// Time between frames, s, after which a hand has turned back.
const NEAR_S: f64 = 0.5;
/// Largest ratio of the times from a frame to the one before and the one after.
const EVEN: f64 = 1.5;
/// Least number of corners that frames share: with fewer they show other parts of the target, and are as different as frames are.
const SHARED: usize = 4;

/// Reason why a video cannot be searched.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    #[error(transparent)]
    Video(#[from] VideoError),
    #[error(transparent)]
    Tags(#[from] StartError),
}

/// The frames of a video that go into a camera.
#[derive(Debug, Clone)]
pub struct Film {
    pub frames: Vec<BoardPhoto>,
    /// One sentence on the frames that are left out.
    pub left_out: Vec<UnusedPhoto>,
    /// Motion in all searched frames, where it is known: what a rolling shutter may have done follows from it.
    pub motion: Motion,
}

/// Searches frames of a video for the target, evenly spaced over it, and chooses among them: the sharper half, and of these the ones that differ
/// most. Long videos are searched three frames in a row at a time. The frames that were searched and are not chosen are counted in one sentence.
/// `on_done` gets the number of frames searched, and of all that will be.
///
/// # Errors
/// A video cannot be decoded.
pub fn look_at_video(path: &Path, target: Target, on_done: impl Fn(u64, u64)) -> Result<Film, FilmError> {
    let video = Video::open(path)?;
    let by_length = video
        .duration_s
        .zip(video.frames_per_s)
        .map(|(s, rate)| (s * rate) as u64);
    let frames = video.frames.or(by_length);
    let is_short = frames.is_some_and(|frames| frames <= LOOKED_AT);
    let in_a_row = if is_short { 1 } else { IN_A_ROW };
    let every = frames
        .map_or(5 * IN_A_ROW, |frames| (frames * in_a_row).div_ceil(LOOKED_AT))
        .max(1);
    let mut stream = video.luma(&Selection {
        every,
        in_a_row,
        ..Selection::default()
    })?;
    let name = files::name_of(path);
    let (mut photos, mut times, mut reasons, mut looked_at) = (Vec::new(), Vec::new(), Vec::new(), 0_u64);
    loop {
        let held = stream
            .by_ref()
            .take(HELD)
            .map(|frame| frame.map(|frame| as_the_sensor_lies(frame, video.turned_deg)));
        let held: Vec<Frame<GrayImage>> = held.collect::<Result<_, _>>()?;
        if held.is_empty() {
            break;
        }
        looked_at += held.len() as u64;
        let found = workers::map(
            &held,
            || finder(target),
            |finder, frame| Ok(look_at(frame, (&name, video.turned_deg), target, finder)),
            || (),
        );
        for (result, frame) in found?.into_iter().zip(&held) {
            match result {
                Ok(photo) => {
                    photos.push(photo);
                    times.push(frame.time_s);
                }
                Err(reason) => reasons.push(reason),
            }
        }
        on_done(
            looked_at,
            frames
                .map_or(looked_at, |frames| frames * in_a_row / every)
                .max(looked_at),
        );
    }
    let found = photos.len();
    let motion = motion(&photos, &times);
    let chosen = choose(of_known_motion(photos, &motion));
    let unused = reasons.len() + found - chosen.len();
    let left_out = match reasons.first() {
        Some(first) if found == 0 => Some(format!("none of the {looked_at} frames looked at; the first: {first}")),
        _ if unused == 0 => None,
        _ => Some(format!(
            "{unused} of {looked_at} frames looked at: {} do not show {}, {} are less sharp than those taken or like them",
            reasons.len(),
            target.name(),
            found - chosen.len()
        )),
    };
    Ok(Film {
        frames: chosen,
        left_out: left_out
            .map(|reason| UnusedPhoto { file: name, reason })
            .into_iter()
            .collect(),
        motion,
    })
}

/// Returns the speed of the corners in each photo: from the one searched before it to the one after, where these are near in time, one about as near
/// as the other, and show the corner too.
fn motion(photos: &[BoardPhoto], times: &[f64]) -> Motion {
    let mut motion = Motion::new();
    for (photos, times) in photos.windows(3).zip(times.windows(3)) {
        let (before_s, after_s, seconds) = (times[1] - times[0], times[2] - times[1], times[2] - times[0]);
        let is_even = before_s.max(after_s) < EVEN * before_s.min(after_s);
        if !(is_even && seconds < NEAR_S) {
            continue;
        }
        let find = |photo: &BoardPhoto, id| photo.corners.iter().find(|c| c.id == id).map(|c| c.px);
        for corner in &photos[1].corners {
            if let (Some(before), Some(after)) = (find(&photos[0], corner.id), find(&photos[2], corner.id)) {
                let speed = [0, 1].map(|axis| (after[axis] - before[axis]) / seconds);
                motion.insert((photos[1].file.clone(), corner.id), speed);
            }
        }
    }
    motion
}

/// Reduces photos to those of their corners whose motion is known; where none is, the video is a row of stills.
fn of_known_motion(mut photos: Vec<BoardPhoto>, motion: &Motion) -> Vec<BoardPhoto> {
    if !motion.is_empty() {
        photos.retain_mut(|photo| {
            let file = &photo.file;
            photo.corners.retain(|c| motion.contains_key(&(file.clone(), c.id)));
            photo.corners.len() >= LEAST_CORNERS
        });
    }
    photos
}

type Finder = Option<Box<dyn TagDetector>>;

/// Opens the tag detector, where the target has tags. The library's own corners lie up to a pixel inside tags that motion smears, which makes focal
/// lengths short: the sides are fitted.
fn finder(target: Target) -> Result<Finder, StartError> {
    match target {
        Target::Board(_) => Ok(None),
        Target::Scene(scene) => TagDetectorChoice::AprilTagC(CornersBy::Fit)
            .open(&scene.families())
            .map(Some),
    }
}

/// Turns a frame to the sensor's orientation, which a camera file describes, whichever way the camera was held.
fn as_the_sensor_lies(frame: Frame<GrayImage>, turned_deg: u32) -> Frame<GrayImage> {
    let image = turned_to_sensor(frame.image, turned_deg);
    Frame { image, ..frame }
}

fn look_at(
    frame: &Frame<GrayImage>,
    (name, turned_deg): (&str, u32),
    target: Target,
    finder: &mut Finder,
) -> Result<BoardPhoto, String> {
    let corners = match (target, finder) {
        (Target::Board(board), _) => detect::find(&frame.image, board).map_err(|e| e.to_string())?,
        (Target::Scene(scene), Some(finder)) => corners_of(&finder.find(&frame.image), scene),
        (Target::Scene(_), None) => Vec::new(),
    };
    if matches!(target, Target::Scene(_)) && corners.len() < 4 * LEAST_TAGS {
        return Err(format!(
            "it shows {} whole tags of the scene, and {LEAST_TAGS} are needed",
            corners.len() / 4
        ));
    }
    Ok(BoardPhoto {
        file: format!("{name} frame {}", frame.number),
        size: frame.image.dimensions(),
        turned_deg,
        edge_width_px: sharpness::edge_width_px(&frame.image, &corners),
        corners,
    })
}

/// Returns the sharper half, and of it those that differ most, in the order of the video: the sharpest first, then always the one that is furthest
/// from all that were taken (farthest-point sampling: Gonzalez 1985, "Clustering to minimize the maximum intercluster distance").
fn choose(photos: Vec<BoardPhoto>) -> Vec<BoardPhoto> {
    let width = |photo: &BoardPhoto| photo.edge_width_px.unwrap_or(f64::INFINITY);
    let usual = upper_median(&photos.iter().map(width).collect::<Vec<_>>()).unwrap_or(f64::INFINITY);
    let sharp: Vec<&BoardPhoto> = photos
        .iter()
        .filter(|p| photos.len() <= CHOSEN || width(p) <= usual)
        .collect();
    let sharpest = (0..sharp.len()).min_by(|a, b| width(sharp[*a]).total_cmp(&width(sharp[*b])));
    let mut taken: Vec<usize> = sharpest.into_iter().collect();
    let mut nearest = vec![f64::INFINITY; sharp.len()];
    while let Some(last) = taken.last().filter(|_| taken.len() < CHOSEN.min(sharp.len())) {
        for (nearest, photo) in nearest.iter_mut().zip(&sharp) {
            *nearest = nearest.min(difference(photo, sharp[*last]));
        }
        let left = (0..sharp.len()).filter(|i| !taken.contains(i));
        let Some(next) = left.max_by(|a, b| nearest[*a].total_cmp(&nearest[*b])) else {
            break;
        };
        taken.push(next);
    }
    taken.sort_unstable();
    taken.into_iter().map(|i| sharp[i].clone()).collect()
}

/// Returns the mean distance between the corners that both frames show, as a share of the image's diagonal; 1 where they share too few.
fn difference(a: &BoardPhoto, b: &BoardPhoto) -> f64 {
    let (width, height) = a.size;
    let way = |x: &SeenCorner| {
        let other = b.corners.iter().find(|y| y.id == x.id)?;
        Some((x.px[0] - other.px[0]).hypot(x.px[1] - other.px[1]))
    };
    let ways: Vec<f64> = a.corners.iter().filter_map(way).collect();
    if ways.len() < SHARED {
        return 1.0;
    }
    ways.iter().sum::<f64>() / ways.len() as f64 / f64::from(width).hypot(f64::from(height))
}
